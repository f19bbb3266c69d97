// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cmath>

#include "tools/replay/replay.h"

namespace hardpack::replay {
namespace {

constexpr float kPoseEvery_m = 0.1f;

Pose2 PoseOf(const Pilot& pilot) {
  const StampedPose& pose = pilot.odometry().pose();
  return {pose.position.x_m, pose.position.y_m, pose.yaw_rad};
}

bool IsFarther(const Pose2& from, const Pose2& to) {
  return std::hypot(to.x_m - from.x_m, to.y_m - from.y_m) >= kPoseEvery_m;
}

}  // namespace

void Durations::Add(uint64_t index, uint64_t duration_ns) {
  ++ticks;
  sum_ns += duration_ns;
  if (duration_ns <= largest_ns) return;
  largest_ns = duration_ns;
  largest_index = index;
}

Status Observer::Tick(const TickInput& input, AnyVehicle& vehicle, TickOutput& output) {
  const auto before = std::chrono::steady_clock::now();
  const Status status = vehicle.Tick(input, output);
  const auto took = std::chrono::steady_clock::now() - before;
  report_.replayed.Add(
      input.index,
      static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(took).count()));
  if (report_.ticks++ == 0) report_.first_index = input.index;
  report_.last_index = input.index;
  const Pilot& pilot = vehicle.pilot();
  report_.decision_hash = pilot.decision_hash();
  report_.frames_out += output.frames.size();
  report_.frames_in += static_cast<int64_t>(input.frames.size());
  for (const TickDatagram& datagram : input.datagrams) {
    ++report_.datagrams[static_cast<size_t>(datagram.source)];
  }
  const Permission& permission = pilot.permission();
  if (!any_ || permission.mode != mode_ || permission.reason != reason_) {
    report_.modes.push_back({input.index, input.now_ns, permission.mode, permission.reason});
  }
  const uint64_t plans = pilot.replanner().counters().plans;
  if (any_ && plans != plans_) {
    report_.plans.push_back({input.index, input.now_ns, pilot.replanner().outcome(),
                             pilot.replanner().committed().number, PoseOf(pilot)});
  }
  const Pose2 pose = PoseOf(pilot);
  if (report_.driven.empty() || IsFarther(report_.driven.back(), pose)) {
    report_.driven.push_back(pose);
  }
  any_ = true;
  mode_ = permission.mode;
  reason_ = permission.reason;
  plans_ = plans;
  return status;
}

}  // namespace hardpack::replay
