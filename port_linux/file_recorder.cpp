// SPDX-License-Identifier: Apache-2.0
#include "port_linux/file_recorder.h"

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <system_error>

#include "core/base/byte_reader.h"
#include "hal/onboard/flight_log/packets.h"
#include "hal/onboard/flight_log/records.h"

namespace hardpack {
namespace {

constexpr uint64_t kChunkBytes = uint64_t{1} << 20u;
constexpr uint64_t kBlockBytes = 4096;                // writes end on one if more data follows
constexpr uint64_t kSyncBytes = uint64_t{16} << 20u;  // most bytes not yet on the medium
constexpr int64_t kPoll_ns = 20'000'000;
constexpr int64_t kRetry_ns = 100'000'000;
constexpr int kPollsPerFlush = 5;  // that less than a chunk waits
constexpr int64_t kSecond_ns = 1'000'000'000;
constexpr uint64_t kResumeDivisor =
    8;  // this fraction of the ring must be free before records are accepted again
constexpr size_t kGapPacketBytes = flight_log::kPcapPacketHeaderBytes +
                                   flight_log::kDatagramHeadBytes + flight_log::kMaxRecordHeadBytes;

uint64_t Now_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<uint64_t>(now.tv_sec) * kSecond_ns + static_cast<uint64_t>(now.tv_nsec);
}

void Sleep(int64_t time_ns) {
  const timespec time = {0, time_ns};
  nanosleep(&time, nullptr);
}

// The tick's thread may already have had a real-time priority and its own processor when it started
// this one, which would then have inherited both.
void BecomeOrdinary() {
  const sched_param ordinary{};
  pthread_setschedparam(pthread_self(), SCHED_OTHER, &ordinary);
  cpu_set_t all;
  CPU_ZERO(&all);
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) CPU_SET(cpu, &all);
  pthread_setaffinity_np(pthread_self(), sizeof(all), &all);
  pthread_setname_np(pthread_self(), "flight-log");
}

// Errors that waiting or deleting may resolve; after any other the file is abandoned.
bool MayPass(int error) {
  return error == ENOSPC || error == EDQUOT || error == EINTR || error == EAGAIN;
}

}  // namespace

FileRecorder::FileRecorder() = default;

FileRecorder::~FileRecorder() {
  Stop(0);
}

ReadOutcome FileRecorder::Start(const FileRecorderConfig& config) {
  const auto refuse = [&config](const char* reason) -> ReadOutcome {
    return {Status::kInvalidArgument, config.directory + ": " + reason};
  };
  if (ring_ != nullptr) return refuse("recording has already been started");
  if (config.ring_bytes < kMinRing_bytes) return refuse("the log's buffer is too small");
  if (config.file_bytes < config.ring_bytes / 8) return refuse("files smaller than buffer / 8");
  if (config.total_bytes / 2 < config.file_bytes) return refuse("no room for two files");
  ReadOutcome opened = folder_.Open(config.directory, std::time(nullptr));
  if (!opened.ok()) return opened;
  config_ = config;
  ring_ = std::make_unique<RecordRing>(config.ring_bytes);
  // The thread must get no signals: they are for the one that runs the program.
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  try {
    thread_ = std::thread(&FileRecorder::Run, this);
  } catch (const std::system_error&) {
    ring_.reset();
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return ring_ == nullptr ? refuse("the log's thread cannot be started") : ReadOutcome{};
}

bool FileRecorder::Stop(uint64_t max_wait_ns) {
  if (!thread_.joinable()) return true;
  give_up_ns_.store(Now_ns() + max_wait_ns, std::memory_order_relaxed);
  stop_.store(true, std::memory_order_release);
  thread_.join();
  return position_ == ring_->End();
}

// --- The tick's thread
// ----------------------------------------------------------------------

Status FileRecorder::Record(int64_t time_ns, std::span<const uint8_t> head,
                            std::span<const uint8_t> body) {
  if (head.size() > kMaxRecord_bytes || body.size() > kMaxRecord_bytes - head.size()) {
    return Status::kOversized;
  }
  last_time_ns_ = std::max<int64_t>(time_ns, 0);
  const size_t bytes = flight_log::kPcapPacketHeaderBytes + head.size() + body.size();
  const bool taken = ring_ != nullptr && !stop_.load(std::memory_order_relaxed) && Resume(bytes) &&
                     PutPacket(last_time_ns_, head, body);
  if (!taken) {
    ++pending_dropped_;
    ++counters_.dropped;
    return Status::kCapacityExceeded;
  }
  ++counters_.records;
  counters_.bytes += head.size() + body.size();
  return Status::kOk;
}

// After records were dropped: notes that in the log, if there is room again for the note and
// `bytes`.
bool FileRecorder::Resume(size_t bytes) {
  if (pending_dropped_ == 0) return true;
  const size_t least =
      std::max<size_t>(ring_->capacity_bytes() / kResumeDivisor, kGapPacketBytes + bytes);
  if (ring_->Free() < least) return false;
  const flight_log::RecordHead gap(flight_log::GapRecord{pending_dropped_});
  constexpr flight_log::Endpoint kOwn = {flight_log::kLoopback, flight_log::kRecordPort};
  std::array<uint8_t, flight_log::kDatagramHeadBytes> head{};
  flight_log::EncodeDatagramHead(kOwn, kOwn, gap.bytes().size(), head);
  if (!PutPacket(last_time_ns_, head, gap.bytes())) return false;
  pending_dropped_ = 0;
  return true;
}

bool FileRecorder::PutPacket(int64_t time_ns, std::span<const uint8_t> head,
                             std::span<const uint8_t> body) {
  std::array<uint8_t, flight_log::kPcapPacketHeaderBytes> header{};
  flight_log::EncodePacketHeader(static_cast<uint32_t>(time_ns / kSecond_ns),
                                 static_cast<uint32_t>(time_ns % kSecond_ns),
                                 static_cast<uint32_t>(head.size() + body.size()), header);
  const std::array<std::span<const uint8_t>, 3> parts = {header, head, body};
  if (!ring_->Put(parts)) return false;
  file_bytes_ += header.size() + head.size() + body.size();
  return true;
}

bool FileRecorder::wants_opening() const {
  const bool due = ring_ != nullptr && (!begun_ || file_bytes_ >= config_.file_bytes);
  return due && ring_->Free() >= ring_->capacity_bytes() / kResumeDivisor;
}

void FileRecorder::BeginFile() {
  if (ring_ == nullptr) return;
  // A gap belongs to the file that contains it.
  if (begun_) static_cast<void>(Resume(0));
  if (!ring_->StartFile()) return;
  begun_ = true;
  file_bytes_ = 0;
}

const RecorderCounters& FileRecorder::counters() const {
  counters_.written_bytes = written_bytes_.load(std::memory_order_relaxed);
  counters_.files = files_.load(std::memory_order_relaxed);
  counters_.write_errors = write_errors_.load(std::memory_order_relaxed);
  return counters_;
}

// --- The writing thread
// ---------------------------------------------------------------------------

void FileRecorder::Run() {
  BecomeOrdinary();
  int idle_polls = 0;
  while (true) {
    // In this order, so that records put before stop_ are seen.
    const bool stopping = stop_.load(std::memory_order_acquire);
    const Outcome outcome = WriteSome(stopping || idle_polls >= kPollsPerFlush);
    if (outcome == Outcome::kWritten) {
      idle_polls = 0;
    } else if (stopping && outcome == Outcome::kIdle) {
      break;
    }
    if (stopping && Now_ns() >= give_up_ns_.load(std::memory_order_relaxed)) break;
    if (outcome == Outcome::kFailed) Sleep(kRetry_ns);
    if (outcome == Outcome::kIdle) {
      Sleep(kPoll_ns);
      ++idle_polls;
    }
  }
  CloseFile();
}

// Writes one chunk, if there is one; less only if `everything` is to be written.
FileRecorder::Outcome FileRecorder::WriteSome(bool everything) {
  const uint64_t end = ring_->End();
  uint64_t limit = end;
  const bool file_starts = ring_->NextFileStart(end, limit);
  if (file_starts && position_ == limit) return BeginNextFile();
  if (position_ == limit) return Outcome::kIdle;
  if (!everything && !file_starts && limit - position_ < kChunkBytes) return Outcome::kIdle;
  // No file may have been begun, or the last one was abandoned.
  if (file_ < 0 && !OpenFile()) return Outcome::kFailed;
  uint64_t to = limit;
  if (limit - position_ > kChunkBytes) {
    to = position_ + kChunkBytes;
    to -= (file_offset_ + kChunkBytes) % kBlockBytes;
  }
  return Write(to);
}

FileRecorder::Outcome FileRecorder::BeginNextFile() {
  CloseFile();
  if (!OpenFile()) return Outcome::kFailed;
  ring_->TakeFileStart();
  return Outcome::kWritten;
}

bool FileRecorder::OpenFile() {
  file_ = folder_.NewFile();
  if (file_ < 0) {
    HandleError(errno);
    return false;
  }
  std::array<uint8_t, flight_log::kPcapFileHeaderBytes> header{};
  flight_log::EncodeFileHeader(header);
  const ssize_t written = write(file_, header.data(), header.size());
  if (written != static_cast<ssize_t>(header.size())) {
    HandleError(written < 0 ? errno : ENOSPC);
    close(file_);
    file_ = -1;
    folder_.DeleteNewest();
    return false;
  }
  file_offset_ = header.size();
  synced_offset_ = 0;
  folder_.SetSize(file_offset_);
  files_.fetch_add(1, std::memory_order_relaxed);
  return true;
}

void FileRecorder::CloseFile() {
  if (file_ < 0) return;
  fdatasync(file_);
  close(file_);
  file_ = -1;
}

FileRecorder::Outcome FileRecorder::Write(uint64_t to) {
  const std::span<const uint8_t> bytes = ring_->Peek(position_, to);
  if (!MakeRoom(bytes.size())) {
    write_errors_.fetch_add(1, std::memory_order_relaxed);
    return Outcome::kFailed;
  }
  const ssize_t written = write(file_, bytes.data(), bytes.size());
  if (written <= 0) {
    const int error = written < 0 ? errno : ENOSPC;
    HandleError(error);
    if (!MayPass(error)) AbandonFile();
    return Outcome::kFailed;
  }
  position_ += static_cast<uint64_t>(written);
  PushToMedium(static_cast<uint64_t>(written));
  written_bytes_.fetch_add(static_cast<uint64_t>(written), std::memory_order_relaxed);
  FollowRecords();
  return Outcome::kWritten;
}

// Releases the room of completely written records. A partly written one is kept: if the file fails,
// the next one begins with it.
void FileRecorder::FollowRecords() {
  while (record_start_ < position_) {
    std::array<uint8_t, flight_log::kPcapPacketHeaderBytes> header{};
    ring_->Copy(record_start_, header);
    const uint64_t end = record_start_ + header.size() + ByteReader(header).U32(8);
    if (end > position_) break;
    record_start_ = end;
  }
  ring_->Release(record_start_);
}

// Keeps within the limits by deleting the oldest files. False if that is not enough.
bool FileRecorder::MakeRoom(uint64_t bytes) {
  while (folder_.total_bytes() + bytes > config_.total_bytes) {
    if (!folder_.DeleteOldest()) break;  // only the present file is left, which will end
  }
  while (folder_.FreeBytes() < config_.min_free_bytes + bytes) {
    if (!folder_.DeleteOldest()) return false;
  }
  return true;
}

void FileRecorder::HandleError(int error) {
  write_errors_.fetch_add(1, std::memory_order_relaxed);
  if (error == ENOSPC || error == EDQUOT) folder_.DeleteOldest();
}

// The file is kept up to its last complete record; the next file continues after that.
void FileRecorder::AbandonFile() {
  const uint64_t half_record = position_ - record_start_;
  if (file_offset_ >= half_record) {
    // If this fails too, readers find a truncated record.
    if (ftruncate(file_, static_cast<off_t>(file_offset_ - half_record)) == 0) {
      folder_.SetSize(file_offset_ - half_record);
    }
  }
  position_ = record_start_;
  CloseFile();
}

// Starts writing to the medium at once and waits for it now and then: otherwise the kernel collects
// gigabytes and then blocks every writer.
void FileRecorder::PushToMedium(uint64_t bytes) {
  sync_file_range(file_, static_cast<off_t>(file_offset_), static_cast<off_t>(bytes),
                  SYNC_FILE_RANGE_WRITE);
  file_offset_ += bytes;
  folder_.SetSize(file_offset_);
  if (file_offset_ - synced_offset_ < kSyncBytes) return;
  fdatasync(file_);
  // It will not be read soon: others need the memory more.
  posix_fadvise(file_, static_cast<off_t>(synced_offset_),
                static_cast<off_t>(file_offset_ - synced_offset_), POSIX_FADV_DONTNEED);
  synced_offset_ = file_offset_;
}

}  // namespace hardpack
