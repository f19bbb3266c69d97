// SPDX-License-Identifier: Apache-2.0
#include "core/segmentation/texture.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {
namespace {

// Surely a surface: so many neighbours on it, and nearly all of those of the same thing.
constexpr uint32_t kSmoothNeighbours = 12;
constexpr uint32_t kSmoothShare_percent = 75;
// Vegetation: at least so many neighbours of the same thing to judge by, so few of them on one
// surface, and at least one seen past it.
constexpr uint32_t kRoughNeighbours = 4;
constexpr uint32_t kRoughShare_percent = 50;
// On level surfaces only neighbours of the same beam are near: of the four at most so many.
constexpr uint32_t kRoughRow = 2;
// Firm: so many of the four of the same beam are on its surface, however it slants.
constexpr uint32_t kFirmRow = 3;
// What stands on the ground is not passed by a lower beam of its direction, by more than this; what
// has all four neighbours on its surface may be a wire, and hang.
constexpr float kPast_m = 0.1f;
constexpr uint32_t kWholeRow = 4;
// At the rim of a surface two are, as at the ends of an upright line two of the same direction;
// loose is what has fewer of both.
constexpr uint32_t kLooseRow = 1;
// And so near to it: in dense grass, of 0.3 m of depth on average, one in nine looks so by chance.
constexpr float kFirm2_m2 = 0.05f * 0.05f;
// An upright line: more than so many of the four neighbours of the same direction are on it.
constexpr uint32_t kUprightLine = 2;

constexpr float kSameThing2_m2 = kSameThing_m * kSameThing_m;

// Counts of neighbours in one word: those on the same surface singly, of the same thing by kAround,
// those of the same beam on the same surface by kEven, and that one of the next two beams below got
// past it.
constexpr uint32_t kAround = 256;
constexpr uint32_t kEven = kAround * kAround;
constexpr uint32_t kSeenPast = 16 * kEven;

// What two neighbours that lie opposite each other add to the counts. Both are on the return's
// surface when the range changes evenly from one to the other, however the surface slants.
// Branchless, with squares for magnitudes: four returns at a time.
inline uint32_t Pair(float center, float one, float other, float roughness2_m2) {
  const float e1_m = one - center;
  const float e2_m = other - center;
  const float bend_m = e1_m + e2_m;  // twice
  const float e1_m2 = e1_m * e1_m;
  const float e2_m2 = e2_m * e2_m;
  const uint32_t near1 = e1_m2 <= kSameThing2_m2 ? 1u : 0u;
  const uint32_t near2 = e2_m2 <= kSameThing2_m2 ? 1u : 0u;
  const uint32_t even = (bend_m * bend_m <= 4.0f * roughness2_m2 ? 1u : 0u) & near1 & near2;
  return kAround * (near1 + near2) + (((e1_m2 <= roughness2_m2 ? 1u : 0u) | even) +
                                      ((e2_m2 <= roughness2_m2 ? 1u : 0u) | even));
}

// 1 where a neighbour is on the same surface by itself.
inline uint32_t Sure(float center, float one, float roughness2_m2) {
  const float error_m = one - center;
  return error_m * error_m <= roughness2_m2 ? 1u : 0u;
}

// How far the nearer in range of two neighbours is from the return, squared.
inline float Nearest(float center, float one, float other) {
  const float e1_m = one - center;
  const float e2_m = other - center;
  return Min(e1_m * e1_m, e2_m * e2_m);
}

}  // namespace

void RangeColumn::Clear() {
  HP_LOOP_BOUND(kMaxBeams + 2 * kReach_beams)
  for (float& range : range_m) range = kNoReturn_m;
}

void TextureFinder::Find(const RangeColumn* const (&columns)[kColumns], int beams,
                         const SegmentationParams& params, Texture& texture) {
  const float rough2 = params.roughness_m * params.roughness_m;
  const float alone2 = params.isolation_m * params.isolation_m;
  constexpr int kReach = RangeColumn::kReach_beams;
  const float* a = columns[0]->range_m + kReach;
  const float* b = columns[1]->range_m + kReach;
  const float* c = columns[2]->range_m + kReach;
  const float* d = columns[3]->range_m + kReach;
  const float* e = columns[4]->range_m + kReach;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int i = 0; i < beams; ++i) {
    const float center = c[i];
    counts_[i] =
        Pair(center, c[i - 1], c[i + 1], rough2) + Pair(center, c[i - 2], c[i + 2], rough2) +
        Pair(center, b[i - 2], d[i + 2], rough2) + Pair(center, b[i - 1], d[i + 1], rough2) +
        Pair(center, b[i], d[i], rough2) + Pair(center, b[i + 1], d[i - 1], rough2) +
        Pair(center, b[i + 2], d[i - 2], rough2);
  }
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int i = 0; i < beams; ++i) {
    const float center = c[i];
    counts_[i] += Pair(center, a[i - 2], e[i + 2], rough2) +
                  Pair(center, a[i - 1], e[i + 1], rough2) + Pair(center, a[i], e[i], rough2) +
                  Pair(center, a[i + 1], e[i - 1], rough2) +
                  Pair(center, a[i + 2], e[i - 2], rough2);
  }
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int i = 0; i < beams; ++i) {
    const uint32_t row = Pair(c[i], b[i], d[i], kFirm2_m2) + Pair(c[i], a[i], e[i], kFirm2_m2);
    const uint32_t past = Max(c[i - 1], c[i - 2]) - c[i] > kPast_m ? 1u : 0u;
    counts_[i] += row % kAround * kEven + past * kSeenPast;
  }
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int i = 0; i < beams; ++i) {
    const float x = c[i];
    const float beside = Min(Nearest(x, b[i], d[i]), Nearest(x, a[i], e[i]));
    const float above = Min(Nearest(x, b[i + 1], d[i + 1]), Nearest(x, a[i + 1], e[i + 1]));
    const float below = Min(Nearest(x, b[i - 1], d[i - 1]), Nearest(x, a[i - 1], e[i - 1]));
    nearest_m2_[i] = Min(Min(Nearest(x, c[i - 1], c[i + 1]), beside), Min(above, below));
  }
  HP_LOOP_BOUND_BEAMS(kMaxBeams + 2 * kReach)
  for (int i = -kReach; i < beams + kReach; ++i) {
    furthest_m_[i + kReach] = Max(Max(Max(a[i], b[i]), Max(d[i], e[i])), c[i]);
  }
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int i = 0; i < beams; ++i) {
    const float* f = furthest_m_ + i + kReach;
    const float furthest_m = Max(Max(Max(f[-2], f[-1]), Max(f[1], f[2])), f[0]);
    through_[i] = furthest_m - c[i] > kSameThing_m ? 1u : 0u;
    row_[i] = (Sure(c[i], b[i], rough2) + Sure(c[i], d[i], rough2)) +
              (Sure(c[i], a[i], rough2) + Sure(c[i], e[i], rough2));
    line_[i] = (Sure(c[i], c[i - 1], rough2) + Sure(c[i], c[i + 1], rough2)) +
               (Sure(c[i], c[i - 2], rough2) + Sure(c[i], c[i + 2], rough2));
  }
  Judge(beams, alone2, texture);
}

void TextureFinder::Judge(int beams, float alone2, Texture& texture) {
  constexpr int kReach = RangeColumn::kReach_beams;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int i = 0; i < beams; ++i) {
    const uint32_t tight = counts_[i] % kAround;
    const uint32_t around = counts_[i] / kAround % kAround;
    const uint32_t even = counts_[i] / kEven % 16u;
    const bool stands = (even == kWholeRow) | (counts_[i] < kSeenPast);
    const bool smooth =
        (tight >= kSmoothNeighbours) & (100 * tight >= kSmoothShare_percent * around);
    const bool rough = (around >= kRoughNeighbours) & (through_[i] != 0) & (row_[i] <= kRoughRow) &
                       (100 * tight < kRoughShare_percent * around);
    const bool firm = ((even >= kFirmRow) & stands) | (line_[i] > kUprightLine);
    const bool loose = (((even <= kLooseRow) & (line_[i] <= kLooseRow)) | !stands) & !firm;
    texture.look[i + kReach] = Texture::kReturn | (rough ? Texture::kRough : 0u) |
                               (smooth ? Texture::kSmooth : 0u) |
                               (nearest_m2_[i] > alone2 ? Texture::kAlone : 0u) |
                               (line_[i] > kUprightLine ? Texture::kUpright : 0u) |
                               (firm ? Texture::kFirm : 0u) | (loose ? Texture::kLoose : 0u);
  }
}

}  // namespace hardpack
