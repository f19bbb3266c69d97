// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "port_linux/files/read_outcome.h"

// Grey images as map_server files use them: PGM (P2 and P5, 8 and 16 bit, with comments) and PNG.
// The file's first bytes determine its kind, not its name. Colour is averaged to grey.

namespace hardpack::map_server {

struct GreyImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<float> white;  // [height x width], rows downward; 0 black .. 1 white
  std::vector<uint8_t>
      transparent;  // the same shape; 1 where a PNG is not fully opaque. PGM: empty
};

// More pixels than this are refused before any memory is asked for.
inline constexpr int64_t kMaxPixels = 100'000'000;
inline constexpr int kMaxSide_px = 32767;

// On failure a one-line message that names the file and the field: missing or unreadable file,
// neither PGM nor PNG, sizes out of range, fewer or more pixels than the header says, a grey value
// above the stated maximum.
ReadOutcome ReadGreyImage(const std::string& path, GreyImage& image);

}  // namespace hardpack::map_server
