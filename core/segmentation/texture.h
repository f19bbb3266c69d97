// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/parameters.h"
#include "core/measurements/measurements.h"

// The look of the range image around each return: whether it stands alone, lies on a smooth
// surface, or in something that scatters the beams and lets some of them through, as vegetation
// does (docs/algorithm.md section 1; ours).

namespace hardpack {

// A neighbour within this in range belongs to the same object; one further behind was seen past it.
inline constexpr float kSameThing_m = 1.0f;

// The ranges of one direction, padded for neighbours that do not exist.
struct RangeColumn {
  static constexpr int kReach_beams = 2;
  // For a beam without a return: so far from every return that it has no neighbours.
  static constexpr float kNoReturn_m = -1.0e9f;

  void Clear();
  float range_m[kMaxBeams + 2 * kReach_beams] = {};  // of beam b at b + kReach_beams
};

// The look of each return, one word per beam, so that up to 255 of them can be counted by adding:
// the counts are in the low three bytes.
struct Texture {
  static constexpr uint32_t kReturn = 1u;         // in every word
  static constexpr uint32_t kRough = 1u << 8;     // scatters the beams, as vegetation does
  static constexpr uint32_t kSmooth = 1u << 16;   // definitely a surface
  static constexpr uint32_t kAlone = 1u << 24;    // rain or dust; not counted
  static constexpr uint32_t kUpright = 1u << 25;  // part of an upright line, as a post; not counted
  // On one surface with its neighbours of the same beam, or part of an upright line: objects with
  // few beams on them, such as a distant rock or a wire; not counted.
  static constexpr uint32_t kFirm = 1u << 26;
  static constexpr uint32_t kLoose = 1u << 27;  // neither on a surface nor at the rim of one

  static constexpr uint32_t Count(uint32_t sum, uint32_t of) { return sum / of % kRough; }
  bool Is(uint32_t kind, int at) const {
    return (look[at + RangeColumn::kReach_beams] & kind) != 0;
  }

  uint32_t look[kMaxBeams + 2 * RangeColumn::kReach_beams] = {};  // of beam b at b + kReach_beams
};

// Examines the 5 x 5 returns around each.
class TextureFinder {
 public:
  static constexpr int kReach_directions = 2;
  static constexpr int kColumns = 2 * kReach_directions + 1;

  // columns: in the order of the directions; the middle one is examined. Where it has no return the
  // texture is meaningless. Cost: 24 neighbours per beam.
  void Find(const RangeColumn* const (&columns)[kColumns], int beams,
            const SegmentationParams& params, Texture& texture);

 private:
  // Evaluates the counts of all beams.
  void Judge(int beams, float alone2, Texture& texture);

  uint32_t counts_[kMaxBeams] = {};   // neighbours by kind, packed (texture.cpp)
  uint32_t row_[kMaxBeams] = {};      // neighbours of the same beam on the same surface
  uint32_t line_[kMaxBeams] = {};     // neighbours of the same direction on it
  uint32_t through_[kMaxBeams] = {};  // 1: a neighbour was seen past it
  float nearest_m2_[kMaxBeams] = {};  // distance in range of the nearest, squared
  float furthest_m_[kMaxBeams + 2 * RangeColumn::kReach_beams] = {};  // range, per beam
};
static_assert(std::is_trivially_copyable_v<TextureFinder>);

}  // namespace hardpack
