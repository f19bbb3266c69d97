// SPDX-License-Identifier: Apache-2.0
// Any bytes as a map: up to the first zero byte the YAML file's, behind it the image's. Required: a
// map that is read has as many pixels as it says, and a cell of every window has a defined flag.
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

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
  static_cast<void>(WindowFor(map, {0.0f, 0.0f}));
  return 0;
}
