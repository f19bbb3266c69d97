// SPDX-License-Identifier: Apache-2.0
#include "hal/sevcon/sdo_client.h"

namespace hardpack::sevcon {

void SdoClient::Ask(const SdoQuestion& question, int32_t retries) {
  asked_ = question;
  sent_ = question;
  retries_ = retries;
  retries_left_ = retries;
  asks_reason_ = false;
  value_ = 0;
  abort_code_ = 0;
  abort_reason_ = 0;
  outcome_ = SdoOutcome::kNone;
  state_ = State::kToSend;
}

void SdoClient::Cancel() {
  state_ = State::kIdle;
  outcome_ = SdoOutcome::kNone;
}

void SdoClient::End(SdoOutcome outcome) {
  outcome_ = outcome;
  state_ = State::kEnded;
}

void SdoClient::AskReason() {
  sent_ = SdoQuestion{kReasonIndex, 0, 2, false, 0};
  retries_left_ = retries_;
  asks_reason_ = true;
  state_ = State::kToSend;
}

bool SdoClient::TakeAnswer(const CanFrame& frame) {
  const SdoAnswer answer = DecodeSdoAnswer(frame);
  const SdoAnswerKind wanted = sent_.write ? SdoAnswerKind::kWritten : SdoAnswerKind::kValue;
  const bool fits =
      answer.kind == SdoAnswerKind::kAbort ||
      (answer.kind == wanted && (sent_.write || answer.size == 0 || answer.size == sent_.size));
  if (state_ != State::kWaiting || !fits || answer.index != sent_.index ||
      answer.subindex != sent_.subindex) {
    ++ignored_;
    return false;
  }
  if (asks_reason_) {
    if (answer.kind == SdoAnswerKind::kValue) abort_reason_ = answer.value & 0xffffu;
    End(SdoOutcome::kAborted);
  } else if (answer.kind == SdoAnswerKind::kAbort) {
    ++aborts_;
    abort_code_ = answer.value;
    if (abort_code_ == kAbortGeneral && sent_.index != kReasonIndex) {
      AskReason();
    } else {
      End(SdoOutcome::kAborted);
    }
  } else {
    // Where the size was not told, what lies beyond the object's is none of it.
    value_ = answer.value & BitsOf(sent_.size);
    End(SdoOutcome::kDone);
  }
  return true;
}

bool SdoClient::Send(uint64_t now_ns, int32_t node, uint64_t timeout_ns, CanFrame& frame) {
  if (state_ == State::kWaiting && now_ns - sent_ns_ >= timeout_ns) {
    ++timeouts_;
    if (retries_left_ > 0) {
      --retries_left_;
      state_ = State::kToSend;
    } else {
      End(asks_reason_ ? SdoOutcome::kAborted : SdoOutcome::kTimedOut);
    }
  }
  if (state_ != State::kToSend) return false;
  frame = SdoQuestionFrame(node, sent_);
  sent_ns_ = now_ns;
  state_ = State::kWaiting;
  return true;
}

SdoOutcome SdoClient::TakeOutcome() {
  if (state_ != State::kEnded) return SdoOutcome::kNone;
  state_ = State::kIdle;
  return outcome_;
}

}  // namespace hardpack::sevcon
