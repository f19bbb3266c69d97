// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/result.h"
#include "core/base/status.h"

// One device's clock in terms of ours (docs/algorithm.md section 8). A datagram that the device
// stamped d is received by us at h = d + offset + delay with delay >= 0, so the smallest h - d of
// the last while is the best estimate of the offset: a minimum filter. It follows the drift of the
// two clocks by forgetting what is older than its window, and tells a jump of the device's clock (a
// reboot, a step by its time server) from late datagrams. It does not estimate the smallest delay
// itself, which stays in the offset. Integer nanoseconds; no clock is read here.

namespace hardpack {

struct TimebaseCounters {
  uint32_t observations = 0;  // that entered the filter
  uint32_t jumps = 0;         // of the device's clock, either way
  uint32_t late = 0;          // datagrams delayed by more than the jump's threshold, no jump yet
  uint32_t refused = 0;       // our clock went backwards, or the stamps do not fit the arithmetic
};

class Timebase {
 public:
  // A minimum is remembered for one to two windows.
  static constexpr int64_t kWindow_ns = 2'000'000'000;
  // An offset that falls by more than this between two observations, or that stays above the
  // minimum by more than this for kConfirm_ns of consecutive observations (at least
  // kConfirmObservations of them), is a jump.
  static constexpr int64_t kJump_ns = 50'000'000;
  static constexpr int64_t kConfirm_ns = 250'000'000;
  static constexpr int32_t kConfirmObservations = 8;

  // Forgets everything, the counters too.
  void Reset();

  // A datagram stamped device_ns by the device came at host_ns of our monotonic clock.
  // kOk; kClockJumped: the device's clock jumped, and the offset is that of this observation (or of
  // those that confirmed it) from here on; kInvalidArgument: host_ns is before the last
  // observation's, or a stamp is 2^62 or more: nothing changes but the counter. Cost: constant.
  Status Observe(uint64_t device_ns, uint64_t host_ns);

  // Our time of a device's stamp. kNotStarted: nothing has been observed; kInvalidArgument: the
  // stamp is 2^62 or more, or its time would be negative. Cost: constant.
  Result<uint64_t> ToHost(uint64_t device_ns) const;

  // Smallest host minus device of the window. Precondition: started().
  int64_t offset_ns() const;
  bool started() const { return started_; }
  const TimebaseCounters& counters() const { return counters_; }

 private:
  bool started_ = false;
  TimebaseCounters counters_;
};
static_assert(std::is_trivially_copyable_v<Timebase>);

}  // namespace hardpack
