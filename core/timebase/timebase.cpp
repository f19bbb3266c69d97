// SPDX-License-Identifier: Apache-2.0
#include "core/timebase/timebase.h"

#include "core/base/assert.h"
#include "core/base/saturate.h"
#include "core/base/validate.h"

namespace hardpack {
namespace {

// Below it differences of stamps, and differences of those, fit int64_t.
constexpr uint64_t kStampLimit_ns = uint64_t{1} << 62;

int64_t Smaller(int64_t a, int64_t b) {
  return b < a ? b : a;
}
int64_t Larger(int64_t a, int64_t b) {
  return b < a ? a : b;
}

constexpr float kMicrosecondsPerSecond = 1.0e6f;
constexpr int64_t kThousand = 1'000;
// A rate in units of 2^-20: no division, and a ppm is a unit.
constexpr int kRateBits = 20;
constexpr int64_t kRateOne = int64_t{1} << kRateBits;
constexpr float kRatePerPpm = 1.0e-6f * static_cast<float>(kRateOne);

}  // namespace

Status Timebase::Configure(const ClockParams& params) {
  if (FirstInvalidParameter(params) != nullptr) return Status::kParameterOutOfRange;
  max_drift_rate_ = RoundToInt(params.max_drift_ppm * kRatePerPpm);
  max_drift_ns_ = kThousand * RoundToInt(params.max_drift_s * kMicrosecondsPerSecond);
  Reset();
  return Status::kOk;
}

void Timebase::Reset() {
  const int64_t max_drift_rate = max_drift_rate_;
  const int64_t max_drift_ns = max_drift_ns_;
  *this = Timebase{};
  max_drift_rate_ = max_drift_rate;
  max_drift_ns_ = max_drift_ns;
}

// Of two products each below 2^62, however long it is.
int64_t Timebase::Floor_ns(uint64_t host_ns) const {
  const auto since_ns = static_cast<int64_t>(host_ns - floor_at_ns_);
  return floor_ns_ + (since_ns >> kRateBits) * max_drift_rate_ +
         (((since_ns & (kRateOne - 1)) * max_drift_rate_) >> kRateBits);
}

Status Timebase::Observe(uint64_t device_ns, uint64_t host_ns, bool may_fix_anew) {
  if (device_ns >= kStampLimit_ns || host_ns >= kStampLimit_ns ||
      (started_ && host_ns < last_host_ns_)) {
    ++counters_.refused;
    return Status::kInvalidArgument;
  }
  ++counters_.observations;
  last_host_ns_ = host_ns;
  const int64_t difference_ns = static_cast<int64_t>(host_ns) - static_cast<int64_t>(device_ns);
  if (!started_) {
    started_ = true;
    StartFrom(difference_ns, device_ns, host_ns);
    return Status::kOk;
  }
  // After a long silence drift has raised the floor above the offset.
  if (difference_ns - Larger(offset_ns_, Floor_ns(host_ns)) > kJump_ns) {
    return TakeLate(difference_ns, device_ns, host_ns, may_fix_anew);
  }
  if (difference_ns - offset_ns_ < -kJump_ns) {
    ++counters_.jumps;
    StartFrom(difference_ns, device_ns, host_ns);
    return Status::kClockJumped;
  }
  Enter(difference_ns, device_ns, host_ns);
  return Status::kOk;
}

// Nothing from before counts any more.
void Timebase::StartFrom(int64_t difference_ns, uint64_t device_ns, uint64_t host_ns) {
  newest_device_ns_ = device_ns;
  window_begin_ns_ = host_ns;
  window_smallest_ns_ = difference_ns;
  previous_smallest_ns_ = kNone_ns;
  offset_ns_ = difference_ns;
  floor_ns_ = difference_ns;
  floor_at_ns_ = host_ns;
  run_ = LateRun{};
}

void Timebase::Enter(int64_t difference_ns, uint64_t device_ns, uint64_t host_ns) {
  // One window on, however long the silence was: what comes after it may be a backlog, which shows
  // only against the minimum of before.
  if (host_ns - window_begin_ns_ >= static_cast<uint64_t>(kWindow_ns)) {
    previous_smallest_ns_ = window_smallest_ns_;
    window_smallest_ns_ = kNone_ns;
    window_begin_ns_ = host_ns;
  }
  window_smallest_ns_ = Smaller(window_smallest_ns_, difference_ns);
  if (difference_ns <= Floor_ns(host_ns)) {
    floor_ns_ = difference_ns;
    floor_at_ns_ = host_ns;
  }
  const int64_t smallest_ns = Smaller(window_smallest_ns_, previous_smallest_ns_);
  const int64_t bound_ns = Floor_ns(host_ns) + max_drift_ns_;
  if (smallest_ns > bound_ns) ++counters_.beyond_drift;
  offset_ns_ = Smaller(smallest_ns, bound_ns);
  if (device_ns > newest_device_ns_) newest_device_ns_ = device_ns;
  run_ = LateRun{};
}

// Late observations stay out of the minimum: in a window of nothing else they would be it.
Status Timebase::TakeLate(int64_t difference_ns, uint64_t device_ns, uint64_t host_ns,
                          bool may_fix_anew) {
  const int64_t off_first_ns = difference_ns - run_.first_ns;
  const bool steady =
      run_.observations > 0 && off_first_ns >= -kSteady_ns && off_first_ns <= kJump_ns;
  if (!steady) {
    run_.observations = 0;
    // One that was overtaken on the way went back too, but not by as much.
    run_.stamps_went_back = device_ns + static_cast<uint64_t>(kSteady_ns) < newest_device_ns_;
    run_.begin_ns = host_ns;
    run_.first_ns = difference_ns;
    run_.smallest_ns = difference_ns;
  }
  if (run_.observations < kConfirmObservations) ++run_.observations;
  run_.smallest_ns = Smaller(run_.smallest_ns, difference_ns);
  const bool lasts = may_fix_anew && host_ns - run_.begin_ns >= static_cast<uint64_t>(kConfirm_ns);
  if (run_.observations < kConfirmObservations || !(run_.stamps_went_back || lasts)) {
    ++counters_.late;
    return Status::kOk;
  }
  ++counters_.jumps;
  const int64_t smallest_ns = run_.smallest_ns;
  StartFrom(smallest_ns, device_ns, host_ns);
  return Status::kClockJumped;
}

Result<uint64_t> Timebase::ToHost(uint64_t device_ns) const {
  if (!started_) return Status::kNotStarted;
  if (device_ns >= kStampLimit_ns) return Status::kInvalidArgument;
  const int64_t host_ns = static_cast<int64_t>(device_ns) + offset_ns_;
  if (host_ns < 0) return Status::kInvalidArgument;
  return static_cast<uint64_t>(host_ns);
}

int64_t Timebase::offset_ns() const {
  HP_ASSERT(started_);
  return offset_ns_;
}

}  // namespace hardpack
