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

// A Recorder that writes files: pcap captures of link type LINUX_SLL2 with stamps in nanoseconds,
// one after another in a folder. Record puts the packet into a ring buffer in memory; a separate
// thread, of ordinary priority, writes the ring to the disk, since write() may take tens of
// milliseconds.
//
// While the disk is full, missing or slow the thread keeps trying, and nothing is lost until the
// ring is full. After that, records are dropped and counted; the first accepted one follows
// a Gap record (hal/onboard/flight_log) that gives the number of missing ones. Recording resumes
// once an eighth of the ring is free, so that a slow disk makes few long gaps and not many short
// ones.
//
// After Start neither thread allocates.

namespace hardpack {

struct FileRecorderConfig {
  std::string directory;
  uint64_t file_bytes = 256'000'000;        // a file that reaches it is followed by the next
  uint64_t total_bytes = 20'000'000'000;    // of all our files: the oldest are deleted
  uint64_t min_free_bytes = 1'000'000'000;  // on the disk: our oldest files go, then we wait
  size_t ring_bytes = 64'000'000;
};

class FileRecorder final : public Recorder {
 public:
  static constexpr size_t kMinRing_bytes = 1 << 20;

  FileRecorder();
  ~FileRecorder();  // Stop(0)
  FileRecorder(const FileRecorder&) = delete;
  FileRecorder& operator=(const FileRecorder&) = delete;

  // Creates the folder if it is missing, looks for our older files in it, allocates and starts the
  // thread. kInvalidArgument: the folder cannot be created or written to, or a size is useless: a
  // ring below kMinRing_bytes, a file below an eighth of the ring, a total below two files. Once.
  ReadOutcome Start(const FileRecorderConfig& config);

  // Stops recording; what is in the ring is written, for no longer than max_wait_ns, and the file
  // is closed. False if something was left over.
  bool Stop(uint64_t max_wait_ns);

  // The Recorder's functions, for one thread at a time. Before Start nothing fits.
  Status Record(int64_t time_ns, std::span<const uint8_t> head,
                std::span<const uint8_t> body) override;
  bool wants_opening() const override;
  void BeginFile() override;
  const RecorderCounters& counters() const override;

 private:
  enum class Outcome : uint8_t { kIdle, kWritten, kFailed };

  bool Resume(size_t bytes);
  bool PutPacket(int64_t time_ns, std::span<const uint8_t> head, std::span<const uint8_t> body);

  // For the writing thread.
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

  // Used by the tick thread.
  mutable RecorderCounters counters_;
  bool begun_ = false;
  uint64_t file_bytes_ = 0;       // added since the last BeginFile
  uint64_t pending_dropped_ = 0;  // since the last accepted record
  int64_t last_time_ns_ = 0;

  // Used by both threads.
  std::atomic<bool> stop_ = false;
  std::atomic<uint64_t> give_up_ns_ = 0;  // CLOCK_MONOTONIC, once stop_
  std::atomic<uint64_t> written_bytes_ = 0;
  std::atomic<uint64_t> files_ = 0;
  std::atomic<uint64_t> write_errors_ = 0;

  // Used by the writing thread.
  LogFolder folder_;
  int file_ = -1;
  uint64_t file_offset_ = 0;    // written to it
  uint64_t synced_offset_ = 0;  // of these, certainly on the disk
  uint64_t position_ = 0;       // of the ring: written up to here
  uint64_t record_start_ = 0;   // of the ring: of the record that position_ is in or before
};

}  // namespace hardpack
