// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/status.h"
#include "hal/can_bus.h"
#include "hal/can_frame.h"

namespace hardpack {

// The frames on their way to a bus that cannot recall what it was given: those waiting (until fewer
// than kMaxUnconfirmed are outstanding) and those handed over whose echo has not arrived. Pure
// bookkeeping, in order, without a clock.
class CanSendQueue {
 public:
  // This long after its deadline, a frame that was handed over but not seen on the bus would do
  // harm if it were sent. Longer than the tick and the scheduler take to see an echo.
  static constexpr uint64_t kStaleAfter_ns = 100'000'000;

  int waiting() const { return waiting_count_; }
  int unconfirmed() const { return unconfirmed_count_; }

  // kCapacityExceeded: kMaxWaiting frames are waiting.
  Status Add(const CanFrame& frame, uint64_t deadline_ns) {
    if (waiting_count_ == CanBus::kMaxWaiting) return Status::kCapacityExceeded;
    waiting_[static_cast<size_t>(waiting_count_++)] = {Normal(frame), deadline_ns};
    return Status::kOk;
  }

  // Drops waiting frames past their deadline; returns their number.
  int DropExpired(uint64_t now_ns) {
    Pending* const end = waiting_.data() + waiting_count_;
    Pending* const kept = std::remove_if(waiting_.data(), end, [now_ns](const Pending& pending) {
      return pending.deadline_ns <= now_ns;
    });
    waiting_count_ -= static_cast<int>(end - kept);
    return static_cast<int>(end - kept);
  }

  bool CanHandOver() const {
    return waiting_count_ > 0 && unconfirmed_count_ < CanBus::kMaxUnconfirmed;
  }
  // Precondition of these: a frame is waiting.
  const CanFrame& next() const { return waiting_[0].frame; }
  void HandedOver() {
    unconfirmed_[static_cast<size_t>(unconfirmed_count_++)] = waiting_[0];
    DropNext();
  }
  void DropNext() { Erase(waiting_.data(), waiting_count_, 0); }

  // One of our frames was seen on the bus: removes the oldest matching outstanding one. False:
  // there is none.
  bool Confirm(const CanFrame& frame) {
    const Pending* const end = unconfirmed_.data() + unconfirmed_count_;
    const Pending* const found =
        std::find_if(unconfirmed_.data(), const_cast<Pending*>(end),
                     [&frame](const Pending& pending) { return pending.frame == frame; });
    if (found == end) return false;
    Erase(unconfirmed_.data(), unconfirmed_count_, static_cast<int>(found - unconfirmed_.data()));
    return true;
  }

  bool IsStale(uint64_t now_ns) const {
    return std::any_of(unconfirmed_.data(), unconfirmed_.data() + unconfirmed_count_,
                       [now_ns](const Pending& pending) {
                         return now_ns > pending.deadline_ns &&
                                now_ns - pending.deadline_ns > kStaleAfter_ns;
                       });
  }

  // These return the number of frames.
  int DropWaiting() {
    const int dropped = waiting_count_;
    waiting_count_ = 0;
    return dropped;
  }
  int ForgetUnconfirmed() {
    const int forgotten = unconfirmed_count_;
    unconfirmed_count_ = 0;
    return forgotten;
  }

 private:
  struct Pending {
    CanFrame frame;
    uint64_t deadline_ns = 0;
  };

  // As it appears on the bus, for comparison with its echo.
  static CanFrame Normal(const CanFrame& frame) {
    CanFrame normal = frame;
    const int used = frame.remote ? 0 : frame.size;
    std::fill(normal.data + used, normal.data + kMaxCanData_bytes, uint8_t{0});
    return normal;
  }

  static void Erase(Pending* pending, int& count, int index) {
    std::copy(pending + index + 1, pending + count, pending + index);
    --count;
  }

  int waiting_count_ = 0;
  int unconfirmed_count_ = 0;
  std::array<Pending, CanBus::kMaxWaiting> waiting_;          // [waiting_count_], oldest first
  std::array<Pending, CanBus::kMaxUnconfirmed> unconfirmed_;  // [unconfirmed_count_], likewise
};

}  // namespace hardpack
