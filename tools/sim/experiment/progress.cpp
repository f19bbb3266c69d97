// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/experiment/progress.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace hardpack::experiment {
namespace {

uint64_t Now_ns() {
  return static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                   std::chrono::steady_clock::now().time_since_epoch())
                                   .count());
}

int Columns() {
  winsize size = {};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string Clock(double seconds) {
  const auto whole = static_cast<int64_t>(seconds);
  char text[32];
  if (whole >= 3600) {
    std::snprintf(text, sizeof(text), "%d:%02d:%02d", static_cast<int>(whole / 3600),
                  static_cast<int>(whole / 60 % 60), static_cast<int>(whole % 60));
  } else {
    std::snprintf(text, sizeof(text), "%d:%02d", static_cast<int>(whole / 60),
                  static_cast<int>(whole % 60));
  }
  return text;
}

}  // namespace

std::string ProgressLine(const std::string& name, int64_t done, int64_t all, int64_t failed,
                         double elapsed_s, int columns) {
  std::string after = "]  " + std::to_string(done) + "/" + std::to_string(all);
  if (failed > 0) after += "  " + std::to_string(failed) + " failed";
  if (done > 0 && done < all) {
    after += "  " + Clock(elapsed_s * static_cast<double>(all - done) / static_cast<double>(done)) +
             " left";
  }
  const int bar = std::clamp(columns - 4 - static_cast<int>(name.size() + after.size()), 0, 60);
  const auto full = all > 0 ? static_cast<size_t>(done * bar / all) : 0;
  std::string line = name + "  [" + std::string(full, '=');
  line.resize(name.size() + 3 + static_cast<size_t>(bar), ' ');
  line += after;
  return line.substr(0, static_cast<size_t>(std::max(columns - 1, 0)));
}

Progress::Progress(std::string name, int64_t all)
    : name_(std::move(name)),
      all_(all),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_ns_(Now_ns()) {
  Show(0, 0);
}

Progress::~Progress() {
  if (terminal_) std::fputs("\r\033[K", stderr);
}

void Progress::Show(int64_t done, int64_t failed) {
  if (!terminal_) return;
  const double elapsed_s = static_cast<double>(Now_ns() - start_ns_) / 1e9;
  const std::string line = ProgressLine(name_, done, all_, failed, elapsed_s, Columns());
  std::fprintf(stderr, "\r\033[K%s", line.c_str());
}

}  // namespace hardpack::experiment
