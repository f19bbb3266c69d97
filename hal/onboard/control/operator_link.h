// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "core/base/status.h"
#include "hal/onboard/control/messages.h"
#include "hal/onboard/control/status_report.h"

namespace hardpack {

// The sender of a message.
struct ControlClient {
  int32_t place = -1;   // among the link's clients
  uint64_t number = 0;  // of its connection, from 1
};

struct ControlMessage {
  ControlClient client;
  uint32_t user = 0;               // the sender, if the link knows it; otherwise 0
  control::Header header;          // of a command or a question
  std::span<const uint8_t> bytes;  // the whole message; valid until the next Receive
};

// The connection to operators' programs: messages of hal/onboard/control, complete and in order. It
// reads headers only: commands are executed by the tick and answered by the run loop. No call
// blocks or allocates. test/hal/conformance tests every implementation against this page.
class OperatorLink {
 public:
  // Reads at most one message from each client, in turn, until one is found to return. False: there
  // is none, and `message` is unchanged. Commands from those who may not command and malformed
  // messages are answered here (kDone) and counted.
  [[nodiscard]] virtual bool Receive(ControlMessage& message) = 0;

  // Sends an answer to the connection that asked; if that is gone, to nobody.
  virtual void Answer(const ControlClient& client, std::span<const uint8_t> bytes) = 0;

  virtual const control::ControlCounters& counters() const = 0;

 protected:
  ~OperatorLink() = default;
};

}  // namespace hardpack
