// SPDX-License-Identifier: Apache-2.0
#include "port_linux/files/read_file.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

namespace hardpack {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

ReadOutcome SystemFailure(const std::string& path, const char* what) {
  const int code = errno;
  return {Status::kInvalidArgument, path + ": " + what + " (" + std::strerror(code) + ")"};
}

}  // namespace

ReadOutcome ReadFile(const std::string& path, size_t max_bytes, std::string& text) {
  text.clear();
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rb"));
  if (file == nullptr) return SystemFailure(path, "cannot be opened");
  std::array<char, 16384> part;
  while (const size_t got = std::fread(part.data(), 1, part.size(), file.get())) {
    text.append(part.data(), got);
    if (text.size() > max_bytes) {
      text.clear();
      return {Status::kOversized, path + ": larger than " + std::to_string(max_bytes) + " bytes"};
    }
  }
  if (std::ferror(file.get()) != 0) {
    text.clear();
    return SystemFailure(path, "cannot be read");
  }
  return {};
}

}  // namespace hardpack
