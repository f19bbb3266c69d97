// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/parameters.h"
#include "core/measurements/measurements.h"

// How the range image looks around each return: whether it stands alone, lies on a smooth surface,
// or in something that scatters the beams and lets some of them through, as vegetation does
// (docs/algorithm.md section 8; ours).

namespace hardpack {

// The ranges of one direction, with room around them for neighbours that do not exist.
struct RangeColumn {
  static constexpr int kReach_beams = 2;
  // Of a beam without a return: so far from every return that it is nobody's neighbour.
  static constexpr float kNoReturn_m = -1.0e9f;

  void Clear();
  float range_m[kMaxBeams + 2 * kReach_beams] = {};  // of beam b at b + kReach_beams
};

struct Texture {
  uint8_t alone[kMaxBeams] = {};   // 1: rain or dust
  uint8_t smooth[kMaxBeams] = {};  // 1: surely a surface
  uint8_t rough[kMaxBeams] = {};   // 1: looks like vegetation
};

// Looks at the 5 x 5 returns around each.
class TextureFinder {
 public:
  static constexpr int kReach_directions = 2;
  static constexpr int kColumns = 2 * kReach_directions + 1;

  // columns: in the order of the directions; the middle one is looked at. Where it has no return
  // the texture means nothing. Cost: 24 neighbours a beam.
  void Find(const RangeColumn* const (&columns)[kColumns], int beams,
            const SegmentationParams& params, Texture& texture);

 private:
  uint32_t counts_[kMaxBeams] = {};   // neighbours by kind, packed
  uint32_t row_[kMaxBeams] = {};      // neighbours of the same beam on the same surface
  uint32_t through_[kMaxBeams] = {};  // 1: a neighbour was seen past it
  float nearest_m2_[kMaxBeams] = {};  // distance in range of the nearest, squared
  float furthest_m_[kMaxBeams + 2 * RangeColumn::kReach_beams] = {};  // range, a beam
};
static_assert(std::is_trivially_copyable_v<TextureFinder>);

}  // namespace hardpack
