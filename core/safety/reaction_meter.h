// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

// The reaction radius, measured ([OS] Path Optimization; docs/algorithm.md section 8): for every
// lidar column the time from its stamp to the first command whose path was planned, or checked
// again, on a map that contains it, and that time multiplied by the current speed. A column that
// never reaches a map counts as infinite. The owner reports the events in order; this class stores
// and counts them, and returns the median and the 99th percentile.
//
//   Filed    Filed    RoundBegun     Filed      RoundJudged     Commanded
//     a        b     (map: a, b)       c       (path checked)    a and b are measured, c waits
//
// Columns that a round takes in after its map was begun may be in that map too; they are counted as
// if they were not, so the time is rather overestimated.

namespace hardpack {

class ReactionMeter {
 public:
  static constexpr int kCapacity = 4096;  // waiting columns: 0.2 s of the fastest sensor
  static constexpr int kTimeBins = 200;
  static constexpr int kRadiusBins = 250;
  static constexpr float kTimeBin_s = 0.005f;
  static constexpr float kRadiusBin_m = 0.02f;
  // The result for a column beyond the last bin, or one that never reached a map.
  static constexpr float kBeyond = 1.0e6f;

  // Clears the waiting columns and the counts.
  void Reset();

  // A column measured at time_ns was classed: a map begun from now on contains it. If the queue is
  // full, the oldest counts as never having reached a map. Constant cost.
  void Filed(uint64_t time_ns);

  // A column that will never be in any map.
  void Lost();

  // A map was begun. If the previous round was not evaluated, or had no path, its columns keep
  // waiting with this one.
  void RoundBegun();

  // The round produced a path that was made or checked on its map.
  void RoundJudged();

  // Commands were given from the newest path, with the vehicle at speed_mps. Cost: the columns of
  // the rounds evaluated since.
  void Commanded(uint64_t now_ns, float speed_mps);

  // Planning is paused: waiting columns are neither measured nor lost.
  void Pause();

  // The smallest upper edge of a bin up to which at least this share (0 to 1) of the columns lies;
  // kBeyond, or 0 if none was counted. Cost: the bins.
  float Time_s(float share) const;
  float Radius_m(float share) const;
  uint32_t columns() const { return columns_; }  // counted
  uint32_t lost() const { return time_[kTimeBins]; }
  // Columns in each bin; the last one: beyond.
  std::span<const uint32_t, kTimeBins + 1> time_bins() const { return time_; }
  std::span<const uint32_t, kRadiusBins + 1> radius_bins() const { return radius_; }
  int waiting() const { return static_cast<int>(end_ - first_); }

 private:
  // At this count, all bins are halved: the newest weigh more.
  static constexpr uint32_t kMost = 1u << 30u;

  void Count(int time_bin, int radius_bin);
  void HalveBins();

  // Running numbers of columns; a column is stored at its number modulo kCapacity.
  uint64_t first_ = 0;      // waiting
  uint64_t round_end_ = 0;  // after the last one in the round's map
  uint64_t judged_end_ = 0;
  uint64_t end_ = 0;
  uint32_t columns_ = 0;
  uint32_t time_[kTimeBins + 1] = {};  // the last bin: beyond
  uint32_t radius_[kRadiusBins + 1] = {};
  uint64_t time_ns_[kCapacity] = {};
};
static_assert(std::is_trivially_copyable_v<ReactionMeter>);
static_assert(sizeof(ReactionMeter) <= 36 * 1024);

}  // namespace hardpack
