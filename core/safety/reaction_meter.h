// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

// The reaction radius, measured ([OS] Path Optimization; docs/algorithm.md section 8): for every
// lidar column the time from its stamp to the first command whose path was produced, or checked
// again, against a map that contains it, and that time times the speed of the moment. A column that
// never gets into a map counts as infinite. The owner says what happened in the order in which it
// did; this remembers, counts, and tells the median and the 99th percentile.
//
//   Filed    Filed    RoundBegun     Filed      RoundJudged     Commanded
//     a        b     (map: a, b)       c       (path checked)    a and b are measured, c waits
//
// What a round takes in after its map was begun may be in that map too; it is counted as if it were
// not, so the time is rather told too long.

namespace hardpack {

class ReactionMeter {
 public:
  static constexpr int kCapacity = 4096;  // columns that wait: 0.2 s of the fastest sensor
  static constexpr int kTimeBins = 200;
  static constexpr int kRadiusBins = 250;
  static constexpr float kTimeBin_s = 0.005f;
  static constexpr float kRadiusBin_m = 0.02f;
  // What is told for a column that is beyond the last bin, or never got in.
  static constexpr float kBeyond = 1.0e6f;

  // Nothing waits, and nothing was counted.
  void Reset();

  // A column that was taken at time_ns was classed: a map that is begun from now on contains it.
  // Where as many wait as there is room for, the oldest has never got in. Constant cost.
  void Filed(uint64_t time_ns);

  // A column that will never be in any map.
  void Lost();

  // A map was begun. Where the round before it was not judged, or had no path, its columns go on
  // waiting with this one.
  void RoundBegun();

  // The round came to a path that was made or checked on its map.
  void RoundJudged();

  // Commands were given from the newest path, the vehicle driving at speed_mps. Cost: the columns
  // of the rounds that were judged since.
  void Commanded(uint64_t now_ns, float speed_mps);

  // Nobody plans: what waits is neither measured nor lost.
  void Pause();

  // The smallest upper edge of a bin up to which at least this share (0 to 1) of the columns lies;
  // kBeyond, or 0 where none was counted. Cost: the bins.
  float Time_s(float share) const;
  float Radius_m(float share) const;
  uint32_t columns() const { return columns_; }  // counted
  uint32_t lost() const { return time_[kTimeBins]; }
  // How many fell into each bin; the last one: beyond.
  std::span<const uint32_t, kTimeBins + 1> time_bins() const { return time_; }
  std::span<const uint32_t, kRadiusBins + 1> radius_bins() const { return radius_; }
  int waiting() const { return static_cast<int>(end_ - first_); }

 private:
  // When so many are counted, all bins are halved: the newest weigh more.
  static constexpr uint32_t kMost = 1u << 30u;

  void Count(int time_bin, int radius_bin);
  void HalveBins();

  // Numbers of columns, counted on; a column lies at its number modulo kCapacity.
  uint64_t first_ = 0;      // that waits
  uint64_t round_end_ = 0;  // behind the last one that the round's map contains
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
