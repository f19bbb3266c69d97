// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/grid.h"
#include "core/costmap/costmap.h"

// Maps that make a stage of planning work as hard as it can, cell by cell: what a costmap's builder
// is given as flags. Made by arithmetic alone, so that they are the same on every processor.

namespace hardpack::timing {

struct AdversarialMap {
  const char* name;
  uint8_t (*flags)(int32_t x, int32_t y);  // of Costmap; 0 <= x, y < kMapSize_cells
};

inline constexpr int32_t kMiddle = kMapSize_cells / 2;

// Where the vehicle stands there is room for it.
constexpr bool IsAtStart(int32_t x, int32_t y) {
  const int32_t dx = x - kMiddle;
  const int32_t dy = y - kMiddle;
  return dx * dx + dy * dy < 14 * 14;
}

constexpr uint8_t Wall(bool is_wall, int32_t x, int32_t y) {
  return is_wall && !IsAtStart(x, y) ? Costmap::kHard | Costmap::kObserved : Costmap::kObserved;
}

constexpr uint32_t Mixed(int32_t x, int32_t y) {
  uint32_t bits = static_cast<uint32_t>(x) * 0x9e3779b1u ^ static_cast<uint32_t>(y) * 0x85ebca77u;
  bits = (bits ^ bits >> 15) * 0x2c1b3c6du;
  return bits ^ bits >> 13;
}

// How far a cell lies from the line through the middle along (along_x, along_y), a vector of so
// many cells' length, squared, at most 2^20.
constexpr int32_t BesideLine2(int32_t x, int32_t y, int32_t along_x, int32_t along_y,
                              int32_t length) {
  const int32_t across = ((x - kMiddle) * along_y - (y - kMiddle) * along_x) / length;
  return across * across;
}

inline constexpr AdversarialMap kAdversarialMaps[] = {
    {"empty", [](int32_t x, int32_t y) { return Wall(false, x, y); }},
    {"all_obstacle", [](int32_t x, int32_t y) { return Wall(true, x, y); }},
    {"one_cell",
     [](int32_t x, int32_t y) { return Wall(x == kMiddle + 60 && y == kMiddle, x, y); }},
    {"checkerboard",
     [](int32_t x, int32_t y) {
       return static_cast<uint8_t>(((x ^ y) & 1) != 0 && !IsAtStart(x, y)
                                       ? Costmap::kSoft | Costmap::kObserved
                                       : Costmap::kObserved);
     }},
    {"coarse_checkerboard",
     [](int32_t x, int32_t y) { return Wall((((x / 24) ^ (y / 24)) & 1) != 0, x, y); }},
    {"random_1", [](int32_t x, int32_t y) { return Wall(Mixed(x, y) % 100u < 1u, x, y); }},
    {"random_40", [](int32_t x, int32_t y) { return Wall(Mixed(x, y) % 100u < 40u, x, y); }},
    {"crowd",
     [](int32_t x, int32_t y) {
       const uint8_t flags = Wall(Mixed(x, y) % 1000u < 8u, x, y);
       return static_cast<uint8_t>((flags & Costmap::kHard) != 0 ? flags | Costmap::kPerson
                                                                 : int{flags});
     }},
    // People on both sides of the ways to the goals, as near as the largest vehicle passes.
    {"crowd_beside",
     [](int32_t x, int32_t y) {
       constexpr int32_t kRoom2 = 18 * 18;
       const bool is_way =
           BesideLine2(x, y, 225, 220, 314) < kRoom2 || BesideLine2(x, y, -240, 100, 260) < kRoom2;
       const int32_t dx = x - kMiddle;
       const int32_t dy = y - kMiddle;
       const bool is_free = is_way || dx * dx + dy * dy < 30 * 30;
       return is_free
                  ? uint8_t{Costmap::kObserved}
                  : static_cast<uint8_t>(Costmap::kHard | Costmap::kPerson | Costmap::kObserved);
     }},
    {"soft_random",
     [](int32_t x, int32_t y) {
       return static_cast<uint8_t>(Mixed(x, y) % 3u == 0u ? Costmap::kSoft | Costmap::kObserved
                                                          : Costmap::kObserved);
     }},
    {"unseen", [](int32_t, int32_t) { return uint8_t{0}; }},
    // Corridors of 20 cells, joined at alternating ends: the longest way.
    {"maze",
     [](int32_t x, int32_t y) {
       const bool is_wall = y % 22 < 2;
       const bool is_open = (y / 22) % 2 == 0 ? x < 20 : x >= kMapSize_cells - 20;
       return Wall(is_wall && !is_open, x, y);
     }},
    {"comb",
     [](int32_t x, int32_t y) { return Wall(x % 26 < 2 && y > 24 && x > kMiddle + 10, x, y); }},
    // Open to the goal's other side.
    {"cup",
     [](int32_t x, int32_t y) {
       const int32_t dx = x - kMiddle;
       const int32_t dy = y - kMiddle;
       const bool is_ring = dx * dx + dy * dy > 150 * 150 && dx * dx + dy * dy < 156 * 156;
       return Wall(is_ring && dx > -120, x, y);
     }},
    // Squares in each other, each open at one end.
    {"spiral",
     [](int32_t x, int32_t y) {
       const int32_t dx = x < kMiddle ? kMiddle - x : x - kMiddle;
       const int32_t dy = y < kMiddle ? kMiddle - y : y - kMiddle;
       const int32_t ring = dx > dy ? dx : dy;
       const bool is_open =
           (ring / 24) % 2 == 0 ? (x > kMiddle && dy < 12) : (x < kMiddle && dy < 12);
       return Wall(ring % 24 < 2 && ring > 24 && !is_open, x, y);
     }},
};

}  // namespace hardpack::timing
