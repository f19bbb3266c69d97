// SPDX-License-Identifier: Apache-2.0
// Any bytes as a label datagram: checked, decoded, and, when it is one, encoded to the same bytes.
// The first two bytes choose the sensor, and whether the checksum is put right.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "core/base/crc32.h"
#include "hal/labels/labels.h"
#include "test/fuzz/accepted.h"

using hardpack::ColumnLabels;
using hardpack::Status;
using hardpack::labels::Header;

namespace {

void Require(bool condition) {
  if (!condition) std::abort();
}

// No fuzzer guesses a checksum.
void FixCrc(std::vector<uint8_t>& bytes) {
  if (bytes.size() < 4 || bytes.size() > hardpack::labels::kMaxDatagramBytes) return;
  const size_t checked = bytes.size() - 4;
  const uint32_t crc =
      hardpack::Crc32<hardpack::labels::kMaxDatagramBytes>(std::span(bytes).first(checked));
  for (size_t i = 0; i < 4; ++i) bytes[checked + i] = static_cast<uint8_t>(crc >> (8 * i));
}

void RequireRoundTrip(const Header& header, const std::vector<uint8_t>& bytes) {
  std::vector<uint8_t> codes;
  for (int index = 0; index < header.columns; ++index) {
    ColumnLabels column;
    Require(DecodeColumn(header, bytes, index, column) == Status::kOk);
    Require(column.beams == header.beams && column.frame_id == header.frame_id);
    Require(column.measurement_id == header.first_measurement + index);
    codes.insert(codes.end(), column.label, column.label + column.beams);
  }
  std::vector<uint8_t> again(bytes.size());
  int size_bytes = 0;
  Require(Encode(header, codes, again, size_bytes) == Status::kOk);
  Require(static_cast<size_t>(size_bytes) == bytes.size() && again == bytes);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 2) return 0;
  const int columns_per_revolution = 512 << (data[0] / 2 % 3);
  const int beams = 1 + data[1] % hardpack::kMaxBeams;
  std::vector<uint8_t> bytes(data + 2, data + size);
  if (data[0] % 2 == 1) FixCrc(bytes);

  Header header;
  const Status checked = CheckDatagram(bytes, beams, columns_per_revolution, header);
  if (checked == Status::kOk) {
    hardpack::Accepted("labels");
    Require(header.beams == beams);
    RequireRoundTrip(header, bytes);
    return 0;
  }
  // Whatever the header says, a column is decoded from within the bytes or not at all.
  for (int index = -1; index <= 70; ++index) {
    ColumnLabels column;
    const Status decoded = DecodeColumn(header, bytes, index, column);
    Require(decoded == Status::kOk || decoded == Status::kInvalidArgument ||
            decoded == Status::kTruncated);
    Require(column.beams >= 0 && column.beams <= hardpack::kMaxBeams);
  }
  return 0;
}
