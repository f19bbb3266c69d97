// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "hal/can_frame.h"
#include "hal/sevcon/canopen.h"

namespace hardpack::sevcon {

enum class SdoOutcome : uint8_t {
  kNone = 0,  // not yet, or no request
  kDone,
  kAborted,
  kTimedOut,  // including retries
};

// Service data of one node: one request at a time, each with a time-out and a number of retries. A
// request refused with the generic code 08000000h is followed by one to 5310h, where a Gen4 gives
// the reason. Unexpected answers, and those whose size is not the object's, are counted and change
// nothing.
class SdoClient {
 public:
  // A Gen4's reason for its last generic abort.
  static constexpr uint16_t kReasonIndex = 0x5310;

  // Begins a request; drops any request in progress. Sent by the next Send.
  void Ask(const SdoQuestion& question, int32_t retries);
  void Cancel();
  bool busy() const { return state_ != State::kIdle; }

  // An answer from the node. False: unexpected. Precondition: size 8.
  bool TakeAnswer(const CanFrame& frame);

  // True, and the frame, if one is to be sent now: the request, or a retry after timeout_ns.
  bool Send(uint64_t now_ns, int32_t node, uint64_t timeout_ns, CanFrame& frame);

  // The result of the request: once; then the client is free for the next.
  SdoOutcome TakeOutcome();
  // The request whose outcome was taken last.
  const SdoQuestion& question() const { return asked_; }
  uint32_t value() const { return value_; }  // kDone, of a read object
  uint32_t abort_code() const { return abort_code_; }
  uint16_t abort_reason() const { return abort_reason_; }  // 5310h; 0: not given

  uint32_t timeouts() const { return timeouts_; }  // answers that did not arrive in time
  uint32_t aborts() const { return aborts_; }
  uint32_t ignored() const { return ignored_; }  // unexpected answers

 private:
  enum class State : uint8_t { kIdle, kToSend, kWaiting, kEnded };

  void AskReason();
  void End(SdoOutcome outcome);

  State state_ = State::kIdle;
  SdoOutcome outcome_ = SdoOutcome::kNone;
  bool asks_reason_ = false;
  SdoQuestion asked_;
  SdoQuestion sent_;  // it, or the one to 5310h
  int32_t retries_ = 0;
  int32_t retries_left_ = 0;
  uint64_t sent_ns_ = 0;
  uint32_t value_ = 0;
  uint32_t abort_code_ = 0;
  uint16_t abort_reason_ = 0;
  uint32_t timeouts_ = 0;
  uint32_t aborts_ = 0;
  uint32_t ignored_ = 0;
};
static_assert(std::is_trivially_copyable_v<SdoClient>);

}  // namespace hardpack::sevcon
