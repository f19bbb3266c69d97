// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>

#include "hal/onboard/control/messages.h"
#include "hal/onboard/control/status_report.h"
#include "port_linux/file_descriptor.h"
#include "port_linux/files/read_outcome.h"

// The operator's side of the control socket (docs/control.md): sends requests and waits for the
// answers.

namespace hardpack::ctl {

class Connection {
 public:
  // kSystemError, kNotPermitted or kTimedOut, with a line that says what to do.
  ReadOutcome Open(const std::string& path, std::chrono::milliseconds timeout);

  // Each sends one message and waits for its answer; late answers to earlier messages are skipped.
  // kTimedOut, kSystemError: the connection has ended; kAborted: interrupted by a signal; otherwise
  // the status of Decode for the answer. After a failure the connection is unusable.
  ReadOutcome Ask(control::OperatorCommand& command, control::Done& answer);
  ReadOutcome AskStatus(control::StatusReport& report);
  // The whole configuration.
  ReadOutcome AskParameters(std::string& toml);

 private:
  ReadOutcome Exchange(std::span<const uint8_t> message, uint32_t sequence,
                       std::span<const uint8_t>& answer);
  ReadOutcome AskPart(uint32_t offset, control::ParametersPart& part);
  ReadOutcome Refusal(std::span<const uint8_t> answer, Status status) const;

  std::string path_;
  std::chrono::milliseconds timeout_{};
  FileDescriptor socket_;
  uint32_t sequence_ = 0;
  std::array<uint8_t, control::kMaxMessageBytes> sent_{};
  std::array<uint8_t, control::kMaxMessageBytes> received_{};
};

}  // namespace hardpack::ctl
