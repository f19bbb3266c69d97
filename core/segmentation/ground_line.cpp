// SPDX-License-Identifier: Apache-2.0
#include "core/segmentation/ground_line.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {
namespace {

// Noise of a height: a spinning lidar's range error times the slope of its lowest beam, and the
// roughness of the ground itself.
// Two beams tell a surface from a face when on the steepest ground their returns are so far apart;
// it is a surface when they advance by this share of that.
constexpr float kBaseline_m = 0.25f;
constexpr float kAdvanceShare = 0.7f;
// Within half of that there must be no face either: a low one could be looked over. The share
// leaves room for the noise of the range.
constexpr float kShort_m = 0.5f * kBaseline_m;
constexpr float kShortShare = 0.4f;
// Candidates among which the other beam is looked for.
constexpr int kMaxLook = 16;
// Slopes are measured over so much at least.
constexpr float kSlopeBase_m = 1.0f;
// What stands higher above the line than this is on the way of the line.
constexpr float kObstacle_m = 0.1f;
// Ground does not rise by more than this above the straight line from what lies before it to what
// the next beams above meet behind it.
constexpr float kPeak_m = 0.08f;
constexpr int kPeakOrder = 2;
// An obstacle so far behind a return does not stand on the way to it.
constexpr float kSeenPast_m = 0.5f;
// Beyond an obstacle the ground may turn up by no more than this share of the steepest slope.
constexpr float kBeyondShare = 0.5f;
// The line is carried on with no more than this slope.
constexpr float kMaxCarrySlope = 0.3f;

// Of a binary search among the points of a line.
constexpr int kSearchSteps = 8;
static_assert(kMaxBeams + 1 <= 1 << kSearchSteps);

enum class Look : uint8_t { kNone, kSurface, kFace };

// Whether the way from the nearer to the farther of two returns of one direction could be driven.
//   On ground of slope s through the return at d0 along a beam of slope t0, the beam of slope t1
//   meets d0 + d0 (t1 - t0) / (s - t1).
bool Advances(const GroundCandidates& all, int low, int high, float max_slope, float share) {
  const float spread_m = all.level_m[low] * (all.slope[high] - all.slope[low]);
  const float advance_m = all.level_m[high] - all.level_m[low];
  return advance_m * (max_slope - all.slope[high]) >= share * spread_m;
}

// What the returns of the beams above a candidate say of the surface between them and it.
Look LookUp(const GroundCandidates& all, int candidate, float max_slope) {
  const float level_m = all.level_m[candidate];
  const float slope = all.slope[candidate];
  // The beams that are a baseline away, by the formula at Advances.
  const float soon = (kShort_m * max_slope + level_m * slope) / (kShort_m + level_m);
  const float later = (kBaseline_m * max_slope + level_m * slope) / (kBaseline_m + level_m);
  const int top = candidate + kMaxLook < all.count ? candidate + kMaxLook : all.count - 1;
  int i = candidate + 1;
  HP_LOOP_BOUND(kMaxLook)
  while (i <= top && all.slope[i] < soon) ++i;
  if (i <= top && !Advances(all, candidate, i, max_slope, kShortShare)) return Look::kFace;
  HP_LOOP_BOUND(kMaxLook)
  while (i <= top && all.slope[i] < later) ++i;
  if (i > top) return Look::kNone;
  const bool advances = Advances(all, candidate, i, max_slope, kAdvanceShare);
  return advances ? Look::kSurface : Look::kFace;
}

// The same of the beams below.
Look LookDown(const GroundCandidates& all, int candidate, float max_slope) {
  const float slope = all.slope[candidate];
  const float step = (max_slope - slope) / all.level_m[candidate];
  const int bottom = candidate > kMaxLook ? candidate - kMaxLook : 0;
  int i = candidate - 1;
  HP_LOOP_BOUND(kMaxLook)
  while (i >= bottom && all.slope[i] > slope - kShort_m * step) --i;
  if (i >= bottom && !Advances(all, i, candidate, max_slope, kShortShare)) return Look::kFace;
  HP_LOOP_BOUND(kMaxLook)
  while (i >= bottom && all.slope[i] > slope - kBaseline_m * step) --i;
  if (i < bottom) return Look::kNone;
  const bool advances = Advances(all, i, candidate, max_slope, kAdvanceShare);
  return advances ? Look::kSurface : Look::kFace;
}

}  // namespace

bool GroundLine::Reaches(int point, float level_m, float height_m) const {
  const float rise_m = height_m - height_m_[point];
  const float limit_m = max_slope_ * (level_m - level_m_[point]) + kHeightNoise_m;
  return rise_m <= limit_m && rise_m >= -limit_m;
}

// How much higher a place is than the line would be there if it went on as it came, or level where
// it was falling.
float GroundLine::AboveCarried(int point, float level_m, float height_m) const {
  const float carried_m = Max(slope_[point], 0.0f) * (level_m - level_m_[point]);
  return height_m - height_m_[point] - carried_m;
}

bool GroundLine::CanJoin(int point, float level_m, float height_m) const {
  // From further back too: noise must not add up to a staircase.
  if (!Reaches(point, level_m, height_m) || !Reaches(base_[point], level_m, height_m)) return false;
  if (obstacle_level_m_ <= level_m_[point] || obstacle_level_m_ > level_m + kSeenPast_m) {
    return true;
  }
  // What stands in between may be a step: the ground has to rise beyond it, not on it.
  const float run_m = Max(level_m - obstacle_level_m_, 0.0f);
  const float limit_m = kBeyondShare * max_slope_ * run_m + kHeightNoise_m;
  if (AboveCarried(point, level_m, height_m) <= limit_m) return true;
  // Or it has only come back from a dip.
  return AboveCarried(base_[point], level_m, height_m) <= kHeightNoise_m;
}

// continues: the return is no higher than the line carried on. Then it may be the edge of a
// surface: the last one before a face, or beyond one.
bool GroundLine::IsSurface(const GroundCandidates& all, int candidate, bool continues) const {
  const Look above = LookUp(all, candidate, max_slope_);
  if (above == Look::kFace && !continues) return false;
  const Look below = LookDown(all, candidate, max_slope_);
  if (below == Look::kFace && !continues) return false;
  return above == Look::kSurface || below == Look::kSurface;
}

// Whether the returns of the beams just above and below say that the return is ground: none above
// stands in front of the way to it, and none below shows that it itself stands on the ground.
bool GroundLine::IsOpen(const GroundCandidates& all, int candidate, int point) const {
  const float level_m = all.level_m[candidate];
  const float height_m = all.height_m[candidate];
  const float run_m = level_m - level_m_[point];
  const float rise_m = height_m - height_m_[point];
  const int top = candidate + kMaxOrder < all.count ? candidate + kMaxOrder : all.count - 1;
  // Seen from the line's end and from further back: what comes out of a dip is none.
  const auto is_peak = [&](int from, int beyond) {
    const float peak_m = height_m - height_m_[from] - kPeak_m;
    const float ground_m = all.height_m[beyond] - height_m_[from];
    return peak_m * (all.level_m[beyond] - level_m_[from]) > ground_m * (level_m - level_m_[from]);
  };
  HP_LOOP_BOUND(kMaxOrder)
  for (int i = candidate + 1; i <= top; ++i) {
    const float before_m = all.level_m[i] - level_m_[point];
    const float stands_m = all.height_m[i] - height_m_[point];
    if (before_m >= run_m) {
      // From where the vehicle stands the line to the first ring says nothing of the ground.
      const bool is_next = point > 0 && i <= candidate + kPeakOrder;
      if (is_next && is_peak(point, i) && is_peak(base_[point], i)) return false;
      continue;
    }
    if ((stands_m - kObstacle_m) * run_m > rise_m * before_m) return false;
  }
  const int bottom = candidate > kMaxOrder ? candidate - kMaxOrder : 0;
  HP_LOOP_BOUND(kMaxOrder)
  for (int i = candidate - 1; i >= bottom; --i) {
    const float behind_m = all.level_m[i] - level_m_[point];
    if (behind_m <= run_m) continue;
    const float ground_m = all.height_m[i] - height_m_[point];
    if ((rise_m - kObstacle_m) * behind_m > ground_m * run_m) return false;
  }
  return true;
}

int GroundLine::LastPointBefore(float level_m, int hint) const {
  const int next = hint + 1;
  if (hint < size_ && level_m_[hint] < level_m) {
    if (next >= size_ || level_m_[next] >= level_m) return hint;
    if (next + 1 >= size_ || level_m_[next + 1] >= level_m) return next;
  }
  int low = 0;
  int high = size_;  // the points from here on are not before it
  HP_LOOP_BOUND(kSearchSteps)
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    const bool before = level_m_[middle] < level_m;
    low = before ? middle : low;
    high = before ? high : middle;
  }
  return low;
}

void GroundLine::Join(int point, float level_m, float height_m, int beam) {
  // The line's levels rise: what is a base away stays so.
  int base = base_[point];
  int near = point + 1;  // the points from here on are too near
  HP_LOOP_BOUND(kSearchSteps)
  while (near - base > 1) {
    const int middle = (base + near) / 2;
    const bool is_away = level_m - level_m_[middle] >= kSlopeBase_m;
    base = is_away ? middle : base;
    near = is_away ? near : middle;
  }
  const int added = point + 1;
  level_m_[added] = level_m;
  height_m_[added] = height_m;
  // The line's levels rise, and so far from its base a quotient is finite.
  const float run_m = level_m - level_m_[base];
  slope_[added] = run_m >= kSlopeBase_m ? (height_m - height_m_[base]) / run_m : 0.0f;
  base_[added] = static_cast<int16_t>(base);
  beam_[added] = static_cast<int16_t>(beam);
  size_ = added + 1;
  obstacle_level_m_ = 0.0f;
}

void GroundLine::Find(const GroundCandidates& candidates, float max_slope) {
  size_ = 1;
  max_slope_ = max_slope;
  obstacle_level_m_ = 0.0f;
  level_m_[0] = 0.0f;
  height_m_[0] = 0.0f;
  slope_[0] = 0.0f;
  base_[0] = 0;
  beam_[0] = -1;
  int behind = 0;  // where the last one that was nearer than the line's end belonged
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int i = 0; i < candidates.count; ++i) {
    const float level_m = candidates.level_m[i];
    const float height_m = candidates.height_m[i];
    int point = size_ - 1;
    const bool takes_back = !(level_m > level_m_[point]);
    if (takes_back) point = behind = LastPointBefore(level_m, behind);
    const float above_m = AboveCarried(point, level_m, height_m);
    const bool continues = !takes_back && above_m <= kHeightNoise_m;
    if (level_m > 0.0f && CanJoin(point, level_m, height_m) &&
        IsSurface(candidates, i, continues) && (continues || IsOpen(candidates, i, point))) {
      Join(point, level_m, height_m, candidates.beam[i]);
    } else if (above_m > kObstacle_m) {
      obstacle_level_m_ = level_m;
    }
  }
}

GroundHeight GroundLine::At(int point, float level_m, float carry_m) const {
  const float run_m = level_m - level_m_[point];
  if (point + 1 >= size_) {
    const float slope = Clamp(slope_[point], -kMaxCarrySlope, kMaxCarrySlope);
    return {height_m_[point] + slope * run_m, run_m <= carry_m};
  }
  const float gap_m = level_m_[point + 1] - level_m_[point];
  const float between_m = (height_m_[point + 1] - height_m_[point]) * (run_m / gap_m);
  const float carried_m = Max(slope_[point], 0.0f) * run_m;
  return {height_m_[point] + Min(between_m, carried_m), true};
}

}  // namespace hardpack
