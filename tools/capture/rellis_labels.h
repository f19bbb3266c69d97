// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "port_linux/files/read_outcome.h"

// Semantic labels of recorded returns, as codes of 0 .. 255. The label table gives their meaning
// for driving (core/segmentation/label_table.h; RELLIS-3D's ontology by default).

namespace hardpack::capture {

// Codes of one revolution's returns, [columns x beams], row-major; nothing where the file has no
// return.
struct ScanLabels {
  int beams = 0;
  int columns = 0;
  std::vector<std::optional<uint8_t>> codes;

  // Precondition: 0 <= measurement_id < columns, 0 <= row < beams.
  std::optional<uint8_t> At(int measurement_id, int row) const {
    return codes[static_cast<size_t>(measurement_id) * static_cast<size_t>(beams) +
                 static_cast<size_t>(row)];
  }
};

// Reads a CSV file whose header names at least the columns ring, meas_id and label, in any order;
// one return per line. The message of a failure names file, line and column: kInvalidArgument
// (cannot be opened, not a number, outside the sensor's beams x columns, an invalid code, a return
// that appears twice), kOversized (larger than 64 MiB). Precondition: beams, columns > 0.
ReadOutcome ReadLabels(const std::string& path, int beams, int columns, ScanLabels& labels);

}  // namespace hardpack::capture
