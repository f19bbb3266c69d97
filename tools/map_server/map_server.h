// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/grid.h"
#include "core/base/pose.h"
#include "port_linux/files/read_outcome.h"

// Occupancy maps in the format of ROS map_server (a YAML file and a PGM or PNG image) and their way
// onto the planning grid. Decides what a grey value stands for; does not plan.

namespace hardpack::map_server {

// From harmless to grave: where several pixels touch one cell, the gravest counts.
enum class Occupancy : uint8_t { kFree, kSoft, kUnknown, kHard };

// One map, as the two files say. The image's lower left corner lies at origin_map; x grows with the
// column, y upward, so the image's last row is row 0 here.
struct OccupancyMap {
  int width_px = 0;
  int height_px = 0;
  double resolution_m = 0.0;  // side of a pixel
  double origin_x_m = 0.0;    // of the lower left corner
  double origin_y_m = 0.0;
  std::vector<Occupancy> pixels;  // [height x width], rows upward

  double width_m() const { return width_px * resolution_m; }
  double height_m() const { return height_px * resolution_m; }
  bool Contains(double x_m, double y_m) const {
    return x_m >= origin_x_m && x_m < origin_x_m + width_m() && y_m >= origin_y_m &&
           y_m < origin_y_m + height_m();
  }
};

// Reads a map. p, the probability of being occupied, is 1 - white (white when `negate` is set):
//   p > occupied_thresh   hard
//   p < free_thresh       free
//   between               soft: grey ground should be avoided, but may be driven through; except
//                         that in mode trinary the value 205, which map_server's own map saver
//                         writes for unknown, is unknown regardless of free_thresh, and
//                         that in mode scale a pixel that is not opaque is unknown
// Keys: image, resolution, origin [x, y, yaw], negate, occupied_thresh, free_thresh, and mode
// (trinary, the default, or scale). Refused with a one-line message that names file and key: a
// value that is missing, of another type, not finite or out of range, a yaw other than 0, mode raw.
ReadOutcome ReadOccupancyMap(const std::string& yaml_path, OccupancyMap& map);

// The window for a plan on this map. Along an axis on which the map fits into the window, the
// window contains all of it; otherwise it is centred on the start.
GridWindow WindowFor(const OccupancyMap& map, Vec2 start_m);

// What unknown pixels become.
enum class UnknownIs : uint8_t { kFree, kSoft, kHard };

// The flags of Costmap::Flag for each cell of the window, row-major along y [kMapCells]. At any
// resolution, a cell takes the most severe of the pixels that it touches, so nothing is lost if the
// map is finer than the grid. A cell that is not entirely on the map is hard and not observed: the
// vehicle must stay on the map. Unknown cells are not observed.
std::vector<uint8_t> CellFlags(const OccupancyMap& map, const GridWindow& window,
                               UnknownIs unknown_is);

}  // namespace hardpack::map_server
