// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <type_traits>

#include "config/onboard_parameters.h"
#include "core/base/result.h"
#include "core/base/status.h"

// One device's clock in terms of ours (docs/algorithm.md section 8). A datagram stamped d by the
// device is received by us at h = d + offset + delay with delay >= 0, so the smallest recent h - d
// is the best estimate of the offset: a minimum filter. It follows the drift of the two clocks by
// forgetting values older than its window, and distinguishes a jump of the device's clock (a
// reboot, a step by its time server) from late datagrams. It does not estimate the smallest delay
// itself, which stays in the offset. Integer nanoseconds; no clock is read here.
//
// A growing delay looks like a slow device clock. So the offset rises no faster than a clock can
// drift: with the differences D_k = h_k - d_k of all datagrams since it was fixed, W the minimum of
// the window, rho = ClockParams::max_drift_ppm and S = max_drift_s,
//   offset(h) = min(W(h), floor(h) + S),   floor(h) = min over k of D_k + rho (h - h_k)
// A datagram that is later than that gets the time at which it was sent, as well as that is known:
// it counts as old, and is never taken for newer than it is by more than S + rho t, t since the
// least delayed one. Drift itself may continue forever: each datagram that arrives with no more
// delay than before lowers the floor to its own value. S leaves room for minima that differ between
// windows. A delay that grows by less than rho cannot be distinguished from drift.
//
// Error of ToHost for a stamp of the present moment, after the first window, if every window has a
// datagram delayed by no more than delay_short, none is delayed by less than delay_min, the clocks
// drift apart by rho and datagrams that are not late arrive at least every G:
//   delay_min - 2 rho (kWindow_ns + G) <= error <= delay_short + 2 rho (kWindow_ns + G)
// With 100 ppm, 0.1 ms for both delays and small G: -0.3 .. +0.5 ms.

namespace hardpack {

struct TimebaseCounters {
  uint32_t observations = 0;  // not refused
  uint32_t jumps = 0;         // of the device's clock, either way
  uint32_t late = 0;          // observations late by more than the jump threshold, not (yet) a jump
  uint32_t beyond_drift = 0;  // observations that drift cannot explain: they are late, not new
  uint32_t refused = 0;       // our clock went backwards, or the stamps do not fit the arithmetic
};

class Timebase {
 public:
  // A minimum is remembered for one to two windows with datagrams; silence between them, or a
  // period of late datagrams only, does not count.
  static constexpr int64_t kWindow_ns = 2'000'000'000;
  // How far an observation may be off the offset without indicating a jump. Smaller steps of the
  // device's clock are not detected: a forward step is followed at once, a backward step like
  // drift.
  static constexpr int64_t kJump_ns = 50'000'000;
  // A run of late observations is steady if none is earlier than its first by more than this, or
  // later by more than kJump_ns. A jump makes a steady run. A backlog does not: each of its
  // datagrams was delayed less than the previous one. A constant delay beyond kJump_ns that lasts
  // for kConfirm_ns does too: it cannot be distinguished from a jump, nor its end from another
  // jump.
  static constexpr int64_t kSteady_ns = 5'000'000;
  // A steady run is a jump after this many observations if the device's stamps went back by more
  // than kSteady_ns as it began, which no delay causes; otherwise, if permitted, once it has also
  // lasted this long.
  static constexpr int32_t kConfirmObservations = 8;
  static constexpr int64_t kConfirm_ns = 250'000'000;

  // kParameterOutOfRange: nothing changes. Otherwise clears everything.
  Status Configure(const ClockParams& params);

  // Clears everything except the parameters, including the counters.
  void Reset();

  // A datagram stamped device_ns by the device arrived at host_ns of our monotonic clock. If it has
  // several stamps, pass the newest, which was delayed the least: a lidar's first column waits for
  // the rest of its packet, 1.5 ms at 640 packets per second. The stamp of an invalid column does
  // not count. kOk; kClockJumped: the device's clock jumped, forward (recognised by the first
  // observation, because nothing arrives before it was sent) or back (reported once confirmed), and
  // from now on the offset is that of this observation, or the smallest of those that confirmed it;
  // kInvalidArgument: host_ns is before the last observation's, or a stamp is 2^62 or more: only
  // the counter changes. Each jump is reported once. If the first observation was itself late by
  // more than kJump_ns, the first one that is not is reported as a jump forward. `may_fix_anew`: a
  // constant delay may be taken for a clock jump during a silence. Pass false while anybody relies
  // on the times: such data are late, for whatever reason. Cost: constant.
  Status Observe(uint64_t device_ns, uint64_t host_ns, bool may_fix_anew = true);

  // True while the newest observations look like a jump back that is not confirmed yet: the stamps
  // went back. Do not rely on the times of these stamps.
  bool suspect() const { return run_.observations > 0 && run_.stamps_went_back; }

  // Our time for a device's stamp. kNotStarted: no observation yet; kInvalidArgument: the stamp is
  // 2^62 or more, or its time would be negative. Cost: constant.
  Result<uint64_t> ToHost(uint64_t device_ns) const;

  // Smallest host minus device of the window. Precondition: started().
  int64_t offset_ns() const;
  bool started() const { return started_; }
  const TimebaseCounters& counters() const { return counters_; }

 private:
  // Consecutive observations later than the offset by more than kJump_ns.
  struct LateRun {
    int32_t observations = 0;  // counted up to kConfirmObservations
    bool stamps_went_back = false;
    uint64_t begin_ns = 0;  // our time of the first
    int64_t first_ns = 0;   // its host minus device, and the smallest of all
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
  int64_t previous_smallest_ns_ = kNone_ns;  // of the previous window
  int64_t offset_ns_ = 0;
  int64_t floor_ns_ = 0;      // the floor ...
  uint64_t floor_at_ns_ = 0;  // ... at this time of our clock: it rises from there
  LateRun run_;
  TimebaseCounters counters_;
};
static_assert(std::is_trivially_copyable_v<Timebase>);

}  // namespace hardpack
