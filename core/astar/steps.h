// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>

#include "core/astar/astar.h"
#include "core/base/loop_bound.h"
#include "core/costmap/costmap.h"

// Where steps lead on the map, which of them are allowed, and their costs: the rules of
// core/astar/astar.h on cell indices. Private to the search.

namespace hardpack::steps {

inline constexpr uint32_t kSize = kMapSize_cells;
static_assert(kSize == 512);
inline constexpr uint32_t kColumnMask = kSize - 1;
inline constexpr uint32_t kRowShift = 9;

// Directions are numbered anticlockwise from +x; the odd ones are diagonal.
//   3 2 1
//   4 . 0
//   5 6 7
inline constexpr int kDirections = 8;
inline constexpr uint32_t kOdd = 0xaa;
inline constexpr uint32_t kAllDirections = 0xff;
inline constexpr int32_t kDx[kDirections] = {1, 1, 0, -1, -1, -1, 0, 1};
inline constexpr int32_t kDy[kDirections] = {0, 1, 1, 1, 0, -1, -1, -1};
// Index differences, as unsigned numbers that wrap.
inline constexpr uint32_t kStep[kDirections] = {1u,  513u,      512u,      511u,
                                                ~0u, 0u - 513u, 0u - 512u, 0u - 511u};

inline uint32_t Neighbour(uint32_t index, uint32_t direction) {
  return index + kStep[direction];
}

// The allowed directions: those not blocked; diagonals only if neither adjacent direction is
// blocked. blocked: one bit per direction.
constexpr uint32_t WithoutCutCorners(uint32_t blocked) {
  const uint32_t wrapped = blocked | blocked << 8;
  const uint32_t beside = (wrapped >> 1 | wrapped >> 7) & kOdd;
  return ~(blocked | beside) & kAllDirections;
}

// One bit per direction: the neighbour may not be entered from here. For any cell.
inline uint32_t BlockedNear(const Costmap& map, uint32_t index) {
  const int32_t x = static_cast<int32_t>(index & kColumnMask);
  const int32_t y = static_cast<int32_t>(index >> kRowShift);
  // A cell that is not lethal has no depth, whatever the map stores there.
  const int depth2 = map.Lethal(static_cast<int>(index)) ? map.hard_depth2[index] : 0;
  uint32_t blocked = 0;
  HP_LOOP_BOUND(kDirections)
  for (uint32_t direction = 0; direction < kDirections; ++direction) {
    const int32_t nx = x + kDx[direction];
    const int32_t ny = y + kDy[direction];
    const bool on_map = nx >= 0 && nx < kMapSize_cells && ny >= 0 && ny < kMapSize_cells;
    const uint32_t neighbour = on_map ? Neighbour(index, direction) : index;
    const bool lethal = map.Lethal(static_cast<int>(neighbour));
    if (!on_map || (lethal && map.hard_depth2[neighbour] >= depth2)) blocked |= 1u << direction;
  }
  return blocked;
}

// The flags of four cells in a row, the first one's lowest: compilers turn this into one load.
inline uint32_t FourFlags(const Costmap& map, uint32_t index) {
  const uint8_t* const flags = map.flags + index;
  return uint32_t{flags[0]} | uint32_t{flags[1]} << 8 | uint32_t{flags[2]} << 16 |
         uint32_t{flags[3]} << 24;
}

// WithoutCutCorners for the cells around a cell, indexed by one bit per lethal cell:
//   1 4 7     directions   3 2 1
//   2 5 8                  4 . 0
//   0 3 6                  5 6 7
struct DirectionTable {
  uint8_t of[512];
};
consteval DirectionTable MakeAllowed() {
  constexpr uint32_t kBit[kDirections] = {8, 7, 4, 1, 2, 0, 3, 6};
  DirectionTable allowed{};
  HP_LOOP_BOUND(512)
  for (uint32_t lethal = 0; lethal < 512; ++lethal) {
    uint32_t blocked = 0;
    HP_LOOP_BOUND(kDirections)
    for (uint32_t direction = 0; direction < kDirections; ++direction) {
      blocked |= (lethal >> kBit[direction] & 1u) << direction;
    }
    allowed.of[lethal] = static_cast<uint8_t>(WithoutCutCorners(blocked));
  }
  return allowed;
}
inline constexpr DirectionTable kAllowed = MakeAllowed();

// The allowed directions, as WithoutCutCorners(BlockedNear()), from a cell that is not lethal and
// not at the map's border: nearly every cell.
inline uint32_t AllowedInner(const Costmap& map, uint32_t index) {
  constexpr uint32_t kShift = std::countr_zero(uint32_t{Costmap::kLethal});
  constexpr uint32_t kEach = 0x010101u << kShift;
  const uint32_t lower = FourFlags(map, index - 513) & kEach;
  const uint32_t upper = FourFlags(map, index + 510) >> 8 & kEach;  // ends on the map
  const uint32_t middle = FourFlags(map, index - 1) & kEach;
  // Three bits per column, the columns eight bits apart; then all nine together.
  const uint32_t columns = lower >> kShift | upper >> (kShift - 1) | middle >> (kShift - 2);
  return kAllowed.of[((columns & 7u) | columns >> 5 | columns >> 10) & 0x1ffu];
}

inline bool IsInner(uint32_t index) {
  const uint32_t x = index & kColumnMask;
  const uint32_t y = index >> kRowShift;
  return x - 1 < kSize - 2 && y - 1 < kSize - 2;
}

// The directions worth taking after a step in `direction`: straight ahead and up to a right angle
// to either side. The other three lead back, or to a cell that the parent reaches by a straight
// step for the price of that cell alone, which is cheaper than via this cell. (If legal from here,
// they are legal from the parent: a straight step needs only the cell itself, and the depth it must
// undercut is greater there.)
inline uint32_t WorthTaking(uint32_t direction) {
  constexpr uint32_t kAhead = 0x1f;  // directions 0 to 4, ahead of direction 2
  return std::rotl(static_cast<uint8_t>(kAhead), static_cast<int>(direction) - 2);
}

// Their index differences, the rightmost first: those for direction d are [d] to [d + 4].
inline constexpr uint32_t kStepAhead[kDirections + 4] = {kStep[6], kStep[7], kStep[0], kStep[1],
                                                         kStep[2], kStep[3], kStep[4], kStep[5],
                                                         kStep[6], kStep[7], kStep[0], kStep[1]};

inline uint32_t Length(uint32_t direction) {
  return (direction & 1u) != 0 ? kDiagonalLength : kStraightLength;
}

inline uint32_t CostOf(const Costmap& map, uint32_t index) {
  return map.cost_q8[index] < kMaxCost_q8 ? map.cost_q8[index] : uint32_t{kMaxCost_q8};
}

// The cost of the step into the cell.
inline uint32_t CostInto(const Costmap& map, uint32_t index, uint32_t direction) {
  return static_cast<uint32_t>(
      EdgeCost(static_cast<int>(Length(direction)), static_cast<int>(CostOf(map, index))));
}

}  // namespace hardpack::steps
