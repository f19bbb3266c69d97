// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "core/measurements/measurements.h"

// Finds wires by the line that their returns lie on (docs/algorithm.md section 1; ours). Seen at an
// angle, a wire leaves scattered returns: one or two columns of one beam, then none until the next
// beam meets it; seen along its length, one return per beam in a single column. None of them looks
// firm and some stand alone, as rain does. The evidence is that several are thin, seen past on both
// sides (Segmenter::IsThin), lie on one straight line in space, and have little else around them.
// Tips of grass are sometimes thin and lie on a line by chance, but among others.

namespace hardpack {

class WireFinder {
 public:
  WireFinder() { Restart(); }

  // Numbers of thin returns and of others that are kept, for how many directions after they
  // arrived, together with all others since.
  static constexpr int kMost = 32;
  static constexpr int kMostOthers = 64;
  static constexpr int kDirections = 64;
  // A wire is at least this many of them on a line of at most kLongest_m, each no farther from the
  // next than that allows.
  static constexpr int kLeast = 4;
  static constexpr float kShortest_m = 0.3f;
  static constexpr float kLongest_m = 2.5f;
  // Largest distance from the line, seen from above and in height: a lidar's range noise.
  static constexpr float kAside_m = 0.05f;
  static constexpr float kHeight_m = 0.04f;
  // Seen from above, at most a third as many others as on the line lie within this distance of it.
  static constexpr float kAbout_m = 0.2f;
  // And returns in half as many of the directions across it as have a beam on a wire of this
  // thickness: the even edge of a strip of growth has fewer.
  static constexpr float kThickness_m = 0.02f;

  // Clears everything.
  void Restart();

  // Takes a low return of a direction (an increasing sequence number; several per direction are
  // fine) that is thin, or is not. A return that is not finite is ignored. The oldest are dropped.
  // Cost: constant.
  void AddThin(const Vec3& point_odom, int64_t direction);
  void AddOther(const Vec3& point_odom, int64_t direction);

  // The returns on the best line that ends in the last added thin one; none if there is no wire.
  // direction: the present one; spacing_m: the distance from one beam to the next above, there.
  // Valid until the next call. Cost: kMost^2 + kMostOthers tests.
  std::span<const Vec3> Find(int64_t direction, float spacing_m);

 private:
  struct Line {
    float x_m = 0.0f;  // its direction times its length, as seen from above, and its rise
    float y_m = 0.0f;
    float rise_m = 0.0f;
    float length_m2 = 0.0f;
  };

  Line LineTo(int point) const;
  // 1 if the point lies on the line, between its ends.
  uint32_t IsOn(const Line& line, int point) const;
  int CountOn(const Line& line) const;
  // 1 if a place is near the line.
  uint32_t IsAbout(const Line& line, float x_m, float y_m) const;
  int CountAbout(const Line& line, int64_t since) const;
  bool IsDense(const Line& line, int count, int64_t direction, float spacing_m) const;

  int32_t newest_ = -1;  // index of the last one; -1: none since Restart
  float x_m_[kMost] = {};
  float y_m_[kMost] = {};
  float z_m_[kMost] = {};
  int64_t direction_[kMost] = {};
  uint32_t held_[kMost] = {};  // 1: not too old
  int32_t newest_other_ = 0;
  float other_x_m_[kMostOthers] = {};
  float other_y_m_[kMostOthers] = {};
  int64_t other_direction_[kMostOthers] = {};
  Vec3 found_[kMost];
};
static_assert(std::is_trivially_copyable_v<WireFinder>);

}  // namespace hardpack
