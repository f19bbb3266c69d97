// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "config/parameters.h"
#include "core/costmap/costmap.h"
#include "core/costmap/height_grid.h"

// The costmap as the headers tell it, in the most obvious way and as slow: every cell by itself,
// every neighbour looked at. Costs follow docs/algorithm.md section 1 in single precision, so that
// they are equal to the last bit of q8.

namespace hardpack {

class CostmapReference {
 public:
  struct CellValues {
    int flags = 0;
    int hard_distance2 = 0;
    int hard_depth2 = 0;
    int cost_q8 = 0;
    bool operator==(const CellValues&) const = default;
  };

  // The cells of `window`, classed by the heights that the grid has now.
  CostmapReference(const HeightGrid& heights, const GridWindow& window, const CostmapParams& params)
      : params_(params), heights_(kMapCells), terrain_(kMapCells), flags_(kMapCells) {
    for (int i = 0; i < kMapCells; ++i) heights_[Place(i)] = heights.At(window.FromIndex(i));
    for (int i = 0; i < kMapCells; ++i) {
      terrain_[Place(i)] = TerrainAt(i % kSize, i / kSize);
      flags_[Place(i)] = Classed(i % kSize, i / kSize);
      if (terrain_[Place(i)].is_too_steep) {
        int& flags = flags_[Place(i)];
        flags = (flags & ~(Costmap::kSoft | Costmap::kGrowth)) | Costmap::kHard;
      }
    }
  }

  struct TerrainValues {
    double grade_x = 0.0;
    double grade_y = 0.0;
    double grade = 0.0;
    double roughness_m = 0.0;
    bool is_too_steep = false;
  };
  const TerrainValues& TerrainAt(int index) const { return terrain_[Place(index)]; }

  // What CostmapBuilder::Mark does.
  void Mark(int index, int flags) {
    int& cell = flags_[Place(index)];
    if ((flags & (Costmap::kHard | Costmap::kPerson)) != 0) {
      cell = (cell & ~(Costmap::kSoft | Costmap::kGrowth)) | Costmap::kHard | Costmap::kObserved;
      cell |= flags & Costmap::kPerson;
    } else if ((flags & Costmap::kSoft) != 0 && (cell & Costmap::kHard) == 0) {
      cell |= Costmap::kSoft | Costmap::kObserved;
    }
  }

  // Adds the regions around the cells. Call it once, after all marks.
  void Dilate() {
    for (int i = 0; i < kMapCells; ++i) {
      if ((flags_[Place(i)] & Costmap::kHard) != 0) DilateCell(i, Costmap::kLethal);
      if ((flags_[Place(i)] & Costmap::kSoft) != 0) DilateCell(i, Costmap::kSoftRegion);
    }
  }

  int FlagsAt(int index) const { return flags_[Place(index)]; }

  // One cell, by looking at all cells around it.
  CellValues At(int index) const {
    return ValuesOf(index, [&](int flag, bool has) { return Distance2(index, flag, has); });
  }

  // [kMapCells] All cells; here the distances are found along rows first, then across them, which
  // is as exact and does not take minutes.
  std::vector<CellValues> All() const {
    const std::vector<int> to_hard = AllDistances2(Costmap::kHard, true);
    const std::vector<int> to_lethal = AllDistances2(Costmap::kLethal, true);
    const std::vector<int> out_of_lethal = AllDistances2(Costmap::kLethal, false);
    const std::vector<int> to_soft = AllDistances2(Costmap::kSoftRegion, true);
    const std::vector<int> out_of_soft = AllDistances2(Costmap::kSoftRegion, false);
    std::vector<CellValues> cells(kMapCells);
    for (int index = 0; index < kMapCells; ++index) {
      cells[Place(index)] = ValuesOf(index, [&](int flag, bool has) {
        if (flag == Costmap::kHard) return to_hard[Place(index)];
        if (flag == Costmap::kLethal) return (has ? to_lethal : out_of_lethal)[Place(index)];
        return (has ? to_soft : out_of_soft)[Place(index)];
      });
    }
    return cells;
  }

 private:
  static constexpr int kSize = kMapSize_cells;
  static constexpr int kNone = HeightGrid::kNone;

  static size_t Place(int index) { return static_cast<size_t>(index); }
  static int Rounded(float value) { return static_cast<int>(std::lround(value)); }

  // Calls visit(column, row) for the cells of the map at most `half` from one, in x and in y.
  template <typename Visit>
  static void ForSquare(int column, int row, int half, Visit visit) {
    for (int y = std::max(row - half, 0); y <= std::min(row + half, kSize - 1); ++y) {
      for (int x = std::max(column - half, 0); x <= std::min(column + half, kSize - 1); ++x) {
        visit(x, y);
      }
    }
  }

  const HeightGrid::CellHeights& HeightsAt(int column, int row) const {
    return heights_[Place(row * kSize + column)];
  }

  // The plane by least squares, over what is known within 18 m of the lowest height in the same row
  // of the same 32 columns.
  TerrainValues TerrainAt(int column, int row) const {
    const bool exists = params_.max_grade > 0.0f && params_.obstacle_rule != ObstacleRule::kInCell;
    const auto is_near = [](int at) { return at >= 128 && at < 384; };
    if (!exists || !is_near(column) || !is_near(row)) return {};
    if (!HeightsAt(column, row).ground) return {};
    int lowest_cm = kNone;
    for (int x = column / 32 * 32; x < column / 32 * 32 + 32; ++x) {
      if (HeightsAt(x, row).ground)
        lowest_cm = std::min<int>(lowest_cm, HeightsAt(x, row).lowest_cm);
    }
    double n = 0, sx = 0, sy = 0, sz = 0, sxx = 0, sxy = 0, syy = 0, sxz = 0, syz = 0, szz = 0;
    ForSquare(column, row, 2, [&](int x, int y) {
      const HeightGrid::CellHeights& cell = HeightsAt(x, y);
      if (!cell.ground || std::abs(cell.lowest_cm - lowest_cm) > 1800) return;
      const double dx = x - column;
      const double dy = y - row;
      const double z = cell.lowest_cm - lowest_cm;
      n += 1, sx += dx, sy += dy, sz += z, sxx += dx * dx, sxy += dx * dy, syy += dy * dy;
      sxz += dx * z, syz += dy * z, szz += z * z;
    });
    const double cxx = n * sxx - sx * sx;
    const double cxy = n * sxy - sx * sy;
    const double cyy = n * syy - sy * sy;
    const double cxz = n * sxz - sx * sz;
    const double cyz = n * syz - sy * sz;
    const double det = cxx * cyy - cxy * cxy;
    if (n < 8 || 5.0 * det < 4.0 * n * n * n * n) return {};
    const double a = (cxz * cyy - cyz * cxy) / det;
    const double b = (cyz * cxx - cxz * cxy) / det;
    const double variance = std::max(n * szz - sz * sz - a * cxz - b * cyz, 0.0) / (n * n);
    const double grade = std::hypot(a, b) / 20.0;
    // Heights are uncertain by 2 cm at least; det C / tr C, over n^2, is not above the places'
    // least variance.
    const double lambda = det / (n * n * (cxx + cyy));
    const double deviation = std::sqrt((variance + 4.0) / (n * lambda)) / 20.0;
    const bool is_too_steep = grade > static_cast<double>(params_.max_grade) + 2.0 * deviation;
    return {a / 20.0, b / 20.0, grade, std::sqrt(variance) / 100.0, is_too_steep};
  }

  // In sixteenths, up to 15; where it is too steep all that a byte holds.
  int TerrainCost_q8(const TerrainValues& terrain) const {
    if (terrain.is_too_steep) return 255 * 16;
    const auto beyond = [](double value, float free, float cost) {
      return static_cast<double>(cost) * std::max(value - static_cast<double>(free), 0.0);
    };
    const double cost =
        beyond(terrain.grade, params_.free_grade, params_.grade_cost) +
        beyond(terrain.roughness_m, params_.free_roughness_m, params_.roughness_cost_per_m);
    return 16 * static_cast<int>(std::lround(16.0 * std::min(cost, 15.0)));
  }

  int NearGround_cm(int column, int row) const {
    const HeightGrid::CellHeights& own = HeightsAt(column, row);
    if (own.ground) return own.lowest_cm;
    int lowest_cm = kNone;
    ForSquare(column, row, 2, [&](int x, int y) {
      const HeightGrid::CellHeights& other = HeightsAt(x, y);
      if (other.ground && !other.guessed) lowest_cm = std::min<int>(lowest_cm, other.lowest_cm);
    });
    return lowest_cm;
  }

  int Classed(int column, int row) const {
    const HeightGrid::CellHeights& own = HeightsAt(column, row);
    const bool any_hard = own.highest_hard_cm != kNone;
    const bool any_soft = own.highest_soft_cm != kNone;
    const int free = own.observed ? Costmap::kObserved : 0;
    if (!any_hard && !any_soft) return free;

    const bool in_cell = params_.obstacle_rule == ObstacleRule::kInCell;
    const int growth = !in_cell && own.growth ? Costmap::kGrowth | Costmap::kObserved : 0;
    int ground_cm = own.lowest_cm;
    bool overhead = false;
    bool ground_observed = true;
    if (!in_cell) {
      int far_cm = kNone;
      ground_observed = false;
      ForSquare(column, row, params_.ground_window_cells / 2, [&](int x, int y) {
        const HeightGrid::CellHeights& other = HeightsAt(x, y);
        far_cm = std::min<int>(far_cm, other.lowest_cm);
        ground_observed = ground_observed || other.ground;
      });
      const int near_cm = NearGround_cm(column, row);
      ground_cm = near_cm != kNone ? near_cm : far_cm;
      overhead = near_cm != kNone && !own.guessed &&
                 own.lowest_hard_cm - near_cm > Rounded(params_.clearance_height_m * 100.0f);
    }
    const int obstacle_cm = Rounded(params_.growth_height_m * 100.0f);
    if (any_hard && !overhead) {
      if (own.person) return Costmap::kHard | Costmap::kPerson | Costmap::kObserved;
      const bool high = own.highest_hard_cm - ground_cm > obstacle_cm;
      const bool low = !in_cell && own.firm;
      if (high || low || !ground_observed) return Costmap::kHard | Costmap::kObserved;
    }
    const bool high_soft = any_soft && own.highest_soft_cm - ground_cm > obstacle_cm;
    return growth | (high_soft ? Costmap::kSoft | Costmap::kObserved : free);
  }

  void DilateCell(int index, int region) {
    const double radius_cells = static_cast<double>(params_.planning_radius_m) * 5.0;
    const double radius2_cells2 = radius_cells * radius_cells + 1.0e-3;  // a rounding
    const int column = index % kSize;
    const int row = index / kSize;
    ForSquare(column, row, static_cast<int>(radius_cells) + 1, [&](int x, int y) {
      const int distance2 = (x - column) * (x - column) + (y - row) * (y - row);
      if (distance2 <= radius2_cells2) flags_[Place(y * kSize + x)] |= region;
    });
  }

  // Squared distance to the nearest cell of the map that has (or has not) a flag, saturated.
  int Distance2(int index, int flag, bool has) const {
    const int column = index % kSize;
    const int row = index / kSize;
    int nearest2 = kMaxDistance2_cells2;
    const auto look = [&](int x, int y) {
      if (x < 0 || x >= kSize || y < 0 || y >= kSize) return;
      const int distance2 = (x - column) * (x - column) + (y - row) * (y - row);
      if (((flags_[Place(y * kSize + x)] & flag) != 0) == has) {
        nearest2 = std::min(nearest2, distance2);
      }
    };
    // Square rings around the cell: the next one is further away than its number.
    for (int ring = 0; ring <= 16 && ring * ring <= nearest2; ++ring) {
      for (int along = -ring; along <= ring; ++along) {
        look(column + along, row - ring);
        look(column + along, row + ring);
        look(column - ring, row + along);
        look(column + ring, row + along);
      }
    }
    return nearest2;
  }

  std::vector<int> AllDistances2(int flag, bool has) const {
    std::vector<int> along(kMapCells);  // squared distance in the same row
    for (int index = 0; index < kMapCells; ++index) {
      along[Place(index)] = kMaxDistance2_cells2;
      const int column = index % kSize;
      for (int dx = -15; dx <= 15; ++dx) {
        if (column + dx < 0 || column + dx >= kSize) continue;
        const bool found = ((flags_[Place(index + dx)] & flag) != 0) == has;
        if (found) along[Place(index)] = std::min(along[Place(index)], dx * dx);
      }
    }
    std::vector<int> all(kMapCells, kMaxDistance2_cells2);
    for (int index = 0; index < kMapCells; ++index) {
      const int row = index / kSize;
      for (int y = std::max(row - 15, 0); y <= std::min(row + 15, kSize - 1); ++y) {
        const int distance2 = (y - row) * (y - row) + along[Place(index + (y - row) * kSize)];
        all[Place(index)] = std::min(all[Place(index)], distance2);
      }
    }
    return all;
  }

  // distance2(flag, has): to the nearest cell that has the flag, or has not.
  template <typename Distance2Of>
  CellValues ValuesOf(int index, Distance2Of distance2) const {
    CellValues cell;
    cell.flags = FlagsAt(index);
    cell.hard_distance2 = distance2(Costmap::kHard, true);
    const bool lethal = (cell.flags & Costmap::kLethal) != 0;
    const bool soft = (cell.flags & Costmap::kSoftRegion) != 0;
    cell.hard_depth2 = lethal ? distance2(Costmap::kLethal, false) : 0;
    cell.cost_q8 = Cost_q8(distance2(Costmap::kLethal, !lethal), lethal, params_.hard_edge_cost,
                           params_.hard_slope_per_m) +
                   Cost_q8(distance2(Costmap::kSoftRegion, !soft), soft, params_.soft_edge_cost,
                           params_.soft_slope_per_m);
    const bool observed = (cell.flags & Costmap::kObserved) != 0;
    if (!observed) cell.cost_q8 += Rounded(params_.unknown_cost * 256.0f);
    cell.cost_q8 += TerrainCost_q8(terrain_[Place(index)]);
    return cell;
  }

  // Of a layer, at a distance to the other side of its region's edge.
  int Cost_q8(int distance2, bool inside, float edge_cost, float slope_per_m) const {
    const float s_m = (std::sqrt(static_cast<float>(distance2)) - 0.5f) * 0.2f;
    if (inside) {
      const float depth_m = std::min(s_m, params_.planning_radius_m);
      return Rounded((edge_cost + slope_per_m * depth_m) * 256.0f);
    }
    if (s_m >= params_.halo_m) return 0;
    const float share = 1.0f - s_m / params_.halo_m;
    return Rounded(edge_cost * share * share * 256.0f);
  }

  CostmapParams params_;
  std::vector<HeightGrid::CellHeights> heights_;
  std::vector<TerrainValues> terrain_;
  std::vector<int> flags_;
};

}  // namespace hardpack
