// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <thread>

#include "hal/recorder.h"
#include "port_linux/files/read_outcome.h"
#include "port_linux/log_folder.h"
#include "port_linux/record_ring.h"

// A Recorder into files: pcap captures of link type LINUX_SLL2 with stamps in nanoseconds, one
// after another in a folder. Record puts the packet into a ring in memory; a thread of its own, of
// ordinary priority, writes the ring to the medium, since write() may take tens of milliseconds.
//
// While the medium is full, gone or slow the thread keeps trying, and nothing is lost until the
// ring is full. Then records are dropped and counted; the first one that is taken again comes
// behind a Gap record (hal/onboard/flight_log) that says how many are missing. It is taken again
// once an eighth of the ring is free, so that a slow medium makes few long gaps and not many short
// ones.
//
// After Start neither thread allocates.

namespace hardpack {

struct FileRecorderConfig {
  std::string directory;
  uint64_t file_bytes = 256'000'000;        // one that reaches it is followed by the next
  uint64_t total_bytes = 20'000'000'000;    // of our files together: the oldest go
  uint64_t min_free_bytes = 1'000'000'000;  // of the medium: our oldest files go, then we wait
  size_t ring_bytes = 64'000'000;
};

class FileRecorder final : public Recorder {
 public:
  static constexpr size_t kMinRing_bytes = 1 << 20;

  FileRecorder();
  ~FileRecorder();  // Stop(0)
  FileRecorder(const FileRecorder&) = delete;
  FileRecorder& operator=(const FileRecorder&) = delete;

  // Makes the folder where it is missing, looks for our older files in it, allocates and starts the
  // thread. kInvalidArgument: the folder cannot be made or written to, or a size is of no use: a
  // ring below kMinRing_bytes, a file below an eighth of the ring, a total below two files. Once.
  ReadOutcome Start(const FileRecorderConfig& config);

  // Nothing is recorded from now on; what is in the ring is written, for no longer than
  // max_wait_ns, and the file closed. False when something was left over.
  bool Stop(uint64_t max_wait_ns);

  // The Recorder's, for one thread at a time. Before Start nothing fits.
  Status Record(int64_t time_ns, std::span<const uint8_t> head,
                std::span<const uint8_t> body) override;
  bool wants_opening() const override;
  void BeginFile() override;
  const RecorderCounters& counters() const override;

 private:
  enum class Outcome : uint8_t { kIdle, kWritten, kFailed };

  bool Resume(size_t bytes);
  bool PutPacket(int64_t time_ns, std::span<const uint8_t> head, std::span<const uint8_t> body);

  // The thread's.
  void Run();
  Outcome WriteSome(bool everything);
  Outcome BeginNextFile();
  bool OpenFile();
  void CloseFile();
  Outcome Write(uint64_t to);
  void FollowRecords();
  bool MakeRoom(uint64_t bytes);
  void HandleError(int error);
  void AbandonFile();
  void PushToMedium(uint64_t bytes);

  FileRecorderConfig config_;
  std::unique_ptr<RecordRing> ring_;
  std::thread thread_;

  // Of the thread of the ticks.
  mutable RecorderCounters counters_;
  bool begun_ = false;
  uint64_t file_bytes_ = 0;       // put since the last BeginFile
  uint64_t pending_dropped_ = 0;  // since the last record that was taken
  int64_t last_time_ns_ = 0;

  // Of both.
  std::atomic<bool> stop_ = false;
  std::atomic<uint64_t> give_up_ns_ = 0;  // CLOCK_MONOTONIC, once stop_
  std::atomic<uint64_t> written_bytes_ = 0;
  std::atomic<uint64_t> files_ = 0;
  std::atomic<uint64_t> write_errors_ = 0;

  // Of the writing thread.
  LogFolder folder_;
  int file_ = -1;
  uint64_t file_offset_ = 0;    // written to it
  uint64_t synced_offset_ = 0;  // of these, certain to be on the medium
  uint64_t position_ = 0;       // of the ring: written up to here
  uint64_t record_start_ = 0;   // of the ring: of the record that position_ is in or before
};

}  // namespace hardpack
