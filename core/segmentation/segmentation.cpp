// SPDX-License-Identifier: Apache-2.0
#include "core/segmentation/segmentation.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/base/validate.h"

namespace hardpack {
namespace {

// A stretch where ground was looked for and not seen: more than what a lost return or a tuft leaves
// out, and wide enough for a wheel to drop into.
constexpr float kGapShare = 2.0f;
constexpr float kLeastGap_m = 1.0f;
// Between rings that lie close together the noise of their heights must not look like a slope.
// What is firm and stands no higher is not vegetation.
constexpr float kLeastSoft_m = 0.2f;
constexpr float kTallStep_m = 1.0f;
// What was tall stays so for as many directions: a crown has gaps.
constexpr uint8_t kTallMemory = 8;

}  // namespace

static_assert(Segmenter::kSpread == RangeColumn::kReach_beams);

Status Segmenter::Configure(const SegmentationParams& params, int beams) {
  configured_ = false;
  if (beams < 1 || beams > kMaxBeams) return Status::kInvalidArgument;
  if (FirstInvalidParameter(params) != nullptr) return Status::kParameterOutOfRange;
  params_ = params;
  beams_ = beams;
  configured_ = true;
  Restart();
  return Status::kOk;
}

void Segmenter::Restart() {
  pushed_ = 0;
  newest_ = 0;
  HP_LOOP_BOUND(kSlots)
  for (Direction& direction : directions_) direction.Clear();
  HP_LOOP_BOUND(kTallSteps)
  for (uint8_t& left : tall_) left = 0;
  gaps_.count = 0;
  gaps_before_[0].count = 0;
}

void Segmenter::Direction::Clear() {
  ranges.Clear();
  top = 0;
}

Status Segmenter::Push(const DirectionView& view) {
  if (!configured_) return Status::kNotStarted;
  newest_ = (newest_ + 1) % kSlots;
  if (pushed_ <= kLag) ++pushed_;
  Direction& direction = Back(0);
  Status status = Status::kOk;
  if (view.beams != beams_) {
    status = Status::kInvalidArgument;
  } else if (!Take(view, direction)) {
    status = Status::kNotFinite;
  }
  if (!IsUsable(status)) direction.Clear();
  FindTexture();
  if (ready()) Class();
  return status;
}

bool Segmenter::IsThin(int beam) const {
  const float* own_m = Classed().ranges.range_m + RangeColumn::kReach_beams + beam;
  const float past_m = *own_m + kThinPast_m;
  const float left_m = Back(kLag + 1).ranges.range_m[RangeColumn::kReach_beams + beam];
  const float right_m = Back(kLag - 1).ranges.range_m[RangeColumn::kReach_beams + beam];
  return (left_m > past_m && right_m > past_m) || (own_m[-1] > past_m && own_m[1] > past_m);
}

// False when a number is not finite.
bool Segmenter::Take(const DirectionView& view, Direction& direction) const {
  float* range_m = direction.ranges.range_m + RangeColumn::kReach_beams;
  direction.sensor_height_m = view.sensor_height_m;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int beam = 0; beam < beams_; ++beam) {
    direction.level_m[beam] = view.level_m[beam];
    direction.height_m[beam] = view.height_m[beam];
    direction.slope[beam] = view.slope[beam];
  }
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int beam = 0; beam < beams_; ++beam) {
    range_m[beam] = view.seen[beam] ? view.range_m[beam] : RangeColumn::kNoReturn_m;
  }
  // A number less itself is not 0 when it is not finite. Branchless, over all beams.
  uint32_t bad = 0;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int beam = 0; beam < beams_; ++beam) {
    const float range = range_m[beam];
    const float level = direction.level_m[beam];
    const float height = direction.height_m[beam];
    const float slope = direction.slope[beam];
    const float none = ((range - range) + (level - level)) + ((height - height) + (slope - slope));
    bad |= (none == 0.0f ? 0u : 1u) & (range != RangeColumn::kNoReturn_m ? 1u : 0u);
  }
  direction.top = beams_;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  while (direction.top > 0 && !view.seen[direction.top - 1]) --direction.top;
  return bad == 0u && IsFinite(view.sensor_height_m);
}

void Segmenter::FindTexture() {
  constexpr int kReach = TextureFinder::kReach_directions;
  const RangeColumn* columns[TextureFinder::kColumns];
  HP_LOOP_BOUND(TextureFinder::kColumns)
  for (int i = 0; i < TextureFinder::kColumns; ++i) columns[i] = &Back(2 * kReach - i).ranges;
  // The texture of the sky above is never asked for.
  Direction& direction = Back(kReach);
  texture_finder_.Find(columns, direction.top, params_, direction.texture);
}

// Classes the direction in the middle of the window.
void Segmenter::Class() {
  const Direction& direction = Back(kLag);
  result_.beams = beams_;
  FindLine(direction);
  FileHeights(direction);
  FileGround(direction);
  RememberTall(direction);
  FileSoft(direction);
}

void Segmenter::FindLine(const Direction& direction) {
  const float* range_m = direction.ranges.range_m + RangeColumn::kReach_beams;
  int count = 0;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int beam = 0; beam < beams_; ++beam) {
    candidates_.level_m[count] = direction.level_m[beam];
    candidates_.height_m[count] = direction.height_m[beam];
    candidates_.slope[count] = direction.slope[beam];
    candidates_.beam[count] = static_cast<uint8_t>(beam);
    const bool stands = range_m[beam] != RangeColumn::kNoReturn_m;
    count += stands && !direction.texture.Is(Texture::kAlone, beam) ? 1 : 0;
  }
  candidates_.count = count;
  line_.Find(candidates_, params_.max_ground_slope);
}

// Heights above ground of all returns; what is near the ground is ground, all else hard for now.
void Segmenter::FileHeights(const Direction& direction) {
  const float* range_m = direction.ranges.range_m + RangeColumn::kReach_beams;
  int point = 0;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int beam = 0; beam < beams_; ++beam) {
    result_.what[beam] = ReturnClass::kIgnored;
    result_.ground_known[beam] = false;
    result_.above_ground_m[beam] = 0.0f;
    result_.observed_from[beam] = -1;
    result_.gap_from[beam] = -1;
    if (range_m[beam] == RangeColumn::kNoReturn_m) continue;
    const float level_m = direction.level_m[beam];
    point = line_.LastPointBefore(level_m, point);
    const GroundHeight ground = line_.At(point, level_m, params_.carry_m);
    const float above_m = direction.height_m[beam] - ground.height_m;
    above_m_[beam] = above_m;
    result_.ground_known[beam] = ground.known;
    if (ground.known) result_.above_ground_m[beam] = above_m;
    if (direction.texture.Is(Texture::kAlone, beam)) continue;
    // What is firm is none as high as grass may be.
    const float band_m = direction.texture.Is(Texture::kFirm, beam)
                             ? params_.ground_band_m
                             : Max(params_.ground_band_m, kBelow_m);
    const bool is_ground = ground.known && above_m <= band_m && above_m >= -kBelow_m;
    result_.what[beam] = is_ground ? ReturnClass::kGround : ReturnClass::kHard;
  }
}

void Segmenter::FileGround(const Direction& direction) {
  gaps_before_[1] = gaps_before_[0];
  gaps_before_[0] = gaps_;
  gaps_.count = 0;
  // Between the beams of the line each beam is looked at once.
  HP_LOOP_BOUND_INNER_BEAMS(kMaxBeams, kMaxBeams)
  for (int point = 1; point < line_.size(); ++point) {
    const int beam = line_.beam(point);
    result_.what[beam] = ReturnClass::kGround;
    result_.ground_known[beam] = true;
    result_.above_ground_m[beam] = 0.0f;
    FileStretch(direction, point);
  }
}

// What is known of the ground between a point of the line and the one before it.
[[gnu::always_inline]] inline void Segmenter::FileStretch(const Direction& direction, int point) {
  const int beam = line_.beam(point);
  const int near_beam = line_.beam(point - 1);
  if (near_beam < 0) return;
  const float run_m = line_.level_m(point) - line_.level_m(point - 1);
  const float rise_m = line_.height_m(point) - line_.height_m(point - 1);
  const bool is_even = Abs(rise_m) <= params_.bridge_max_slope * run_m + kHeightNoise_m;
  if (is_even && !IsLong(direction, point, params_.bridge_factor)) {
    result_.observed_from[beam] = static_cast<int16_t>(near_beam);
  }
  const bool is_gap = run_m > kLeastGap_m &&
                      IsLong(direction, point, params_.bridge_factor * kGapShare) &&
                      !StandsBetween(near_beam, beam);
  if (!is_gap) return;
  const float middle_m = line_.level_m(point) - 0.5f * run_m;
  // A ditch is there for the directions before, too; between tufts of grass it is a matter of luck.
  if (gaps_before_[0].Hold(middle_m) && gaps_before_[1].Hold(middle_m)) {
    result_.gap_from[beam] = static_cast<int16_t>(near_beam);
  }
  gaps_.Add(line_.level_m(point - 1), line_.level_m(point));
}

void Segmenter::Gaps::Add(float from_m, float to_m) {
  if (count == kMost) return;
  low_m[count] = from_m;
  high_m[count] = to_m;
  ++count;
}

bool Segmenter::Gaps::Hold(float level_m) const {
  bool hold = false;
  HP_LOOP_BOUND(kMost)
  for (int gap = 0; gap < count; ++gap) {
    hold = hold || (level_m >= low_m[gap] && level_m <= high_m[gap]);
  }
  return hold;
}

// Whether a point of the line is further from the one before it than `factor` spacings of the
// rings.
bool Segmenter::IsLong(const Direction& direction, int point, float factor) const {
  const int near_beam = line_.beam(point - 1);
  const float run_m = line_.level_m(point) - line_.level_m(point - 1);
  const float rise_m = line_.height_m(point) - line_.height_m(point - 1);
  // The nearer beam is below the point's own, so there is a next higher one.
  const float low = direction.slope[near_beam];
  const float step_rad = (direction.slope[near_beam + 1] - low) / (1.0f + low * low);
  const float near_m = line_.level_m(point - 1);
  const float above_m = direction.sensor_height_m - line_.height_m(point - 1);
  // On rising ground the rings lie closer: R^2 da / (h + R s).
  const float closing_m = above_m * run_m + near_m * Max(rise_m, 0.0f);
  return !(closing_m > 0.0f && run_m * closing_m <= factor * near_m * near_m * step_rad * run_m);
}

// Whether a beam between two others came back from something that is not below the ground: it may
// hide the ground behind it.
[[gnu::always_inline]] inline bool Segmenter::StandsBetween(int near_beam, int beam) const {
  bool stands = false;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int between = near_beam + 1; between < beam; ++between) {
    const bool seen = result_.what[between] != ReturnClass::kIgnored;
    stands = stands || (seen && !(above_m_[between] < -kBelow_m));
  }
  return stands;
}

void Segmenter::RememberTall(const Direction& direction) {
  HP_LOOP_BOUND(kTallSteps)
  for (uint8_t& left : tall_) left = left > 0 ? static_cast<uint8_t>(left - 1) : uint8_t{0};
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int beam = 0; beam < beams_; ++beam) {
    if (result_.what[beam] != ReturnClass::kHard) continue;
    if (!(above_m_[beam] > params_.max_soft_height_m)) continue;
    const int step = FloorToInt(direction.level_m[beam] / kTallStep_m);
    if (step >= 0 && step < kTallSteps) tall_[step] = kTallMemory;
  }
}

// Whether something tall stands at that distance or a step nearer or further; what is too far to
// remember, and what touches the vehicle, counts as tall.
bool Segmenter::IsTallAt(float level_m) const {
  const int step = FloorToInt(level_m / kTallStep_m);
  if (step < 1 || step >= kTallSteps - 1) return true;
  return tall_[step - 1] != 0 || tall_[step] != 0 || tall_[step + 1] != 0;
}

// Whether a return may be soft by what is known without its neighbours: it stands on known ground,
// is no part of a post, and nothing tall is where it is.
bool Segmenter::MayBeSoft(const Direction& direction, int beam) const {
  const bool stands = result_.what[beam] == ReturnClass::kHard && result_.ground_known[beam] &&
                      result_.above_ground_m[beam] > kLeastSoft_m;
  return stands && !direction.texture.Is(Texture::kUpright, beam) &&
         !IsTallAt(direction.level_m[beam]);
}

// Counts the kinds of returns of the same thing around each of the beams from low to high.
void Segmenter::CountAround(const Direction& direction, int low, int high) {
  const float* center_m = direction.ranges.range_m + kSpread;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int beam = low; beam <= high; ++beam) around_[beam] = 0;
  HP_LOOP_BOUND(2 * kSpread + 1)
  for (int across = -kSpread; across <= kSpread; ++across) {
    const Direction& other = Back(kLag + across);
    const float* range_m = other.ranges.range_m + kSpread;
    const uint32_t* look = other.texture.look + kSpread;
    // Branchless, with squares for magnitudes: four beams at a time.
    const auto count = [=](int beam, int up) {
      const float apart_m = range_m[beam + up] - center_m[beam];
      return look[beam + up] & (apart_m * apart_m <= kSameThing_m * kSameThing_m ? ~0u : 0u);
    };
    HP_LOOP_BOUND_BEAMS(kMaxBeams)
    for (int beam = low; beam <= high; ++beam) {
      around_[beam] +=
          (count(beam, -2) + count(beam, -1)) + (count(beam, 1) + count(beam, 2)) + count(beam, 0);
    }
  }
}

void Segmenter::FileSoft(const Direction& direction) {
  int low = 0;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  while (low < beams_ && !MayBeSoft(direction, low)) ++low;
  int high = beams_ - 1;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  while (high > low && !MayBeSoft(direction, high)) --high;
  if (low >= beams_) return;
  CountAround(direction, low, high);
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int beam = low; beam <= high; ++beam) {
    const uint32_t sum = around_[beam];
    const bool leaves =
        2 * Texture::Count(sum, Texture::kRough) > Texture::Count(sum, Texture::kReturn);
    // A surface beside it: a trunk in a bush, an arm beside a body.
    const bool surface = Texture::Count(sum, Texture::kSmooth) != 0;
    if (leaves && !surface && MayBeSoft(direction, beam)) result_.what[beam] = ReturnClass::kSoft;
  }
}

}  // namespace hardpack
