// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "core/measurements/measurements.h"

// Wires by the line that their returns lie on (docs/algorithm.md section 1; ours). Seen slantwise,
// a wire has a return here and there: one or two columns of one beam, then none until the next beam
// comes down to it; seen along its length, one of each beam in a single column. None of them looks
// firm and some stand alone, as rain does. What tells them is that several are thin, seen past on
// both sides (Segmenter::IsThin), lie on one straight line in space, and have little else about
// them. Tips of grass are thin now and then and lie on a line by chance, but among others.

namespace hardpack {

class WireFinder {
 public:
  WireFinder() { Restart(); }

  // So many thin returns are remembered, and so many others, for so many directions after they came
  // and while all others since are.
  static constexpr int kMost = 32;
  static constexpr int kMostOthers = 64;
  static constexpr int kDirections = 64;
  // A wire is at least so many of them on a line of at most kLongest_m, each no further from the
  // next than that allows.
  static constexpr int kLeast = 4;
  static constexpr float kShortest_m = 0.3f;
  static constexpr float kLongest_m = 2.5f;
  // Off the line at most, as seen from above and in height: a lidar's noise in range.
  static constexpr float kAside_m = 0.05f;
  static constexpr float kHeight_m = 0.04f;
  // As seen from above, at most a third as many as on it lie no further beside it than this.
  static constexpr float kAbout_m = 0.2f;
  // And half as many of the directions across it as those that have a beam on a wire so thick: the
  // even edge of a strip of growth has fewer.
  static constexpr float kThickness_m = 0.02f;

  // Forgets all.
  void Restart();

  // Takes a return of a direction (a sequence number that grows; several of one are fine) that
  // stands low and is thin, or is not. What is not finite is not taken. The oldest go. Cost:
  // constant.
  void AddThin(const Vec3& point_odom, int64_t direction);
  void AddOther(const Vec3& point_odom, int64_t direction);

  // The returns on the best line that ends in the thin one that was added last; none where there is
  // no wire. direction: whose turn it is; spacing_m: how far one beam is above the next, there.
  // Valid until the next call. Cost: kMost^2 + kMostOthers
  // tests.
  std::span<const Vec3> Find(int64_t direction, float spacing_m);

 private:
  struct Line {
    float x_m = 0.0f;  // its direction times its length, as seen from above, and its rise
    float y_m = 0.0f;
    float rise_m = 0.0f;
    float length_m2 = 0.0f;
  };

  Line LineTo(int point) const;
  // 1 where the point lies on the line, between its ends.
  uint32_t IsOn(const Line& line, int point) const;
  int CountOn(const Line& line) const;
  // 1 where a place lies about the line.
  uint32_t IsAbout(const Line& line, float x_m, float y_m) const;
  int CountAbout(const Line& line, int64_t since) const;
  bool IsDense(const Line& line, int count, int64_t direction, float spacing_m) const;

  int32_t newest_ = -1;  // where the last one is; -1: none came since Restart
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
