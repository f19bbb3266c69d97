// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "core/base/status.h"
#include "hal/onboard/control/messages.h"
#include "hal/onboard/control/status_report.h"

namespace hardpack {

// Who asked.
struct ControlClient {
  int32_t place = -1;   // of the link's clients
  uint64_t number = 0;  // of its connection, from 1
};

struct ControlMessage {
  ControlClient client;
  uint32_t user = 0;               // as the link knows who asked; 0 where it does not
  control::Header header;          // a command's or a question's
  std::span<const uint8_t> bytes;  // the whole message; valid until the next Receive
};

// Where operators' programs connect: messages of hal/onboard/control, whole and in order. It looks
// at headers only: what a command does is the tick's business, what is answered the run loop's. No
// call blocks or allocates. test/hal/conformance holds every implementation to this page.
class OperatorLink {
 public:
  // At most one message of each client is taken, the clients in turn, until one is found that is to
  // be given. False: there is none, and `message` is untouched. Commands of those who may not
  // command and messages that are none are answered here (kDone) and counted.
  [[nodiscard]] virtual bool Receive(ControlMessage& message) = 0;

  // Sends an answer to the one connection that asked; once that has gone, to nobody.
  virtual void Answer(const ControlClient& client, std::span<const uint8_t> bytes) = 0;

  virtual const control::ControlCounters& counters() const = 0;

 protected:
  ~OperatorLink() = default;
};

}  // namespace hardpack
