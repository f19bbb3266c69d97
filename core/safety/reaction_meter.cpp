// SPDX-License-Identifier: Apache-2.0
#include "core/safety/reaction_meter.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/base/units.h"

namespace hardpack {
namespace {

constexpr uint64_t kPlaceMask = ReactionMeter::kCapacity - 1;
static_assert((ReactionMeter::kCapacity & (ReactionMeter::kCapacity - 1)) == 0);

// The first bin up to whose upper edge the share lies. bins: [count] and one for beyond.
int BinOf(const uint32_t* bins, int count, uint32_t all, float share) {
  const float wanted = Clamp(share, 0.0f, 1.0f) * static_cast<float>(all);
  uint32_t sum = 0;
  HP_LOOP_BOUND(ReactionMeter::kRadiusBins)
  for (int bin = 0; bin < count; ++bin) {
    sum += bins[bin];
    if (sum > 0 && static_cast<float>(sum) >= wanted) return bin;
  }
  return count;
}

}  // namespace

void ReactionMeter::Reset() {
  first_ = round_end_ = judged_end_ = end_ = 0;
  columns_ = 0;
  HP_LOOP_BOUND(kTimeBins + 1)
  for (uint32_t& bin : time_) bin = 0;
  HP_LOOP_BOUND(kRadiusBins + 1)
  for (uint32_t& bin : radius_) bin = 0;
}

// Once in very many columns. Not inlined: its calls are counted (config/timing.toml).
[[gnu::noinline]] void ReactionMeter::HalveBins() {
  columns_ = 0;
  HP_LOOP_BOUND(kTimeBins + 1)
  for (uint32_t& bin : time_) {
    bin /= 2u;
    columns_ += bin;
  }
  uint32_t sum = 0;
  HP_LOOP_BOUND(kRadiusBins + 1)
  for (uint32_t& bin : radius_) {
    bin /= 2u;
    sum += bin;
  }
  // The halves of both are as good as the same number: the difference is less than the bins.
  columns_ = sum > columns_ ? sum : columns_;
}

void ReactionMeter::Count(int time_bin, int radius_bin) {
  if (columns_ >= kMost) HalveBins();
  ++columns_;
  ++time_[time_bin];
  ++radius_[radius_bin];
}

void ReactionMeter::Lost() {
  Count(kTimeBins, kRadiusBins);
}

void ReactionMeter::Filed(uint64_t time_ns) {
  if (end_ - first_ == kCapacity) {
    ++first_;
    round_end_ = round_end_ < first_ ? first_ : round_end_;
    judged_end_ = judged_end_ < first_ ? first_ : judged_end_;
    Lost();
  }
  time_ns_[end_ & kPlaceMask] = time_ns;
  ++end_;
}

void ReactionMeter::RoundBegun() {
  round_end_ = end_;
}

void ReactionMeter::RoundJudged() {
  judged_end_ = round_end_;
}

void ReactionMeter::Commanded(uint64_t now_ns, float speed_mps) {
  const float speed = IsFinite(speed_mps) ? Abs(speed_mps) : kBeyond;
  HP_LOOP_BOUND(kCapacity)
  for (; first_ < judged_end_; ++first_) {
    const uint64_t then_ns = time_ns_[first_ & kPlaceMask];
    const float age_s = then_ns < now_ns ? SecondsBetween(then_ns, now_ns) : 0.0f;
    const int time_bin = ClampInt(FloorToInt(age_s / kTimeBin_s), 0, kTimeBins);
    const int radius_bin = ClampInt(FloorToInt(age_s * speed / kRadiusBin_m), 0, kRadiusBins);
    Count(time_bin, radius_bin);
  }
}

void ReactionMeter::Pause() {
  first_ = round_end_ = judged_end_ = end_;
}

float ReactionMeter::Time_s(float share) const {
  if (columns_ == 0) return 0.0f;
  const int bin = BinOf(time_, kTimeBins, columns_, share);
  return bin == kTimeBins ? kBeyond : static_cast<float>(bin + 1) * kTimeBin_s;
}

float ReactionMeter::Radius_m(float share) const {
  if (columns_ == 0) return 0.0f;
  const int bin = BinOf(radius_, kRadiusBins, columns_, share);
  return bin == kRadiusBins ? kBeyond : static_cast<float>(bin + 1) * kRadiusBin_m;
}

}  // namespace hardpack
