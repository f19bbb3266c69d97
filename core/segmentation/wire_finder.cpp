// SPDX-License-Identifier: Apache-2.0
#include "core/segmentation/wire_finder.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {
namespace {

constexpr int64_t kNever = -1'000'000;

}  // namespace

void WireFinder::Restart() {
  newest_ = -1;
  HP_LOOP_BOUND(kMost)
  for (int64_t& direction : direction_) direction = kNever;
  HP_LOOP_BOUND(kMostOthers)
  for (int64_t& direction : other_direction_) direction = kNever;
}

void WireFinder::AddOther(const Vec3& point_odom, int64_t direction) {
  if (!IsFinite(point_odom.x_m) || !IsFinite(point_odom.y_m)) return;
  newest_other_ = newest_other_ + 1 < kMostOthers ? newest_other_ + 1 : 0;
  other_x_m_[newest_other_] = point_odom.x_m;
  other_y_m_[newest_other_] = point_odom.y_m;
  other_direction_[newest_other_] = direction;
}

void WireFinder::AddThin(const Vec3& point_odom, int64_t direction) {
  if (!IsFinite(point_odom)) return;
  newest_ = newest_ + 1 < kMost ? newest_ + 1 : 0;
  x_m_[newest_] = point_odom.x_m;
  y_m_[newest_] = point_odom.y_m;
  z_m_[newest_] = point_odom.z_m;
  direction_[newest_] = direction;
}

// From the newest point, about which the others' places are small numbers.
WireFinder::Line WireFinder::LineTo(int point) const {
  Line line;
  line.x_m = x_m_[point] - x_m_[newest_];
  line.y_m = y_m_[point] - y_m_[newest_];
  line.rise_m = z_m_[point] - z_m_[newest_];
  line.length_m2 = line.x_m * line.x_m + line.y_m * line.y_m;
  return line;
}

// Without a division or a branch: four points at a time.
inline uint32_t WireFinder::IsOn(const Line& line, int point) const {
  const float x_m = x_m_[point] - x_m_[newest_];
  const float y_m = y_m_[point] - y_m_[newest_];
  const float z_m = z_m_[point] - z_m_[newest_];
  const float along = x_m * line.x_m + y_m * line.y_m;
  const float aside = x_m * line.y_m - y_m * line.x_m;
  const float above = z_m * line.length_m2 - line.rise_m * along;
  const bool between = (along >= 0.0f) & (along <= line.length_m2);
  const bool near = aside * aside <= kAside_m * kAside_m * line.length_m2;
  const bool level = above * above <= kHeight_m * kHeight_m * line.length_m2 * line.length_m2;
  return (between ? 1u : 0u) & (near ? 1u : 0u) & (level ? 1u : 0u) & held_[point];
}

int WireFinder::CountOn(const Line& line) const {
  uint32_t count = 0;
  HP_LOOP_BOUND(kMost)
  for (int point = 0; point < kMost; ++point) count += IsOn(line, point);
  return static_cast<int>(count);
}

inline uint32_t WireFinder::IsAbout(const Line& line, float x_m, float y_m) const {
  const float from_x_m = x_m - x_m_[newest_];
  const float from_y_m = y_m - y_m_[newest_];
  const float along = from_x_m * line.x_m + from_y_m * line.y_m;
  const float aside = from_x_m * line.y_m - from_y_m * line.x_m;
  const bool between = (along >= 0.0f) & (along <= line.length_m2);
  const bool near = aside * aside <= kAbout_m * kAbout_m * line.length_m2;
  return (between ? 1u : 0u) & (near ? 1u : 0u);
}

// Thin ones, those on the line among them, and others.
int WireFinder::CountAbout(const Line& line, int64_t since) const {
  uint32_t count = 0;
  HP_LOOP_BOUND(kMost)
  for (int point = 0; point < kMost; ++point) {
    count += IsAbout(line, x_m_[point], y_m_[point]) & held_[point];
  }
  HP_LOOP_BOUND(kMostOthers)
  for (int other = 0; other < kMostOthers; ++other) {
    const uint32_t held = other_direction_[other] >= since ? 1u : 0u;
    count += IsAbout(line, other_x_m_[other], other_y_m_[other]) & held;
  }
  return static_cast<int>(count);
}

// Of a wire of kThickness_m so many directions have a beam on it as it is thick between two beams.
bool WireFinder::IsDense(const Line& line, int count, int64_t direction, float spacing_m) const {
  int64_t first = direction;
  HP_LOOP_BOUND(kMost)
  for (int point = 0; point < kMost; ++point) {
    if (IsOn(line, point) != 0 && direction_[point] < first) first = direction_[point];
  }
  const auto across = static_cast<float>(static_cast<int32_t>(direction - first));
  return 2.0f * static_cast<float>(count) * Max(spacing_m, kThickness_m) >= across * kThickness_m;
}

std::span<const Vec3> WireFinder::Find(int64_t direction, float spacing_m) {
  if (newest_ < 0) return {};
  // Not from before the oldest of the others: what lay about it then has been forgotten.
  const int oldest_other = newest_other_ + 1 < kMostOthers ? newest_other_ + 1 : 0;
  const int64_t others_since = other_direction_[oldest_other];
  const int64_t since =
      others_since > direction - kDirections ? others_since : direction - kDirections;
  HP_LOOP_BOUND(kMost)
  for (int point = 0; point < kMost; ++point) held_[point] = direction_[point] >= since ? 1u : 0u;
  int best = -1;
  int most = kLeast - 1;
  HP_LOOP_BOUND(kMost)
  for (int point = 0; point < kMost; ++point) {
    const Line line = LineTo(point);
    const bool fits = line.length_m2 >= kShortest_m * kShortest_m &&
                      line.length_m2 <= kLongest_m * kLongest_m && held_[point] != 0;
    if (!fits) continue;
    const int count = CountOn(line);
    if (count <= most) continue;
    most = count;
    best = point;
  }
  if (best < 0) return {};
  const Line line = LineTo(best);
  if (3 * (CountAbout(line, since) - most) > most) return {};
  if (!IsDense(line, most, direction, spacing_m)) return {};
  size_t count = 0;
  HP_LOOP_BOUND(kMost)
  for (int point = 0; point < kMost; ++point) {
    if (IsOn(line, point) == 0) continue;
    found_[count] = {x_m_[point], y_m_[point], z_m_[point]};
    ++count;
  }
  return {found_, count};
}

}  // namespace hardpack
