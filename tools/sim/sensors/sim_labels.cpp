// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/sensors/sim_labels.h"

#include <array>
#include <cmath>
#include <utility>

#include "hal/labels/labels.h"

namespace hardpack::sim {
namespace {

// The classes with which a return may be confused: those that the worlds have.
constexpr std::array<uint8_t, 8> kNames = {1, 3, 4, 9, 12, 18, 19, 34};

}  // namespace

void SimLabels::Advance(uint64_t now_ns, const std::vector<CastColumn>& columns,
                        std::vector<std::vector<uint8_t>>& datagrams) {
  for (const CastColumn& column : columns) {
    const bool follows = !columns_.empty() && column.frame_id == columns_.back().frame_id &&
                         column.measurement_id == columns_.back().measurement_id + 1;
    if (!columns_.empty() && !follows) Send();
    columns_.push_back(column);
    if (static_cast<int>(columns_.size()) >= settings_.columns) Send();
  }
  while (!waiting_.empty() && waiting_.front().send_ns <= now_ns) {
    datagrams.push_back(std::move(waiting_.front().bytes));
    waiting_.pop_front();
  }
}

void SimLabels::Send() {
  labels::Header header;
  header.beams = LidarBeams::kMost;
  header.frame_id = columns_.front().frame_id;
  header.first_measurement = columns_.front().measurement_id;
  header.columns = static_cast<uint16_t>(columns_.size());
  header.sequence = sequence_++;
  header.timestamp_ns = columns_.front().lidar_time_ns;
  std::vector<uint8_t> codes;
  for (const CastColumn& column : columns_) {
    for (const uint8_t label : column.labels) codes.push_back(Named(label, returns_++));
  }
  std::vector<uint8_t> bytes(labels::kMaxDatagramBytes);
  int size_bytes = 0;
  // The sizes were chosen here, so it does not fail.
  static_cast<void>(labels::Encode(header, codes, bytes, size_bytes));
  bytes.resize(static_cast<size_t>(size_bytes));
  const auto delay_ns = static_cast<uint64_t>(std::llround(settings_.delay_s * 1.0e9));
  waiting_.push_back({columns_.back().time_ns + delay_ns, std::move(bytes)});
  columns_.clear();
}

// A beam without a return keeps its label 0.
uint8_t SimLabels::Named(uint8_t label, uint64_t index) const {
  const uint64_t key = world::KeyOf(settings_.seed, world::Stream::kLabel);
  if (label != 0 && settings_.all_are != 0) return settings_.all_are;
  if (label != 0 && label == settings_.mistaken) return settings_.mistaken_for;
  if (label == 0 || world::DrawUniform(key, 2 * index) < settings_.accuracy) return label;
  const uint8_t other = kNames[world::DrawBits(key, 2 * index + 1) % kNames.size()];
  return other != label ? other : kNames[(world::DrawBits(key, 2 * index + 1) + 1) % kNames.size()];
}

}  // namespace hardpack::sim
