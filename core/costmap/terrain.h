// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/parameters.h"
#include "core/base/grid.h"
#include "core/costmap/height_grid.h"
#include "core/costmap/padded_row.h"

// How steep and how rough the ground is, cell by cell: the plane that fits best, by least squares,
// through the known heights of the 5 x 5 cells (1 m) around a cell whose own height is known,
//
//   z = z_0 + a x + b y,   [a; b] = [Cxx Cxy; Cxy Cyy]^-1 [Cxz; Cyz]
//   grade = sqrt(a^2 + b^2),   roughness = sqrt((Czz - a Cxz - b Cyz) / n)
//
// with C the sums of products about the means. All sums are of whole numbers (cells, centimetres),
// so they are exact; the rest is in single precision. No plane is told where the known cells are
// fewer than kLeastCells or lie too close to a line: one ring of a lidar tells no grade across.
//
// Ground steeper than max_grade is hard, whatever the direction: on more than its friction's
// tangent a vehicle slides, along it or across (docs/algorithm.md section 1). By more than two
// standard deviations of the grade, so that neither few heights nor grass make a wall of a slope:
//   deviation = sqrt((roughness^2 + kNoise^2) / (n lambda)),   lambda = det C / (n^2 tr C)
// with C of the places alone; lambda is not above their least variance. What is less costs
//   grade_cost (grade - free_grade) + roughness_cost_per_m (roughness - free_roughness_m),
// neither term below 0, together at most kMaxCost. A ledge between cells that are known is steep:
// one of 0.55 m is hard, one of 0.3 m has a grade of 0.45. Ours; a cost for slope and roughness as
// in REFERENCES.md, [GVOM].

namespace hardpack {

class Terrain {
 public:
  static constexpr int kReach_cells = 2;
  static constexpr int kRows = 2 * kReach_cells + 1;
  static constexpr int kLeastCells = 8;
  // Only the middle half of the map's rows and columns is fitted, 25.6 m to each side: farther off
  // a lidar's rings are wider apart than a plane is.
  static constexpr int kSide_cells = kMapSize_cells / 2;
  static constexpr int kFirst = (kMapSize_cells - kSide_cells) / 2;
  static constexpr int kEnd = kFirst + kSide_cells;
  static constexpr bool IsNear(int row_or_column) {
    return row_or_column >= kFirst && row_or_column < kEnd;
  }
  // Rows of these, and those that the first and the last ones wait for.
  static constexpr int kUnits = kSide_cells + 2 * kReach_cells;
  static constexpr float kMaxCost = 15.0f;
  static constexpr float kNoise_cm = 2.0f;   // of a height, at least
  static constexpr float kMaxGrade = 1.98f;  // about the most that is told

  // The bytes that are kept of each cell.
  static constexpr float kStepsPerGrade = 64.0f;
  static constexpr float kStepsPerCm = 5.0f;  // of roughness
  static constexpr float kStepsPerCost = 16.0f;
  static constexpr int32_t kMostCost_steps = static_cast<int32_t>(kMaxCost * kStepsPerCost);

  // Of a cell; all 0 where no plane is told.
  struct Ground {
    bool is_told = false;
    float grade_x = 0.0f;  // rise per metre along odom's x and y
    float grade_y = 0.0f;
    float roughness_m = 0.0f;
    bool is_too_steep = false;
  };

  // Begins anew. With max_grade 0, or the rule kInCell, there is no layer: nothing is steep, and
  // nothing costs. Cost: constant.
  void Begin(const CostmapParams& params);

  // A row at a time: loads the heights of one, and fits the planes of the one kReach_cells before
  // it. unit: 0 .. kUnits - 1, each once, in order; the map's first cell is `origin`. Cost: a row.
  void AddRow(const HeightGrid& heights, Cell origin, int unit);

  // In a row whose planes are fitted: sets what is too steep to hard, and adds the costs; to what
  // is too steep one that no path pays. [kMapSize_cells] each, of Costmap::Flag and cost_q8.
  // Precondition: 0 <= row < kMapSize_cells. Cost: a row.
  void Flag(int row, uint8_t* flags) const;
  void AddCost(int row, uint16_t* costs_q8) const;

  // Precondition: 0 <= index < kMapCells, and all rows were added. Constant cost.
  Ground At(int index) const;

  bool exists() const { return exists_; }

 private:
  static constexpr int kCells = kSide_cells * kSide_cells;
  static constexpr int kBlock_cells = 32;  // of a row, fitted together, about one height
  static_assert(kSide_cells % kBlock_cells == 0);
  static constexpr int kColumns = kBlock_cells + 2 * kReach_cells;
  // From that height; what is further from it is not known. All of a plane of 70 degrees is.
  static constexpr int kMaxRise_cm = 1800;
  static constexpr uint8_t kTooSteep = 255;

  void FitRow(int row);
  void SumColumns(int begin, int row, int reference_cm);
  const int16_t* RowAt(int row) const { return rows_[(row + kRows) % kRows].cells(); }

  bool exists_ = false;
  float max_grade_ = 0.0f;
  float free_grade_ = 0.0f;
  float grade_cost_ = 0.0f;
  float free_roughness_cm_ = 0.0f;
  float roughness_cost_per_cm_ = 0.0f;
  // Heights of the last rows, as stored, by row; kNone: not known.
  PaddedRow<int16_t> rows_[kRows];
  alignas(16) uint8_t seen_[kMapSize_cells] = {};
  // Of one column over kRows rows, with y counted from the middle one and z from a reference.
  alignas(16) float count_[kColumns] = {};
  alignas(16) float y_[kColumns] = {};
  alignas(16) float yy_[kColumns] = {};
  alignas(16) float z_[kColumns] = {};
  alignas(16) float yz_[kColumns] = {};
  alignas(16) int32_t zz_[kColumns] = {};
  // Of the row that is being fitted: cm per cell, cm, and 1 where a plane is told, else 0; and
  // two standard deviations of the grade.
  alignas(16) float a_[kSide_cells] = {};
  alignas(16) float b_[kSide_cells] = {};
  alignas(16) float deviation_cm_[kSide_cells] = {};
  alignas(16) int32_t told_[kSide_cells] = {};
  alignas(16) float doubt_[kSide_cells] = {};
  // What is told of each of the fitted rows' cells, row by row.
  int8_t grade_x_[kCells] = {};
  int8_t grade_y_[kCells] = {};
  uint8_t roughness_[kCells] = {};  // 1 more than its steps; 0: no plane is told
  uint8_t cost_[kCells] = {};       // or kTooSteep
};
static_assert(std::is_trivially_copyable_v<Terrain>);
static_assert(sizeof(Terrain) <= kMapCells + 13 * 1024);

}  // namespace hardpack
