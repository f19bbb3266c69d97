// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "core/base/status.h"

namespace hardpack {

struct RecorderCounters {
  uint64_t records = 0;        // taken
  uint64_t bytes = 0;          // of these
  uint64_t dropped = 0;        // no room: the log has a gap there, and says so
  uint64_t written_bytes = 0;  // to the medium
  uint64_t files = 0;          // begun
  uint64_t write_errors = 0;   // disk full, medium gone; recording goes on when it can
};

// Takes the records of a flight log (hal/onboard/flight_log says what is in them) and writes them
// to a medium, in order. No call blocks or allocates: what cannot be taken is dropped and counted.
// test/hal/conformance holds every implementation to this page.
class Recorder {
 public:
  // One packet of the capture: stamp (wall clock, ns since 1970), and its bytes in two parts, so
  // that a datagram needs no copy behind its headers. kOk; kCapacityExceeded: no room, dropped
  // whole; kOversized: more than any packet of a capture may have (kMaxRecord_bytes).
  virtual Status Record(int64_t time_ns, std::span<const uint8_t> head,
                        std::span<const uint8_t> body) = 0;

  // True once a file has been begun that wants its opening: what any file has to begin with, so
  // that it can be replayed alone. The owner of the tick then calls BeginFile, records the opening
  // and goes on.
  virtual bool wants_opening() const = 0;
  virtual void BeginFile() = 0;

  virtual const RecorderCounters& counters() const = 0;

  static constexpr int kMaxRecord_bytes = 65536;

 protected:
  ~Recorder() = default;
};

}  // namespace hardpack
