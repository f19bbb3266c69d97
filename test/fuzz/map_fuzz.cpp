// SPDX-License-Identifier: Apache-2.0
// Any bytes as a map: up to the first zero byte the YAML file's, behind it the image's. Required: a
// map that is read has as many pixels as it says; the window holds the start, and all of the map
// where that fits into it; and every cell of it has the flags of the gravest pixel that it touches,
// or is hard and not observed where it is not wholly on the map.
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "core/costmap/costmap.h"
#include "test/fuzz/accepted.h"
#include "tools/map_server/grey_image.h"
#include "tools/map_server/map_server.h"

namespace {

using namespace hardpack;
using namespace hardpack::map_server;

void Require(bool condition) {
  if (!condition) std::abort();
}

// In memory, of this process.
std::string FolderOfProcess() {
  const std::string folder = "/dev/shm/hardpack_map_fuzz_" + std::to_string(getpid());
  mkdir(folder.c_str(), 0700);
  return folder;
}

void Write(const std::string& path, const uint8_t* data, size_t size) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
}

// The pixels of one axis that a cell touches, first .. last; `more` by what could be rounding.
struct Touched {
  int first;
  int last;
  Touched(int cell, double low_m, double resolution_m, double more) {
    constexpr double kCell_m = 0.2;
    first = static_cast<int>(std::floor((cell * kCell_m - low_m) / resolution_m - more));
    last = static_cast<int>(std::ceil(((cell + 1) * kCell_m - low_m) / resolution_m + more)) - 1;
  }
  bool IsWithin(int pixels) const { return first >= 0 && last < pixels; }
};

Occupancy Gravest(const OccupancyMap& map, const Touched& columns, const Touched& rows) {
  Occupancy gravest = Occupancy::kFree;
  for (int y = std::max(rows.first, 0); y <= std::min(rows.last, map.height_px - 1); ++y) {
    for (int x = std::max(columns.first, 0); x <= std::min(columns.last, map.width_px - 1); ++x) {
      const size_t at = static_cast<size_t>(y) * static_cast<size_t>(map.width_px);
      gravest = std::max(gravest, map.pixels[at + static_cast<size_t>(x)]);
    }
  }
  return gravest;
}

uint8_t FlagsFor(Occupancy occupancy, UnknownIs unknown_is) {
  constexpr uint8_t kUnknown[] = {0, Costmap::kSoft, Costmap::kHard};
  constexpr uint8_t kFlags[] = {Costmap::kObserved, Costmap::kSoft | Costmap::kObserved, 0,
                                Costmap::kHard | Costmap::kObserved};
  if (occupancy == Occupancy::kUnknown) return kUnknown[static_cast<int>(unknown_is)];
  return kFlags[static_cast<int>(occupancy)];
}

// Where a cell's border is a pixel's, or the map's, it may touch what lies behind it or not.
void CheckCell(const OccupancyMap& map, Cell cell, UnknownIs unknown_is, uint8_t flags) {
  constexpr double kRounding = 1e-5;
  const Touched columns(cell.x, map.origin_x_m, map.resolution_m, -kRounding);
  const Touched rows(cell.y, map.origin_y_m, map.resolution_m, -kRounding);
  const Touched more_columns(cell.x, map.origin_x_m, map.resolution_m, kRounding);
  const Touched more_rows(cell.y, map.origin_y_m, map.resolution_m, kRounding);
  const bool is_on = columns.IsWithin(map.width_px) && rows.IsWithin(map.height_px);
  const bool is_surely_on =
      more_columns.IsWithin(map.width_px) && more_rows.IsWithin(map.height_px);
  if (!is_surely_on && flags == Costmap::kHard) return;
  Require(is_on && (flags == FlagsFor(Gravest(map, columns, rows), unknown_is) ||
                    flags == FlagsFor(Gravest(map, more_columns, more_rows), unknown_is)));
}

void CheckCells(const OccupancyMap& map, Vec2 start_m, UnknownIs unknown_is) {
  const bool is_on =
      map.Contains(static_cast<double>(start_m.x_m), static_cast<double>(start_m.y_m));
  const GridWindow window = WindowFor(map, start_m);
  Require(!is_on || window.Contains(CellAt(start_m)));
  const std::vector<uint8_t> flags = CellFlags(map, window, unknown_is);
  Require(flags.size() == kMapCells);
  int on_map = 0;
  for (int index = 0; index < kMapCells; ++index) {
    const uint8_t flag = flags[static_cast<size_t>(index)];
    CheckCell(map, window.FromIndex(index), unknown_is, flag);
    on_map += flag != Costmap::kHard ? 1 : 0;
  }
  // Whole cells within the map; where they are fewer than the window's, all of them are in it.
  const double columns = std::floor(map.width_m() / 0.2) - 1.0;
  const double rows = std::floor(map.height_m() / 0.2) - 1.0;
  const bool is_told = unknown_is != UnknownIs::kHard;  // else it is hard and not observed, too
  if (!is_on || !is_told || columns < 1.0 || rows < 1.0) return;
  // Of a larger one at least a quarter of the window, with the start in its corner.
  constexpr double kHalf = kMapSize_cells / 2 - 2.0;
  const bool fits = columns < kMapSize_cells - 2.0 && rows < kMapSize_cells - 2.0;
  Require(on_map >= (fits ? columns * rows : std::min(columns, kHalf) * std::min(rows, kHalf)));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::string folder = FolderOfProcess();
  const void* zero = size == 0 ? nullptr : std::memchr(data, 0, size);
  const size_t yaml =
      zero == nullptr ? size : static_cast<size_t>(static_cast<const uint8_t*>(zero) - data);
  const size_t image = yaml < size ? yaml + 1 : size;
  // Whatever name the YAML gives, the image is the same: it can be a.pgm only.
  Write(folder + "/map.yaml", data, yaml);
  Write(folder + "/a.pgm", data + image, size - image);
  GreyImage grey;
  if (ReadGreyImage(folder + "/a.pgm", grey).ok()) {
    const auto pixels = static_cast<size_t>(grey.width_px) * static_cast<size_t>(grey.height_px);
    Require(grey.white.size() == pixels);
    Require(grey.transparent.empty() || grey.transparent.size() == pixels);
    for (const float white : grey.white) Require(white >= 0.0f && white <= 1.0f);
  }
  OccupancyMap map;
  if (!ReadOccupancyMap(folder + "/map.yaml", map).ok()) return 0;
  Require(map.width_px > 0 && map.height_px > 0 && map.resolution_m > 0.0);
  Require(std::isfinite(map.origin_x_m) && std::isfinite(map.origin_y_m));
  Require(map.pixels.size() ==
          static_cast<size_t>(map.width_px) * static_cast<size_t>(map.height_px));
  for (const Occupancy pixel : map.pixels) Require(pixel <= Occupancy::kHard);
  Accepted(grey.transparent.empty() ? "pgm" : "png");
  const Vec2 middle_m = {static_cast<float>(map.origin_x_m + 0.5 * map.width_m()),
                         static_cast<float>(map.origin_y_m + 0.5 * map.height_m())};
  CheckCells(map, size % 2 == 0 ? middle_m : Vec2{}, static_cast<UnknownIs>(size % 3));
  return 0;
}
