// SPDX-License-Identifier: Apache-2.0
#include "port_linux/hardpackctl/connection.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "port_linux/hardpackctl/code_names.h"

namespace hardpack::ctl {
namespace {

using std::chrono::duration_cast;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

ReadOutcome ConnectFailure(const std::string& path, int code) {
  const std::string begin = "cannot connect to " + path + ": ";
  switch (code) {
    case ENOENT:
      return {Status::kSystemError, begin + "no such socket: is hardpackd running?"};
    case ECONNREFUSED:
      return {Status::kSystemError, begin + "hardpackd is not running"};
    case EACCES:
      return {Status::kNotPermitted,
              begin + "not permitted: you are neither its owner nor in its group"};
    case EAGAIN:
      return {Status::kTimedOut, begin + "hardpackd accepts no connections"};
    case EPROTOTYPE:
      return {Status::kSystemError, begin + "not a control socket"};
    default:
      return {Status::kSystemError, begin + std::strerror(code)};
  }
}

timeval ToTimeval(milliseconds time) {
  return {time.count() / 1000, static_cast<suseconds_t>(time.count() % 1000) * 1000};
}

std::span<const uint8_t> First(std::span<const uint8_t> buffer, int size_bytes) {
  return buffer.first(static_cast<size_t>(size_bytes));
}

}  // namespace

ReadOutcome Connection::Open(const std::string& path, milliseconds timeout) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof(address.sun_path)) {
    return {Status::kInvalidArgument, "--socket: " + path + " is not a valid socket path"};
  }
  std::copy(path.begin(), path.end(), address.sun_path);
  path_ = path;
  timeout_ = timeout;
  socket_.Reset(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
  const timeval limit = ToTimeval(timeout);
  if (!socket_.valid() ||
      setsockopt(socket_.get(), SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof(limit)) != 0 ||
      connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    return ConnectFailure(path, errno);
  }
  return {};
}

ReadOutcome Connection::Exchange(std::span<const uint8_t> message, uint32_t sequence,
                                 std::span<const uint8_t>& answer) {
  const auto until = steady_clock::now() + timeout_;
  ReadOutcome ended = {
      Status::kSystemError,
      path_ + ": the connection was closed: hardpackd has ended, or serves no more clients"};
  ReadOutcome late = {Status::kTimedOut, path_ + ": no answer in time"};
  ReadOutcome interrupted = {Status::kAborted, "interrupted"};
  if (send(socket_.get(), message.data(), message.size(), MSG_NOSIGNAL) < 0) {
    return errno == EINTR ? interrupted : errno == EAGAIN ? late : ended;
  }
  for (;;) {
    const auto left = duration_cast<milliseconds>(until - steady_clock::now());
    pollfd polled = {socket_.get(), POLLIN, 0};
    const int ready = poll(&polled, 1, std::max(0, static_cast<int>(left.count())));
    if (ready < 0 && errno == EINTR) return interrupted;
    if (ready == 0) return late;
    const ssize_t size = recv(socket_.get(), received_.data(), received_.size(), MSG_DONTWAIT);
    if (size <= 0) return ended;
    answer = std::span(received_).first(static_cast<size_t>(size));
    control::Header header;
    const Status status = ReadHeader(answer, header);
    if (!IsUsable(status)) {
      return {status, path_ + ": malformed answer (" + StatusName(status) + ")"};
    }
    if (header.sequence == sequence) return {};
  }
}

// For an answer of another kind than requested: it may give the reason.
ReadOutcome Connection::Refusal(std::span<const uint8_t> answer, Status status) const {
  control::Done done;
  if (!IsUsable(Decode(answer, done))) {
    return {status, path_ + ": malformed answer (" + StatusName(status) + "): " + WordsOf(status)};
  }
  return {IsUsable(done.status) ? status : done.status,
          path_ + ": refused: " + StatusName(done.status) + ": " + WordsOf(done.status)};
}

ReadOutcome Connection::Ask(control::OperatorCommand& command, control::Done& answer) {
  command.sequence = ++sequence_;
  int size_bytes = 0;
  const Status encoded = Encode(command, sent_, size_bytes);
  if (!IsUsable(encoded)) return {encoded, std::string("the command: ") + WordsOf(encoded)};
  std::span<const uint8_t> bytes;
  ReadOutcome outcome = Exchange(First(sent_, size_bytes), command.sequence, bytes);
  if (!outcome.ok()) return outcome;
  const Status status = Decode(bytes, answer);
  return IsUsable(status) ? ReadOutcome{} : Refusal(bytes, status);
}

ReadOutcome Connection::AskStatus(control::StatusReport& report) {
  const control::Question question = {control::Kind::kGetStatus, ++sequence_, 0};
  int size_bytes = 0;
  const Status encoded = Encode(question, sent_, size_bytes);
  if (!IsUsable(encoded)) return {encoded, StatusName(encoded)};
  std::span<const uint8_t> bytes;
  ReadOutcome outcome = Exchange(First(sent_, size_bytes), question.sequence, bytes);
  if (!outcome.ok()) return outcome;
  const Status status = Decode(bytes, report);
  return IsUsable(status) ? ReadOutcome{} : Refusal(bytes, status);
}

ReadOutcome Connection::AskPart(uint32_t offset, control::ParametersPart& part) {
  const control::Question question = {control::Kind::kGetParameters, ++sequence_, offset};
  int size_bytes = 0;
  const Status encoded = Encode(question, sent_, size_bytes);
  if (!IsUsable(encoded)) return {encoded, StatusName(encoded)};
  std::span<const uint8_t> bytes;
  ReadOutcome outcome = Exchange(First(sent_, size_bytes), question.sequence, bytes);
  if (!outcome.ok()) return outcome;
  const Status status = Decode(bytes, part);
  if (!IsUsable(status)) return Refusal(bytes, status);
  if (part.offset == offset) return {};
  return {Status::kWrongPacketType, path_ + ": not the requested part"};
}

ReadOutcome Connection::AskParameters(std::string& toml) {
  toml.clear();
  for (;;) {
    control::ParametersPart part;
    ReadOutcome outcome = AskPart(static_cast<uint32_t>(toml.size()), part);
    if (!outcome.ok()) return outcome;
    toml.append(part.bytes.begin(), part.bytes.end());
    // A part is empty only at the end.
    if (toml.size() >= part.whole_bytes) return {};
  }
}

}  // namespace hardpack::ctl
