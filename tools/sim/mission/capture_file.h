// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "hal/recorder.h"
#include "port_linux/files/read_outcome.h"

// A Recorder into one capture file that waits for the disk: for a simulation, which nothing hurries
// and where nothing may be missing (port_linux/file_recorder.h is for a vehicle).

namespace hardpack::mission {

class CaptureFile final : public Recorder {
 public:
  // kInvalidArgument: it cannot be written. Once.
  ReadOutcome Open(const std::string& path);
  // kInvalidArgument: something could not be written, so the file is of no use.
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
