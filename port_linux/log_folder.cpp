// SPDX-License-Identifier: Apache-2.0
#include "port_linux/log_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <system_error>

namespace hardpack {
namespace {

constexpr uint32_t kMaxNumber = 999'999;
constexpr int kMaxTries = 1000;  // for a name that is not taken

// "20261121_210000" at `text`.
bool IsStamp(const char* text) {
  for (int i = 0; i < 15; ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    if (i == 8 ? text[i] != '_' : !digit) return false;
  }
  return true;
}

// The number of a file of ours in its run, or -1: not one of ours.
int64_t NumberIn(const std::string& name) {
  constexpr size_t kNumberAt = 23;  // after flight_YYYYMMDD_HHMMSS_
  const bool framed = name.size() >= kNumberAt + 8 && name.size() <= kNumberAt + 11 &&
                      name.starts_with("flight_") && IsStamp(name.c_str() + 7) &&
                      name[kNumberAt - 1] == '_' && name.ends_with(".pcap");
  if (!framed) return -1;
  int64_t number = 0;
  for (size_t i = kNumberAt; i < name.size() - 5; ++i) {
    if (name[i] < '0' || name[i] > '9') return -1;
    number = 10 * number + (name[i] - '0');
  }
  return number;
}

struct FoundFile {
  std::string run;  // its name up to the number
  int64_t number = 0;
  std::string name;
  uint64_t bytes = 0;

  bool operator<(const FoundFile& other) const {
    return run != other.run ? run < other.run : number < other.number;
  }
};

std::vector<FoundFile> FindFiles(const std::string& path, std::error_code& error) {
  std::vector<FoundFile> found;
  std::filesystem::directory_iterator entries(path, error);
  while (!error && entries != std::filesystem::directory_iterator()) {
    const std::string name = entries->path().filename().string();
    std::error_code no_file;
    const int64_t number = NumberIn(name);
    if (number >= 0 && entries->is_regular_file(no_file)) {
      const auto bytes = entries->file_size(no_file);
      if (!no_file) found.push_back({name.substr(0, 23), number, name, bytes});
    }
    entries.increment(error);
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

LogFolder::~LogFolder() {
  if (folder_ >= 0) close(folder_);
}

ReadOutcome LogFolder::Open(const std::string& path, int64_t start_s) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) return {Status::kInvalidArgument, path + ": cannot be created: " + error.message()};
  const std::vector<FoundFile> found = FindFiles(path, error);
  if (error) return {Status::kInvalidArgument, path + ": cannot be read: " + error.message()};
  folder_ = open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder_ < 0 || faccessat(folder_, ".", W_OK | X_OK, AT_EACCESS) != 0) {
    return {Status::kInvalidArgument, path + ": cannot be written to: " + std::strerror(errno)};
  }
  const std::time_t start = start_s;
  std::tm utc{};
  gmtime_r(&start, &utc);
  std::strftime(stamp_.data(), stamp_.size(), "%Y%m%d_%H%M%S", &utc);
  files_.resize(kMaxFiles);
  // If there are too many, only the newest are tracked.
  const size_t skipped = found.size() - std::min(found.size(), kMaxFiles - 1);
  for (size_t i = skipped; i < found.size(); ++i) {
    File& file = files_[count_++];
    std::snprintf(file.name.data(), kMaxName, "%s", found[i].name.c_str());
    file.bytes = found[i].bytes;
    total_bytes_ += file.bytes;
  }
  return {};
}

int LogFolder::NewFile() {
  if (count_ == kMaxFiles) {  // the oldest one is no longer tracked, but not deleted
    total_bytes_ -= files_[oldest_].bytes;
    oldest_ = (oldest_ + 1) % kMaxFiles;
    --count_;
  }
  File& file = files_[(oldest_ + count_) % kMaxFiles];
  for (int attempt = 0; attempt < kMaxTries && next_number_ <= kMaxNumber; ++attempt) {
    std::snprintf(file.name.data(), kMaxName, "flight_%s_%03u.pcap", stamp_.data(), next_number_);
    ++next_number_;
    const int made =
        openat(folder_, file.name.data(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0640);
    if (made >= 0) {
      file.bytes = 0;
      ++count_;
      return made;
    }
    if (errno == EEXIST) continue;
    --next_number_;
    return -1;
  }
  errno = EEXIST;
  return -1;
}

void LogFolder::SetSize(uint64_t bytes) {
  if (count_ == 0) return;
  File& newest = files_[(oldest_ + count_ - 1) % kMaxFiles];
  total_bytes_ = total_bytes_ - newest.bytes + bytes;
  newest.bytes = bytes;
}

uint64_t LogFolder::FreeBytes() const {
  struct statvfs medium {};
  if (fstatvfs(folder_, &medium) != 0) return UINT64_MAX;
  return uint64_t{medium.f_bavail} * medium.f_frsize;
}

bool LogFolder::DeleteOldest() {
  if (count_ < 2) return false;
  const File& file = files_[oldest_];
  // A file that somebody else deleted or protected no longer counts either.
  unlinkat(folder_, file.name.data(), 0);
  total_bytes_ -= file.bytes;
  oldest_ = (oldest_ + 1) % kMaxFiles;
  --count_;
  return true;
}

void LogFolder::DeleteNewest() {
  if (count_ == 0) return;
  const File& file = files_[(oldest_ + count_ - 1) % kMaxFiles];
  unlinkat(folder_, file.name.data(), 0);
  total_bytes_ -= file.bytes;
  --count_;
  --next_number_;
}

}  // namespace hardpack
