// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/path/path.h"

// The variables of a path for a general solver: the offset of each free point from its position on
// a seed, along the seed's normal there. The first two points and the last one (or two) stay fixed.

namespace hardpack::peers {

class MovedPath {
 public:
  static constexpr int kFirstFree = 2;

  // Precondition: at least 3 points, 4 if keep_end_heading; no chord has length 0.
  MovedPath(const WorldPath& seed, bool keep_end_heading);

  int points() const { return static_cast<int>(offsets_m_.size()); }
  int free_end() const { return free_end_; }  // after the last free point
  int free_points() const { return free_end_ - kFirstFree; }

  double* offsets_m() { return offsets_m_.data(); }              // [points], to the left
  const double* normals() const { return normals_.data(); }      // [points x 2], to the left
  const double* positions_m() const { return moved_m_.data(); }  // [points x 2], odom

  // Places the free points according to their offsets.
  void Place();

  // As placed; headings from the chords. Precondition: `path` is the seed.
  void CopyTo(WorldPath& path) const;

 private:
  int free_end_;
  std::vector<double> seed_m_;
  std::vector<double> normals_;
  std::vector<double> offsets_m_;
  std::vector<double> moved_m_;
};

// The free points spread evenly along the same line (a cubic through four points at a time, as
// core/optimizer does it); as many points.
WorldPath Spread(const WorldPath& path, bool keep_end_heading);

}  // namespace hardpack::peers
