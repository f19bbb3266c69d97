// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "hal/recorder.h"
#include "port_linux/files/read_outcome.h"

// A Recorder into one capture file that waits for the disk: for a simulation, which has no deadline
// and must not lose data (port_linux/file_recorder.h is for a vehicle).

namespace hardpack::mission {

class CaptureFile final : public Recorder {
 public:
  // kInvalidArgument: it cannot be written. Call once.
  ReadOutcome Open(const std::string& path);
  // kInvalidArgument: something could not be written, so the file is useless.
  ReadOutcome Close();

  Status Record(int64_t time_ns, std::span<const uint8_t> head,
                std::span<const uint8_t> body) override;
  bool wants_opening() const override { return counters_.files == 0; }
  void BeginFile() override { ++counters_.files; }
  const RecorderCounters& counters() const override { return counters_; }

 private:
  std::string path_;
  std::ofstream file_;
  RecorderCounters counters_;
};

}  // namespace hardpack::mission
