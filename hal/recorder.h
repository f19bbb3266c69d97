// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "core/base/status.h"

namespace hardpack {

struct RecorderCounters {
  uint64_t records = 0;        // taken
  uint64_t bytes = 0;          // of these
  uint64_t dropped = 0;        // no room: the log has a marked gap there
  uint64_t written_bytes = 0;  // to the disk
  uint64_t files = 0;          // begun
  uint64_t write_errors = 0;   // disk full or missing; recording continues when possible
};

// Takes the records of a flight log (defined in hal/onboard/flight_log) and writes them to a disk,
// in order. No call blocks or allocates: what cannot be accepted is dropped and counted.
// test/hal/conformance tests every implementation against this page.
class Recorder {
 public:
  // One packet of the capture: stamp (wall clock, ns since 1970), and its bytes in two parts, so
  // that a datagram need not be copied behind its headers. kOk; kCapacityExceeded: no room, dropped
  // as a whole; kOversized: larger than any packet of a capture may be (kMaxRecord_bytes).
  virtual Status Record(int64_t time_ns, std::span<const uint8_t> head,
                        std::span<const uint8_t> body) = 0;

  // True once a new file needs its opening: what every file must begin with, so that it can be
  // replayed alone. The owner of the tick then calls BeginFile, records the opening and continues.
  virtual bool wants_opening() const = 0;
  virtual void BeginFile() = 0;

  virtual const RecorderCounters& counters() const = 0;

  static constexpr int kMaxRecord_bytes = 65536;

 protected:
  ~Recorder() = default;
};

}  // namespace hardpack
