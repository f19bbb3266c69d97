// SPDX-License-Identifier: Apache-2.0
#include "core/scan/mount_watch.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"

namespace hardpack {
namespace {

constexpr float kMost_rad = 2.0f;       // more than any
constexpr float kNotKnown_rad = -1.0f;  // no tilt toward there can be judged
// Tangents of the angles of the borders between the sectors of a quadrant.
constexpr float kBorders[] = {0.19891237f, 0.66817864f, 1.4966058f, 5.0273395f};
// Cosines of the angles of 0 to 3 sectors.
constexpr int kReach = 3;
constexpr float kCosines[kReach + 1] = {1.0f, 0.92387953f, 0.70710678f, 0.38268343f};

}  // namespace

// Member by member: as a whole it is too large for the stack.
void MountWatch::Reset() {
  begun_ns_ = 0;
  ClearWindow();
  windows_ = 0;
  since_ns_ = 0;
  tilt_rad_ = 0.0f;
  turned_since_ns_ = 0;
}

void MountWatch::ClearWindow() {
  least_returns_ = 0;
  HP_LOOP_BOUND(kSectors)
  for (int sector = 0; sector < kSectors; ++sector) {
    count_[sector] = 0;
    HP_LOOP_BOUND(kBins)
    for (int32_t& returns : returns_[sector]) returns = 0;
  }
}

// Anticlockwise, the first straight ahead.
int MountWatch::SectorOf(Vec2 place_body) {
  const float along_m = Abs(place_body.x_m);
  const float aside_m = Abs(place_body.y_m);
  int in_quadrant = 0;
  HP_LOOP_BOUND(4)
  for (const float border : kBorders) in_quadrant += aside_m > border * along_m ? 1 : 0;
  const int above = place_body.x_m >= 0.0f ? in_quadrant : kSectors / 2 - in_quadrant;
  return place_body.y_m >= 0.0f ? above : (kSectors - above) % kSectors;
}

void MountWatch::Add(Vec2 place_body, float step_m) {
  const float range2_m2 = place_body.x_m * place_body.x_m + place_body.y_m * place_body.y_m;
  // Also false for what is no number.
  const bool is_usable =
      range2_m2 >= kNear_m * kNear_m && IsFinite(range2_m2) && Abs(step_m) <= kMaxStep_m;
  if (!is_usable) return;
  constexpr float kPerRadian = 1.0f / kBin_rad;
  constexpr auto kMiddle = static_cast<float>(kMiddleBin);
  const float bin = Clamp(kPerRadian * step_m / Sqrt(range2_m2), -kMiddle, kMiddle - 1.0f);
  ++returns_[SectorOf(place_body)][FloorToInt(bin) + kMiddleBin];
}

void MountWatch::Advance(uint64_t now_ns) {
  if (begun_ns_ == 0) begun_ns_ = now_ns;
  if (now_ns < begun_ns_ + kWindow_ns) return;
  Judge(begun_ns_);
  begun_ns_ = now_ns;
  ClearWindow();
}

// As if the returns of a bin were spread evenly in it.
float MountWatch::MedianOf(int sector) const {
  const int32_t rank = count_[sector] / 2;
  int32_t before = 0;
  int bin = 0;
  HP_LOOP_BOUND(kBins)
  while (bin + 1 < kBins && before + returns_[sector][bin] <= rank) {
    before += returns_[sector][bin];
    ++bin;
  }
  const float inside = (static_cast<float>(rank - before) + 0.5f) /
                       Max(static_cast<float>(returns_[sector][bin]), 1.0f);
  return kBin_rad * (static_cast<float>(bin - kMiddleBin) + inside);
}

// The lower quartile of the medians of the known sectors: the ground that a turn has not lifted.
float MountWatch::Level(const float* median_rad) const {
  float least_rad[kSectors / 4 + 1];  // sorted
  int sectors = 0;
  HP_LOOP_BOUND(kSectors / 4 + 1)
  for (float& least : least_rad) least = kMost_rad;
  HP_LOOP_BOUND(kSectors)
  for (int sector = 0; sector < kSectors; ++sector) {
    if (!IsKnown(sector)) continue;
    ++sectors;
    float inserted_rad = median_rad[sector];
    HP_LOOP_BOUND(kSectors / 4 + 1)
    for (float& least : least_rad) {
      const float higher_rad = Max(least, inserted_rad);
      least = Min(least, inserted_rad);
      inserted_rad = higher_rad;
    }
  }
  return least_rad[sectors / 4];
}

// The second lowest of the sectors' estimates; kNotKnown_rad: too few sectors are known.
float MountWatch::TiltToward(int sector, const float* median_rad, float level_rad) const {
  float least_rad = kMost_rad;
  float second_rad = kMost_rad;
  int sectors = 0;
  HP_LOOP_BOUND(2 * kReach + 1)
  for (int off = -kReach; off <= kReach; ++off) {
    const int near = (sector + off) & (kSectors - 1);
    if (!IsKnown(near)) continue;
    ++sectors;
    const float tilt_rad = (median_rad[near] - level_rad) / kCosines[off < 0 ? -off : off];
    second_rad = Min(second_rad, Max(least_rad, tilt_rad));
    least_rad = Min(least_rad, tilt_rad);
  }
  return sectors < kLeastSectors ? kNotKnown_rad : Max(second_rad, 0.0f);
}

// Open ground returns many beams. The few returns that pass for ground in growth mean nothing.
void MountWatch::Count() {
  int32_t most = 0;
  HP_LOOP_BOUND(kSectors)
  for (int sector = 0; sector < kSectors; ++sector) {
    HP_LOOP_BOUND(kBins)
    for (const int32_t returns : returns_[sector]) count_[sector] += returns;
    most = count_[sector] > most ? count_[sector] : most;
  }
  const int32_t share = most / kLeastShare;
  least_returns_ = share > kLeastReturns ? share : kLeastReturns;
}

void MountWatch::Judge(uint64_t begun_ns) {
  Count();
  float median_rad[kSectors];
  HP_LOOP_BOUND(kSectors)
  for (int sector = 0; sector < kSectors; ++sector) median_rad[sector] = MedianOf(sector);
  const float level_rad = Level(median_rad);
  float most_rad = kNotKnown_rad;
  HP_LOOP_BOUND(kSectors)
  for (int sector = 0; sector < kSectors; ++sector) {
    most_rad = Max(most_rad, TiltToward(sector, median_rad, level_rad));
  }
  if (most_rad < 0.0f) return;
  tilt_rad_ = most_rad;
  if (!(tilt_rad_ > kLimit_rad)) {
    windows_ = 0;
    return;
  }
  ++windows_;
  if (windows_ == 1) since_ns_ = begun_ns;
  if (windows_ >= kWindows && turned_since_ns_ == 0) turned_since_ns_ = since_ns_;
}

}  // namespace hardpack
