// SPDX-License-Identifier: Apache-2.0
#include "port_linux/service_watchdog.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string>

namespace hardpack {
namespace {

// Longest plausible period of a watchdog: a day.
constexpr uint64_t kMaxPeriod_us = uint64_t{24} * 3600 * 1'000'000;

bool ReadNumber(const char* text, uint64_t& number) {
  const char* end = text + std::strlen(text);
  const auto [rest, error] = std::from_chars(text, end, number);
  return error == std::errc() && rest == end;
}

OpenOutcome Failure(Status status, const std::string& message) {
  return {status, message, {}};
}

}  // namespace

OpenOutcome ServiceWatchdog::Connect(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() < 2 || (path[0] != '/' && path[0] != '@')) {
    return Failure(Status::kInvalidArgument,
                   "NOTIFY_SOCKET=" + path + ": neither a path nor @name");
  }
  if (path.size() >= sizeof(address.sun_path)) {
    return Failure(Status::kInvalidArgument, "NOTIFY_SOCKET=" + path + ": too long");
  }
  std::memcpy(address.sun_path, path.data(), path.size());
  if (path[0] == '@') address.sun_path[0] = '\0';  // the abstract name space
  const size_t length = offsetof(sockaddr_un, sun_path) + path.size();
  FileDescriptor socket(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket.valid() || connect(socket.get(), reinterpret_cast<const sockaddr*>(&address),
                                 static_cast<socklen_t>(length)) != 0) {
    const int code = errno;
    return Failure(Status::kSystemError,
                   "NOTIFY_SOCKET=" + path + ": " + std::string(std::strerror(code)));
  }
  socket_ = std::move(socket);
  return {};
}

OpenOutcome ServiceWatchdog::Open() {
  const char* path = std::getenv("NOTIFY_SOCKET");
  if (path == nullptr) return {Status::kOk, "watchdog: no service manager", {}};
  OpenOutcome outcome = Connect(path);
  if (!outcome.ok()) return outcome;

  outcome.message = "watchdog: not enabled by the service manager";
  const char* period = std::getenv("WATCHDOG_USEC");
  if (period == nullptr) return outcome;
  uint64_t pid = 0;
  const char* watched = std::getenv("WATCHDOG_PID");
  if (watched != nullptr) {
    if (!ReadNumber(watched, pid)) {
      return Failure(Status::kInvalidArgument, std::string("WATCHDOG_PID=") + watched);
    }
    if (pid != static_cast<uint64_t>(getpid())) return outcome;  // meant for another process
  }
  uint64_t period_us = 0;
  if (!ReadNumber(period, period_us) || period_us == 0 || period_us > kMaxPeriod_us) {
    return Failure(Status::kInvalidArgument, std::string("WATCHDOG_USEC=") + period);
  }
  period_ns_ = period_us * 1000;
  outcome.message =
      "watchdog: the service manager's time-out is " + std::to_string(period_us / 1000) + " ms";
  return outcome;
}

bool ServiceWatchdog::Tell(std::string_view text) {
  return socket_.valid() && send(socket_.get(), text.data(), text.size(),
                                 MSG_DONTWAIT | MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
}

void ServiceWatchdog::Ready() {
  ready_owed_ = socket_.valid() && !Tell("READY=1");
}

void ServiceWatchdog::Feed(uint64_t now_ns) {
  if (ready_owed_) ready_owed_ = !Tell("READY=1");
  if (period_ns_ == 0 || now_ns < next_ns_ || !Tell("WATCHDOG=1")) return;
  ++fed_;
  next_ns_ = now_ns + period_ns_ / 2;
}

void ServiceWatchdog::Stopping() {
  Tell("STOPPING=1");
}

}  // namespace hardpack
