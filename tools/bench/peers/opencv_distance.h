// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "core/costmap/costmap.h"

// OpenCV's exact distance transform, for comparison with core/costmap: cv::distanceTransform with
// DIST_L2, DIST_MASK_PRECISE (Felzenszwalb and Huttenlocher's two passes) and CV_32F, once for the
// hard layer and once for the soft one, on one thread. That is its best fair use: the only exact
// mask, no labels, images made beforehand and results in permanent matrices, so that a transform
// allocates only what OpenCV itself requests. It gives only the distance outside the obstacles and
// no costs: less than the costmap's build with which it is compared.

namespace hardpack::peers {

class OpencvDistance {
 public:
  // Sets OpenCV to one thread, for the whole process.
  OpencvDistance();
  ~OpencvDistance();

  // The two binary images: the cells of a map that are hard, and those that are soft. Not timed.
  void Load(const Costmap& map);

  // Both transforms of the images loaded last.
  void Transform();

  // Distance [cells] between the centres of each cell and of the nearest hard (soft) one; 0 in such
  // a cell. [kMapSize_cells x kMapSize_cells], row-major along y, as a Costmap. Large and
  // meaningless if there is no such cell on the whole map.
  std::span<const float> hard_distance_cells() const;
  std::span<const float> soft_distance_cells() const;

 private:
  struct Images;
  std::unique_ptr<Images> images_;
};

}  // namespace hardpack::peers
