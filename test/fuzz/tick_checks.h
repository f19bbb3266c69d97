// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "test/fuzz/fuzzed_vehicle.h"
#include "test/fuzz/mapper_script.h"

// What is required of every tick (docs/safety.md), seen from outside: from the bytes that go out,
// from what the loop says of itself, and from its counters before and after.

namespace hardpack {

class TickChecks {
 public:
  explicit TickChecks(const FuzzedLoop& loop) : loop_(loop) {}

  // Once the state to begin with is there.
  void Begin() { left_path_ = motion() == Motion::kZero; }

  void Before(const TickInput& input) {
    before_ns_ = loop_.now_ns();
    before_index_ = loop_.index();
    before_ = loop_.counters();
    ins_looks_ = LooksOf(loop_.ins());
    packets_ = PacketsOf(loop_.lidar());
    frames_ = FramesOf(loop_.drives());
    fits_ = input.index > before_index_ && input.now_ns > before_ns_ &&
            input.datagrams.size() <= FuzzedLoop::kMaxDatagramsPerTick &&
            input.frames.size() <= CanBus::kMaxFramesPerTick;
    if (!fits_) std::memcpy(static_cast<void*>(kept_.get()), &loop_, sizeof(FuzzedLoop));
  }

  void After(const TickInput& input, Status status, const TickOutput& output) {
    Require(status == (fits_ ? Status::kOk : Status::kInvalidArgument));
    CheckFrames(output);
    if (!fits_) {
      CheckRefused(output);
      return;
    }
    CheckTaken(input, output);
    CheckInputs(input);
    CheckAges(input);
    CheckZero();
    CheckStop();
    CheckState();
  }

 private:
  DriveFeedback Drives() const { return loop_.drives().State(loop_.now_ns()); }
  const SafetyParams& safety() const { return loop_.config().onboard.safety; }
  Motion motion() const { return loop_.permission().motion; }
  bool MovesAlong() const { return motion() == Motion::kFollow || motion() == Motion::kStopAlong; }
  bool MayMove() const {
    const Mode mode = loop_.permission().mode;
    return (mode == Mode::kDriving && MovesAlong()) ||
           (mode == Mode::kSafeStop && motion() == Motion::kStopAlong);
  }

  // What a bus can carry, and of the drives' commands what the wheels may do: as a drive reads it.
  void CheckFrames(const TickOutput& output) const {
    Require(output.frames.size() <= kMostDriveFrames);
    ToldSpeeds told;
    for (const CanFrame& frame : output.frames) {
      Require(IsValid(frame) && !frame.extended);
      TakeTold(frame, loop_.config(), loop_.gate().last(), loop_.drives(), told);
    }
    Require(told.frames[0] <= 1 && told.frames[1] <= 1);
    Require(told.is_zero || (MayMove() && Drives().ready && Drives().enabled));
  }

  // Nothing has changed but that it was counted.
  void CheckRefused(const TickOutput& output) const {
    Require(output.frames.empty() && !output.has_answer);
    Require(loop_.counters().refused_ticks == before_.refused_ticks + 1);
    const auto* now = reinterpret_cast<const uint8_t*>(&loop_);
    const auto* kept = reinterpret_cast<const uint8_t*>(kept_.get());
    const auto* counter = reinterpret_cast<const uint8_t*>(&loop_.counters().refused_ticks);
    const auto at = static_cast<size_t>(counter - now);
    const size_t behind = at + sizeof(uint64_t);
    Require(std::memcmp(now, kept, at) == 0);
    Require(std::memcmp(now + behind, kept + behind, sizeof(FuzzedLoop) - behind) == 0);
  }

  // Everything that came was counted, and no more was taken than a tick may take.
  void CheckTaken(const TickInput& input, const TickOutput& output) const {
    const LoopCounters& now = loop_.counters();
    Require(now.ticks == before_.ticks + 1 && now.refused_ticks == before_.refused_ticks);
    Require(now.missed_ticks - before_.missed_ticks == input.index - before_index_ - 1);
    for (int source = 0; source < kInputSources; ++source) {
      const auto given = std::count_if(input.datagrams.begin(), input.datagrams.end(),
                                       [source](const TickDatagram& datagram) {
                                         return static_cast<int>(datagram.source) == source;
                                       });
      Require(now.datagrams[source] - before_.datagrams[source] == static_cast<uint64_t>(given));
      Require(now.refused_datagrams[source] - before_.refused_datagrams[source] <=
              static_cast<uint64_t>(given));
    }
    Require(FramesOf(loop_.drives()) - frames_ == input.frames.size());
    Require(LooksOf(loop_.ins()) - ins_looks_ <= FuzzedLoop::kMaxInsMessages);
    Require(output.has_answer == !input.command.empty());
    Require(now.commands - before_.commands == (input.command.empty() ? 0u : 1u));
    Require(now.refused_commands - before_.refused_commands <= now.commands - before_.commands);
    Require(now.plans - before_.plans <= 1);
    Require(now.lidar_restarts - before_.lidar_restarts <= 1);
    Require(now.odometry_gaps + now.odometry_jumps - before_.odometry_gaps -
                before_.odometry_jumps <=
            1);
    CheckColumns();
  }

  // Each lidar's datagram was looked at, once more after a restart; of the columns of those that
  // were not refused what a tick's directions do not allow was.
  void CheckColumns() const {
    constexpr auto kLidar = static_cast<size_t>(InputSource::kLidar);
    const LoopCounters& now = loop_.counters();
    const uint64_t datagrams = now.datagrams[kLidar] - before_.datagrams[kLidar];
    Require(PacketsOf(loop_.lidar()) - packets_ ==
            datagrams + now.lidar_restarts - before_.lidar_restarts);
    const uint64_t used =
        datagrams - (now.refused_datagrams[kLidar] - before_.refused_datagrams[kLidar]);
    const uint64_t columns = used * static_cast<uint64_t>(loop_.lidar().columns());
    const uint64_t refused = now.refused_columns - before_.refused_columns;
    const uint64_t suspect = now.suspect_columns - before_.suspect_columns;
    const auto most = static_cast<uint64_t>(loop_.config().onboard.tick.directions);
    Require(refused + suspect <= columns && columns - std::min(columns, refused) <= most);
  }

  // Nothing is driven on what is too old, or on a bus that is not there.
  void CheckInputs(const TickInput& input) const {
    if (motion() != Motion::kFollow) return;
    Require(loop_.permission().mode == Mode::kDriving);
    Require(!IsOlder(loop_.lidar_ns(), safety().max_lidar_age_s));
    Require(!IsOlder(loop_.ins_ns(), safety().max_ins_age_s));
    Require(!IsOlder(Wheels_ns(), safety().max_odometry_age_s));
    Require(!IsOlder(loop_.replanner().committed().checked_ns, safety().max_plan_age_s));
    Require(input.bus == CanBusState::kActive || input.bus == CanBusState::kWarning ||
            input.bus == CanBusState::kPassive);
    // The drives are judged anew when they are commanded: what has just fallen silent is sent zero,
    // and is a fault in the next tick.
    Require(Drives().ready || IsToldZero(loop_.drives()));
  }

  // Nor is any path followed to its end on what is far too old.
  void CheckAges(const TickInput& input) const {
    if (!MovesAlong()) return;
    const float factor = safety().hard_age_factor;
    Require(input.now_ns == loop_.now_ns());
    Require(!IsOlder(loop_.lidar_ns(), factor * safety().max_lidar_age_s));
    Require(!IsOlder(Wheels_ns(), factor * safety().max_odometry_age_s));
    Require(safety().needs_ins == 0 || !IsOlder(loop_.ins_ns(), factor * safety().max_ins_age_s));
  }

  bool IsOlder(uint64_t then_ns, float limit_s) const {
    const uint64_t now_ns = loop_.now_ns();
    return then_ns == 0 || static_cast<double>(now_ns - std::min(then_ns, now_ns)) * 1e-9 >
                               static_cast<double>(limit_s) + 1e-6;
  }

  // Of the wheel speeds that moved the odometry, and of those that the drives reported: these as
  // they were to be known in the tick before.
  uint64_t Wheels_ns() const {
    const uint64_t now_ns = loop_.now_ns();
    const uint64_t reported_ns = Drives().wheels.time_ns + now_ns - before_ns_;
    return std::min(loop_.odometry().moved_ns(), reported_ns);
  }

  // Once the path is not followed any more, it is not before the wheels stand.
  void CheckZero() {
    const bool stand = Stand(loop_.drives(), loop_.config(), loop_.now_ns());
    if (stand) left_path_ = false;
    Require(!left_path_ || !MovesAlong());
    if (motion() == Motion::kZero || motion() == Motion::kOff) left_path_ = !stand;
  }

  // A safe stop becomes zero speed when it has lasted too long.
  void CheckStop() {
    const bool stops = loop_.permission().mode == Mode::kSafeStop;
    if (stops && !stopped_) stop_ns_ = loop_.now_ns();
    stopped_ = stops;
    if (!stops || motion() != Motion::kStopAlong) return;
    const double lasted_s = static_cast<double>(loop_.now_ns() - stop_ns_) * 1e-9;
    Require(lasted_s <= static_cast<double>(safety().max_stop_s) + 0.001);
  }

  void CheckState() const {
    const WheelCommand& command = loop_.gate().last();
    const float most = loop_.config().planner.vehicle.max_wheel_speed_radps;
    Require(std::abs(command.left_radps) <= most && std::abs(command.right_radps) <= most);
    Require(MayMove() || (command.left_radps == 0.0f && command.right_radps == 0.0f));
    const StampedPose& pose = loop_.odometry().pose();
    Require(IsFinite(pose.position.x_m) && IsFinite(pose.position.y_m) && IsFinite(pose.yaw_rad));
    Require(IsFinite(loop_.odometry().speed_mps()));
    const CommittedPlan& plan = loop_.replanner().committed();
    for (const float speed_mps : plan.speed) Require(speed_mps >= 0.0f && speed_mps <= 20.0f);
    for (const Pose2& place : plan.path) Require(IsFinite(place.x_m) && IsFinite(place.y_m));
  }

  const FuzzedLoop& loop_;
  bool fits_ = false;
  uint64_t before_ns_ = 0;
  uint64_t before_index_ = 0;
  LoopCounters before_;
  uint64_t ins_looks_ = 0;
  uint64_t packets_ = 0;
  uint32_t frames_ = 0;
  bool left_path_ = false;  // zero was commanded at once, and the wheels have not stood since
  bool stopped_ = false;    // the tick before was of a safe stop ...
  uint64_t stop_ns_ = 0;    // ... that began then
  // Of the state before a tick that is to be refused.
  static inline std::unique_ptr<FuzzedLoop> kept_ = std::make_unique<FuzzedLoop>();
};

}  // namespace hardpack
