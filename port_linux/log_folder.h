// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "port_linux/files/read_outcome.h"

// The folder of the flight logs: names new files, and deletes the oldest of ours when there are too
// many. Our files are named flight_YYYYMMDD_HHMMSS_NNN.pcap by the run's start (UTC) and the file's
// number in the run; other files in the folder are left alone. Allocates in Open only.

namespace hardpack {

class LogFolder {
 public:
  static constexpr size_t kMaxFiles = 8192;  // remembered, to be deleted in order

  LogFolder() = default;
  ~LogFolder();
  LogFolder(const LogFolder&) = delete;
  LogFolder& operator=(const LogFolder&) = delete;

  // Creates the folder if it is missing and looks for our files. `start_s`: start of the run, since
  // 1970. kInvalidArgument: it cannot be created, read or written to.
  ReadOutcome Open(const std::string& path, int64_t start_s);

  // Creates the run's next file, empty, for writing. A file descriptor, or -1 with errno.
  int NewFile();
  // Sets the present length of the newest file.
  void SetSize(uint64_t bytes);
  // Total of all our files.
  uint64_t total_bytes() const { return total_bytes_; }
  // Free space on the disk for us; UINT64_MAX if unknown.
  uint64_t FreeBytes() const;
  // Deletes the oldest of our files, but never the newest. False if there is no other.
  bool DeleteOldest();
  // Deletes the newest file because it could not be used. Its number is free again.
  void DeleteNewest();

 private:
  static constexpr size_t kMaxName = 40;
  struct File {
    std::array<char, kMaxName> name = {};
    uint64_t bytes = 0;
  };

  int folder_ = -1;
  std::array<char, 20> stamp_ = {};  // YYYYMMDD_HHMMSS
  uint32_t next_number_ = 0;
  std::vector<File> files_;  // the oldest first, a ring of kMaxFiles once full
  size_t oldest_ = 0;
  size_t count_ = 0;
  uint64_t total_bytes_ = 0;
};

}  // namespace hardpack
