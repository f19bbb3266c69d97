// SPDX-License-Identifier: Apache-2.0
#include "core/segmentation/texture.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {
namespace {

// A neighbour within this is part of the same thing; one further behind was seen past it.
constexpr float kSameThing_m = 1.0f;
// Surely a surface: so many neighbours on it, and nearly all of those of the same thing.
constexpr uint32_t kSmoothNeighbours = 12;
constexpr uint32_t kSmoothShare_percent = 75;
// Vegetation: at least so many neighbours of the same thing to judge by, so few on one surface, and
// at least so many seen past it.
constexpr uint32_t kRoughNeighbours = 4;
constexpr uint32_t kRoughShare_percent = 50;
constexpr uint32_t kRoughThrough = 1;
// On level surfaces only neighbours of the same beam are near: of the four at most so many.
constexpr uint32_t kRoughRow = 2;

// Counts of neighbours in one word: on the same surface, of the same thing, far behind.
constexpr uint32_t kTightShift = 0;
constexpr uint32_t kAroundShift = 8;
constexpr uint32_t kThroughShift = 16;
constexpr uint32_t kCountMask = 0xffu;

// What two neighbours that lie opposite each other add to the counts. Both are on the return's
// surface when the range changes evenly from one to the other, however the surface slants.
// Branchless, with squares for magnitudes: four returns at a time.
inline uint32_t Pair(float center, float one, float other, float roughness2_m2) {
  const float e1_m = one - center;
  const float e2_m = other - center;
  const float bend_m = 0.5f * (e1_m + e2_m);
  constexpr float kSameThing2_m2 = kSameThing_m * kSameThing_m;
  const uint32_t same1 = e1_m * e1_m <= kSameThing2_m2 ? 1u : 0u;
  const uint32_t same2 = e2_m * e2_m <= kSameThing2_m2 ? 1u : 0u;
  const uint32_t even = (bend_m * bend_m <= roughness2_m2 ? 1u : 0u) & same1 & same2;
  const uint32_t tight1 = (e1_m * e1_m <= roughness2_m2 ? 1u : 0u) | even;
  const uint32_t tight2 = (e2_m * e2_m <= roughness2_m2 ? 1u : 0u) | even;
  const uint32_t through = (e1_m > kSameThing_m ? 1u : 0u) + (e2_m > kSameThing_m ? 1u : 0u);
  return ((tight1 + tight2) << kTightShift) + ((same1 + same2) << kAroundShift) +
         (through << kThroughShift);
}

// How many of two neighbours are not further away in range than isolation.
inline uint32_t Near(float center, float one, float other, float isolation2_m2) {
  const float e1_m = one - center;
  const float e2_m = other - center;
  return (e1_m * e1_m <= isolation2_m2 ? 1u : 0u) + (e2_m * e2_m <= isolation2_m2 ? 1u : 0u);
}

}  // namespace

void RangeColumn::Clear() {
  HP_LOOP_BOUND(kMaxBeams + 2 * kReach_beams)
  for (float& range : range_m) range = kNoReturn_m;
}

void TextureFinder::Find(const RangeColumn* const (&columns)[kColumns], int beams,
                         const SegmentationParams& params, Texture& texture) {
  const float rough2 = params.roughness_m * params.roughness_m;
  const float near2 = params.isolation_m * params.isolation_m;
  const float* a = columns[0]->range_m + RangeColumn::kReach_beams;
  const float* b = columns[1]->range_m + RangeColumn::kReach_beams;
  const float* c = columns[2]->range_m + RangeColumn::kReach_beams;
  const float* d = columns[3]->range_m + RangeColumn::kReach_beams;
  const float* e = columns[4]->range_m + RangeColumn::kReach_beams;
  HP_LOOP_BOUND(kMaxBeams)
  for (int i = 0; i < beams; ++i) {
    const float center = c[i];
    counts_[i] =
        Pair(center, c[i - 1], c[i + 1], rough2) + Pair(center, c[i - 2], c[i + 2], rough2) +
        Pair(center, b[i - 2], d[i + 2], rough2) + Pair(center, b[i - 1], d[i + 1], rough2) +
        Pair(center, b[i], d[i], rough2) + Pair(center, b[i + 1], d[i - 1], rough2) +
        Pair(center, b[i + 2], d[i - 2], rough2);
  }
  HP_LOOP_BOUND(kMaxBeams)
  for (int i = 0; i < beams; ++i) {
    const float center = c[i];
    counts_[i] += Pair(center, a[i - 2], e[i + 2], rough2) +
                  Pair(center, a[i - 1], e[i + 1], rough2) + Pair(center, a[i], e[i], rough2) +
                  Pair(center, a[i + 1], e[i - 1], rough2) +
                  Pair(center, a[i + 2], e[i - 2], rough2);
  }
  HP_LOOP_BOUND(kMaxBeams)
  for (int i = 0; i < beams; ++i) {
    const float center = c[i];
    near_[i] = Near(center, c[i - 1], c[i + 1], near2) + Near(center, b[i - 1], d[i + 1], near2) +
               Near(center, b[i], d[i], near2) + Near(center, b[i + 1], d[i - 1], near2) +
               Near(center, a[i - 1], e[i + 1], near2) + Near(center, a[i], e[i], near2) +
               Near(center, a[i + 1], e[i - 1], near2);
  }
  HP_LOOP_BOUND(kMaxBeams)
  for (int i = 0; i < beams; ++i) {
    row_[i] = Near(c[i], b[i], d[i], rough2) + Near(c[i], a[i], e[i], rough2);
  }
  HP_LOOP_BOUND(kMaxBeams)
  for (int i = 0; i < beams; ++i) {
    const uint32_t tight = counts_[i] >> kTightShift & kCountMask;
    const uint32_t around = counts_[i] >> kAroundShift & kCountMask;
    const uint32_t through = counts_[i] >> kThroughShift & kCountMask;
    const bool smooth =
        (tight >= kSmoothNeighbours) & (100 * tight >= kSmoothShare_percent * around);
    const bool rough = (around >= kRoughNeighbours) & (through >= kRoughThrough) &
                       (100 * tight < kRoughShare_percent * around) & (row_[i] <= kRoughRow);
    texture.alone[i] = near_[i] == 0 ? 1 : 0;
    texture.smooth[i] = smooth ? 1 : 0;
    texture.rough[i] = rough ? 1 : 0;
  }
}

}  // namespace hardpack
