// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "config/drive_parameters.h"

namespace hardpack::sevcon {

// Bits of a data frame with an 11-bit identifier on the bus, with the maximum number of stuff bits
// and the interframe space (ISO 11898-1: 34 of its 44 bits are stuffed, plus its data).
constexpr int32_t FrameBits(int32_t data_bytes) {
  const int32_t stuffed = 34 + 8 * data_bytes;
  return 44 + 8 * data_bytes + (stuffed - 1) / 4 + 3;
}

// Largest load in percent, rounded up, of what the pair sends and requests while it drives:
// commands, reports, SYNC, heartbeats, and one request and answer per drive every 250 ms. With
// another node's SYNC, whose period is unknown, reports are assumed to be as frequent as commands.
// The bring-up, when nothing drives, is not counted. Precondition: parameters in range.
constexpr int32_t BusLoad_percent(const DriveParams& params) {
  const int32_t drives = 2;
  const int32_t report_period_ms =
      params.sync_period_ms > 0 ? params.sync_period_ms : params.command_period_ms;
  int32_t bits_per_s = drives * FrameBits(8) * (1000 / params.command_period_ms + 1);
  bits_per_s += drives * FrameBits(8) * (1000 / report_period_ms + 1);
  if (params.sync_period_ms > 0) bits_per_s += FrameBits(0) * (1000 / params.sync_period_ms + 1);
  bits_per_s += (drives + 1) * FrameBits(1) * (1000 / params.heartbeat_period_ms + 1);
  bits_per_s += drives * 2 * FrameBits(8) * 4;
  const int32_t bits_per_percent = params.bit_rate_kbps * 10;
  return (bits_per_s + bits_per_percent - 1) / bits_per_percent;
}

}  // namespace hardpack::sevcon
