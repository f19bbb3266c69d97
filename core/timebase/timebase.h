// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <type_traits>

#include "config/onboard_parameters.h"
#include "core/base/result.h"
#include "core/base/status.h"

// One device's clock in terms of ours (docs/algorithm.md section 8). A datagram that the device
// stamped d is received by us at h = d + offset + delay with delay >= 0, so the smallest h - d of
// the last while is the best estimate of the offset: a minimum filter. It follows the drift of the
// two clocks by forgetting what is older than its window, and tells a jump of the device's clock (a
// reboot, a step by its time server) from late datagrams. It does not estimate the smallest delay
// itself, which stays in the offset. Integer nanoseconds; no clock is read here.
//
// A delay that grows looks like a device's clock that is slow. So the offset rises no faster than a
// clock can drift: with the differences D_k = h_k - d_k of all datagrams since it was fixed, W the
// minimum of the window, rho = ClockParams::max_drift_ppm and S = max_drift_s,
//   offset(h) = min(W(h), floor(h) + S),   floor(h) = min over k of D_k + rho (h - h_k)
// A datagram that is later than that gets the time at which it was sent, as near as that is known:
// it is old, and never taken for new by more than S + rho t, t since the least delayed one. Drift
// itself may go on for ever: each datagram that comes with no more delay than before lowers the
// floor to what it shows. S leaves room for minima that differ from window to window. A delay that
// grows by less than rho cannot be told from drift.
//
// How far ToHost is off the moment of a stamp of now, after the first window, if every window
// brings a datagram that was delayed by no more than delay_short, none is delayed by less than
// delay_min, the clocks drift apart by rho and datagrams that are not late come at least every G:
//   delay_min - 2 rho (kWindow_ns + G) <= error <= delay_short + 2 rho (kWindow_ns + G)
// With 100 ppm, 0.1 ms for both delays and small G: -0.3 .. +0.5 ms.

namespace hardpack {

struct TimebaseCounters {
  uint32_t observations = 0;  // that were not refused
  uint32_t jumps = 0;         // of the device's clock, either way
  uint32_t late = 0;          // observations later by more than the jump's threshold, no jump (yet)
  uint32_t beyond_drift = 0;  // observations that no drift explains: they are late, not new
  uint32_t refused = 0;       // our clock went backwards, or the stamps do not fit the arithmetic
};

class Timebase {
 public:
  // A minimum is remembered for one to two windows with datagrams; a silence between them, or one
  // of late datagrams only, does not count.
  static constexpr int64_t kWindow_ns = 2'000'000'000;
  // What an observation may lie off the offset and be no sign of a jump. Smaller steps of the
  // device's clock are not told: one forward is followed at once, one back as drift is.
  static constexpr int64_t kJump_ns = 50'000'000;
  // A run of late observations is steady while none is earlier than its first by more than this, or
  // later by more than kJump_ns. A jump makes a steady run. A backlog does not: each of its
  // datagrams was delayed for less long than the one before. A delay beyond kJump_ns that stays the
  // same for kConfirm_ns does too: it cannot be told from a jump, nor its end from another.
  static constexpr int64_t kSteady_ns = 5'000'000;
  // A steady run is a jump after so many observations if the device's stamps went back as it began,
  // by more than kSteady_ns, which no delay does; else, where that is permitted, when it has lasted
  // for so long besides.
  static constexpr int32_t kConfirmObservations = 8;
  static constexpr int64_t kConfirm_ns = 250'000'000;

  // kParameterOutOfRange: nothing changes. Else forgets everything.
  Status Configure(const ClockParams& params);

  // Forgets everything but the parameters, the counters too.
  void Reset();

  // A datagram stamped device_ns by the device came at host_ns of our monotonic clock. Of several
  // stamps in it the newest, which was delayed the least: a lidar's first column waits for the rest
  // of its packet, 1.5 ms at 640 packets a second. What an invalid column says is no stamp.
  // kOk; kClockJumped: the device's clock jumped, forward (told by the first observation, since
  // nothing comes before it was sent) or back (told once it is confirmed), and the offset is that
  // of this observation, or the smallest of those that confirmed it, from here on;
  // kInvalidArgument: host_ns is before the last observation's, or a stamp is 2^62 or more: nothing
  // changes but the counter. Each jump is told once. A first observation that was itself late by
  // more than kJump_ns is told as a jump forward when one comes that was not. `may_fix_anew`: a
  // delay that stays the same may be taken for a jump of the clock in a silence. False while
  // anybody relies on the times: such data are late, whatever the reason. Cost: constant.
  Status Observe(uint64_t device_ns, uint64_t host_ns, bool may_fix_anew = true);

  // True while the newest observations look like a jump back that is not confirmed yet: the stamps
  // went back. The times of their stamps are not to be relied upon.
  bool suspect() const { return run_.observations > 0 && run_.stamps_went_back; }

  // Our time of a device's stamp. kNotStarted: nothing has been observed; kInvalidArgument: the
  // stamp is 2^62 or more, or its time would be negative. Cost: constant.
  Result<uint64_t> ToHost(uint64_t device_ns) const;

  // Smallest host minus device of the window. Precondition: started().
  int64_t offset_ns() const;
  bool started() const { return started_; }
  const TimebaseCounters& counters() const { return counters_; }

 private:
  // Consecutive observations that are later than the offset by more than kJump_ns.
  struct LateRun {
    int32_t observations = 0;  // counted up to kConfirmObservations
    bool stamps_went_back = false;
    uint64_t begin_ns = 0;  // our time of the first
    int64_t first_ns = 0;   // host minus device of it, and the smallest of all
    int64_t smallest_ns = 0;
  };
  static constexpr int64_t kNone_ns = std::numeric_limits<int64_t>::max();

  int64_t Floor_ns(uint64_t host_ns) const;
  void StartFrom(int64_t difference_ns, uint64_t device_ns, uint64_t host_ns);
  void Enter(int64_t difference_ns, uint64_t device_ns, uint64_t host_ns);
  Status TakeLate(int64_t difference_ns, uint64_t device_ns, uint64_t host_ns, bool may_fix_anew);

  int64_t max_drift_rate_ = 524;  // of ClockParams, in units of 2^-20
  int64_t max_drift_ns_ = 20'000'000;
  bool started_ = false;
  uint64_t last_host_ns_ = 0;
  uint64_t newest_device_ns_ = 0;  // of the observations that were not late
  uint64_t window_begin_ns_ = 0;   // our time
  int64_t window_smallest_ns_ = kNone_ns;
  int64_t previous_smallest_ns_ = kNone_ns;  // of the window before
  int64_t offset_ns_ = 0;
  int64_t floor_ns_ = 0;      // the floor ...
  uint64_t floor_at_ns_ = 0;  // ... at this time of ours: it rises from there
  LateRun run_;
  TimebaseCounters counters_;
};
static_assert(std::is_trivially_copyable_v<Timebase>);

}  // namespace hardpack
