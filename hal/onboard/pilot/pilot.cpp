// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/pilot/pilot.h"

#include "core/autonomy/assured_sight.h"
#include "core/base/footprint.h"
#include "core/base/math.h"
#include "core/base/units.h"
#include "core/base/validate.h"

namespace hardpack {

void Pilot::Forget() {
  has_ticked_ = false;
  index_ = 0;
  now_ns_ = 0;
  lidar_ns_ = 0;
  ins_ns_ = 0;
  operator_ns_ = 0;
  before_ns_ = 0;
  tick_s_ = 0.0f;
  is_gap_ = false;
  is_located_ = false;
  wishes_ = {};
  goals_.Clear();
  goal_index_ = 0;
  on_mission_ = false;
  may_resume_ = false;
  paused_ = false;
  held_at_ns_ = 0;
  leg_start_odom_ = {};
  goals_list_ = 0;
  newest_ins_ = {};
  ins_rate_ = {};
  ins_rate_ns_ = 0;
  ins_speed_mps_ = 0.0f;
  ins_speed_ns_ = 0;
  operator_press_ = 0;
  has_position_ = false;
  breached_area_ = -1;
  area_ = StopReason::kNone;
  lookouts_.Clear();
  people_.Reset();
  bodies_.Reset();
  walkers_.Clear();
  labels_ns_ = 0;
  ground_.Reset();
  ground_drops_ = false;
  may_creep_ = true;
  tracking_output_ = {};
  permission_ = {};
  hash_ = {};
  counters_ = {};
}

Status Pilot::Configure(const PilotConfig& config, const LidarLayout& lidar) {
  config_ = config;
  window_ = lidar.window;
  const OnboardParams& onboard = config.onboard;
  Status status = LimitSpeed(lidar);
  if (IsUsable(status)) status = replanner_.Configure(config_.planner);
  if (IsUsable(status)) {
    status = odometry_.Configure(config.planner.vehicle, onboard.odometry, onboard.ins);
  }
  if (IsUsable(status)) status = map_from_odom_.Configure(onboard.map_from_odom, onboard.ins);
  if (IsUsable(status)) {
    status = tracker_.Configure(config.planner.vehicle, config_.planner.speed, onboard.odometry,
                                onboard.dynamics, onboard.tracking);
  }
  if (IsUsable(status)) status = supervisor_.Configure(onboard.safety);
  if (IsUsable(status)) status = ConfigureSafety();
  if (IsUsable(status)) status = ConfigureSight();
  if (IsUsable(status)) status = areas_.Configure(config.areas);
  return status;
}

// No faster than it sees what is low, and not backwards where it sees nothing.
Status Pilot::LimitSpeed(const LidarLayout& lidar) {
  if (FirstInvalidParameter(config_.planner) != nullptr) return Status::kParameterOutOfRange;
  const Status status = MakeBeamModel(lidar, beam_model_);
  if (!IsUsable(status)) return status;
  const float hidden_m = RearOf(config_.planner.vehicle) - config_.perception.mount.self_min_x_m;
  if (hidden_m > kMaxHiddenBehind_m) config_.planner.path.reverse_out_m = 0.0f;
  return LimitToAssuredSight(beam_model_, config_.perception, config_.planner.vehicle,
                             config_.planner.speed);
}

// With an empty map.
Status Pilot::ConfigureMapper() {
  return mapper_.Configure(config_.perception, config_.planner.costmap, config_.labels, beam_model_,
                           window_.first, window_.last);
}

void Pilot::BeginTick(uint64_t index, uint64_t now_ns) {
  tick_s_ = static_cast<float>(config_.onboard.tick.period_ms) / kMillisecondsPerSecond;
  if (has_ticked_) tick_s_ = Min(SecondsBetween(now_ns_, now_ns), kLongestTick_s);
  before_ns_ = has_ticked_ ? now_ns_ : now_ns;
  has_ticked_ = true;
  index_ = index;
  now_ns_ = now_ns;
  wishes_ = {};
  mapper_.BeginTick(config_.onboard.tick.directions);
}

void Pilot::TakeIns(const InsSample& sample, uint64_t measured_ns) {
  if (IsUsable(odometry_.TakeIns(sample, measured_ns))) NoteIns(sample, measured_ns);
}

// What the sample that was just taken says besides.
void Pilot::NoteIns(const InsSample& sample, uint64_t measured_ns) {
  newest_ins_ = sample;
  if (measured_ns > ins_ns_) ins_ns_ = measured_ns;
  if (sample.has_angular_rate) {
    ins_rate_ = sample.angular_rate;
    ins_rate_ns_ = measured_ns;
  }
  const InsStatus& ins = sample.status;
  const bool vouches_for_speed = sample.has_velocity && sample.has_status &&
                                 ins.mode == InsMode::kTracking && ins.gnss_fix &&
                                 !ins.gnss_error && !ins.imu_error;
  if (vouches_for_speed) {
    const VelocityNed& velocity = sample.velocity_ned;
    ins_speed_mps_ =
        Sqrt(velocity.north_mps * velocity.north_mps + velocity.east_mps * velocity.east_mps);
    ins_speed_ns_ = measured_ns;
  }
  if (!sample.has_position) return;
  ins_position_ = sample;
  has_position_ = true;
}

void Pilot::TakeLabels(const ColumnLabels& labels) {
  if (!IsUsable(mapper_.AddLabels(labels))) {
    ++counters_.refused_labels;
  } else {
    labels_ns_ = now_ns_;
  }
  TestReturns(false);
}

void Pilot::TakeColumn(const LidarColumn& column, uint64_t time_ns) {
  if (!IsUsable(mapper_.AddColumn(column, time_ns))) return LoseColumn();
  if (time_ns > lidar_ns_) lidar_ns_ = time_ns;
  sight_.Take(column, time_ns);
  TestReturns(true);
}

void Pilot::LoseColumn() {
  ++counters_.refused_columns;
  if (on_mission_) reaction_.Lost();
}

void Pilot::FinishMap() {
  mapper_.Advance(now_ns_);
  TestReturns(true);
  ReleaseLeftPlace();
  LookForLost();
  AdvanceMount();
  ExpectReturns();
}

// Where the vehicle went in a gap nobody knows: what was mapped before it no longer has a place.
void Pilot::Localise(const WheelFeedback& wheels) {
  const uint32_t gaps = odometry_.gaps();
  const Status moved = odometry_.Advance(now_ns_, wheels);
  is_gap_ = odometry_.gaps() != gaps;
  if (is_gap_) {
    ++counters_.odometry_gaps;
    Restart();
  }
  const StampedPose& pose = odometry_.pose();
  const uint32_t jumps = mapper_.counters().position_jumps;
  static_cast<void>(mapper_.AddPose(pose));
  if (!is_gap_ && mapper_.counters().position_jumps != jumps) {
    // The ground around is as good as never looked at: it begins anew as after a gap, and the
    // vehicle stops, rather than that it stands on unseen ground for good.
    is_gap_ = true;
    ++counters_.odometry_jumps;
    Restart();
    static_cast<void>(mapper_.AddPose(pose));
  }
  if (is_gap_) {
    corridor_.Reset();
    sweep_.Reset();
    has_start_ = false;
    may_resume_ = false;
    lookouts_.Clear();
    people_.Reset();
    bodies_.Reset();
  }
  if (!has_start_) {
    has_start_ = true;
    start_odom_ = {pose.position.x_m, pose.position.y_m, pose.yaw_rad};
  }
  NoteLookout();
  sweep_.Advance({pose.position.x_m, pose.position.y_m});
  corridor_.Advance({pose.position.x_m, pose.position.y_m}, static_cast<uint32_t>(index_));
  LocateInMap(pose);
  const BodyMotion body = {.valid = moved == Status::kOk,
                           .speed_mps = odometry_.speed_mps(),
                           .yaw_rate_radps = odometry_.yaw_rate_radps()};
  static_cast<void>(tracker_.Predict(now_ns_, {pose.position.x_m, pose.position.y_m, pose.yaw_rad},
                                     wheels, body));
}

// The map begins anew, as when it was configured: that cannot fail.
void Pilot::Restart() {
  replanner_.Forget();
  static_cast<void>(ConfigureMapper());
  map_from_odom_.Restart();
}

void Pilot::LocateInMap(const StampedPose& pose) {
  const Pose2 pose_odom = {pose.position.x_m, pose.position.y_m, pose.yaw_rad};
  if (has_position_) {
    static_cast<void>(
        map_from_odom_.TakeIns(ins_position_, pose_odom, odometry_.driven_m(), now_ns_));
  }
  has_position_ = false;
  map_from_odom_.Advance(now_ns_, pose_odom);
  areas_.Advance(map_from_odom_);
}

void Pilot::AddToHash(const CommandAnswer& answer) {
  hash_.AddU64(index_);
  hash_.AddU8(static_cast<uint8_t>(permission_.mode));
  hash_.AddU8(static_cast<uint8_t>(permission_.reason));
  hash_.AddU8(static_cast<uint8_t>(permission_.motion));
  hash_.AddU8(answer.has_answer ? static_cast<uint8_t>(answer.answer) : uint8_t{0xff});
  hash_.AddFloat(odometry_.pose().position.x_m);
  hash_.AddFloat(odometry_.pose().position.y_m);
  hash_.AddFloat(odometry_.pose().yaw_rad);
}

}  // namespace hardpack
