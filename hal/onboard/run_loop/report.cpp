// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/path/path.h"
#include "hal/onboard/run_loop/run_loop.h"

// RunLoop: what an operator sees. Copies, field by field, from where each thing is known.

namespace hardpack {
namespace {

constexpr control::StatusReport kNothing;  // 2 KiB: not on the stack

// To the microsecond: of parameters, which are at most some minutes.
uint64_t InNanoseconds(float seconds) {
  constexpr uint64_t kNanosecondsPerMicrosecond = 1000;
  const int32_t microseconds = RoundToInt(Max(seconds, 0.0f) * 1.0e6f);
  return static_cast<uint64_t>(microseconds) * kNanosecondsPerMicrosecond;
}

template <typename From, typename To, size_t kSize>
void Copy(const From (&from)[kSize], To (&to)[kSize]) {
  HP_LOOP_BOUND(kSize)
  for (size_t i = 0; i < kSize; ++i) to[i] = from[i];
}

void Fill(const Pilot& pilot, control::VehiclePart& part) {
  const Permission& permission = pilot.permission();
  part.mode = static_cast<uint8_t>(permission.mode);
  part.stop_reason = static_cast<uint8_t>(permission.reason);
  part.last_stop = static_cast<uint8_t>(pilot.supervisor().last_stop());
  part.motion = static_cast<uint8_t>(permission.motion);
  const Odometry& odometry = pilot.odometry();
  part.stop_reason_age = control::AgeAt(pilot.now_ns(), permission.reason_since_ns);
  part.x_m = odometry.pose().position.x_m;
  part.y_m = odometry.pose().position.y_m;
  part.yaw_rad = odometry.pose().yaw_rad;
  part.speed_mps = odometry.speed_mps();
  part.yaw_rate_radps = odometry.yaw_rate_radps();
  part.uses_ins_rate = odometry.uses_ins_rate();
  part.odometry_gaps = odometry.gaps();
  part.commanded_speed_mps = pilot.tracking().speed_mps;
  part.commanded_yaw_rate_radps = pilot.tracking().yaw_rate_radps;
}

void Fill(const AnyVehicle& vehicle, control::VehiclePart& part) {
  const DriveFeedback drives = vehicle.Drives();
  part.drives_ready = drives.ready;
  part.drives_enabled = drives.enabled;
  part.drives_faulty = drives.faulty;
  part.drives_off = vehicle.DrivesAreOff();
}

void Fill(const Odometry& odometry, control::OdometryPart& part) {
  part.position_sigma_m = Max(odometry.Sigma(kStateX), odometry.Sigma(kStateY));
  part.yaw_sigma_rad = odometry.Sigma(kStateYaw);
  part.driven_m = odometry.driven_m();
  part.at_rest = odometry.at_rest();
  part.gyro_bias_radps = odometry.gyro_bias_radps();
  part.gyro_bias_sigma_radps = odometry.Sigma(kStateGyroBias);
  part.wheel_scale = odometry.wheel_scale();
  part.wheel_scale_sigma = odometry.Sigma(kStateWheelScale);
  part.skid_baseline_m = odometry.skid_baseline_m();
  part.skid_baseline_sigma_m = odometry.Sigma(kStateBaseline) * odometry.wheel_scale();
  const OdometryCounters& counters = odometry.counters();
  part.gyro_rejected = counters.gyro_rejected;
  part.wheel_speed_rejected = counters.wheel_speed_rejected;
  part.wheel_turn_rejected = counters.wheel_turn_rejected;
  part.ground_speed_rejected = counters.ground_speed_rejected;
  part.reopened = counters.reopened;
  part.late = counters.late;
  part.too_late = counters.too_late;
  part.repeated = counters.repeated;
  part.refused = counters.refused;
  part.gyro_frozen = counters.gyro_frozen;
  part.wheels_frozen = counters.wheels_frozen;
  part.restarts = counters.restarts;
}

void Fill(const MapFromOdom& map, control::OdometryPart& part) {
  part.map_status = static_cast<uint8_t>(map.status());
  part.map_taken = map.counters().taken;
  part.map_rejected = map.counters().rejected;
  part.map_relocations = map.counters().relocations;
  if (!map.has_transform()) return;
  part.map_x_m = map.map_from_odom().x_m;
  part.map_y_m = map.map_from_odom().y_m;
  part.map_yaw_rad = map.map_from_odom().theta_rad;
  part.map_position_sigma_m = map.position_sigma_m();
  part.map_yaw_sigma_rad = map.yaw_sigma_rad();
}

void Fill(const Pilot& pilot, control::AgePart& part) {
  const SafetyParams& safety = pilot.config().onboard.safety;
  const uint64_t now_ns = pilot.now_ns();
  part.lidar_age = control::AgeAt(now_ns, pilot.lidar_ns(), InNanoseconds(safety.max_lidar_age_s));
  part.ins_age = control::AgeAt(now_ns, pilot.ins_ns(),
                                safety.needs_ins != 0 ? InNanoseconds(safety.max_ins_age_s) : 0);
  part.odometry_age =
      control::AgeAt(now_ns, pilot.odometry().moved_ns(), InNanoseconds(safety.max_odometry_age_s));
  part.operator_age =
      control::AgeAt(now_ns, pilot.operator_ns(), InNanoseconds(safety.operator_timeout_s));
}

void Fill(const Pilot& pilot, control::SightPart& part) {
  static_assert(control::SightPart::kParts == SightWatch::kShown);
  const uint64_t now_ns = pilot.now_ns();
  const float limit_s = pilot.config().onboard.safety.max_look_age_s;
  const SightWatch& sight = pilot.sight();
  part.look_age = control::AgeAt(now_ns, pilot.OldestLook().time_ns, InNanoseconds(limit_s));
  part.sectors = static_cast<uint32_t>(sight.sectors());
  part.old_sectors = static_cast<uint32_t>(sight.OldSectors(now_ns, limit_s));
  part.covered_sectors = static_cast<uint32_t>(sight.covered_sectors());
  part.frozen_sectors = static_cast<uint32_t>(sight.frozen_sectors());
  part.lidar_turned = pilot.mount().has_turned();
  part.ground_tilt_rad = pilot.mount().tilt_rad();
  part.revolution_ns = sight.revolution_ns();
  HP_LOOP_BOUND(SightWatch::kShown)
  for (int i = 0; i < SightWatch::kShown; ++i) {
    const SightWatch::Shares shares = sight.SharesOf(i, now_ns);
    part.columns_permille[i] = shares.columns_permille;
    part.returns_permille[i] = shares.returns_permille;
  }
}

void Fill(const Pilot& pilot, control::GoalPart& part) {
  part.goals = static_cast<uint32_t>(pilot.goals());
  part.paused = pilot.paused();
  part.at_waypoint = pilot.at_waypoint();
  part.may_resume = pilot.may_resume();
  if (part.goals == 0) return;
  const Vec2 goal = pilot.goal_odom();
  const Vec3& here = pilot.odometry().pose().position;
  part.goal_index = static_cast<uint32_t>(pilot.goal_index());
  part.goal_x_m = goal.x_m;
  part.goal_y_m = goal.y_m;
  const float dx_m = goal.x_m - here.x_m;
  const float dy_m = goal.y_m - here.y_m;
  part.distance_to_goal_m = Sqrt(dx_m * dx_m + dy_m * dy_m);
}

void Fill(const Pilot& pilot, control::PlanPart& part) {
  const Replanner& replanner = pilot.replanner();
  const ReplanOutcome& outcome = replanner.outcome();
  part.decision = static_cast<uint8_t>(outcome.decision);
  part.reason = static_cast<uint8_t>(outcome.reason);
  part.status = static_cast<uint8_t>(outcome.status);
  part.plan_status = static_cast<uint8_t>(outcome.plan_status);
  const CommittedPlan& plan = replanner.committed();
  part.number = plan.number;
  if (plan.number == 0) return;
  part.check_age = control::AgeAt(pilot.now_ns(), plan.checked_ns,
                                  InNanoseconds(pilot.config().onboard.safety.max_plan_age_s));
  part.distance_to_end_m = LengthOf(plan.path) - replanner.place().along_m;
  part.reaches_goal = plan.reaches_goal;
  part.is_stop = plan.is_stop;
  part.narrow = plan.narrow;
}

void Fill(const Pilot& pilot, control::SafetyPart& part) {
  const Corridor& corridor = pilot.corridor();
  part.obstacle_ahead = corridor.has_obstacle();
  part.person_ahead = corridor.is_person();
  if (corridor.has_obstacle()) {
    part.obstacle_distance_m = corridor.obstacle_along_m() - pilot.replanner().place().along_m;
  }
  const ReactionMeter& reaction = pilot.reaction();
  part.reaction_median_s = reaction.Time_s(0.5f);
  part.reaction_p99_s = reaction.Time_s(0.99f);
  part.reaction_median_m = reaction.Radius_m(0.5f);
  part.reaction_p99_m = reaction.Radius_m(0.99f);
  part.reaction_columns = reaction.columns();
  part.reaction_lost = reaction.lost();
  const GateCounters& gate = pilot.gate().counters();
  part.commands_not_finite = gate.not_finite;
  part.commands_not_permitted = gate.not_permitted;
  part.commands_above_speed = gate.above_speed;
  part.commands_above_change = gate.above_change;
}

void Fill(const Pilot& pilot, control::AreasPart& part) {
  const AreaSet& areas = pilot.areas();
  part.areas = static_cast<uint32_t>(areas.size());
  part.configured = static_cast<uint32_t>(areas.configured());
  part.expected = static_cast<uint32_t>(areas.expected());
  part.unknown = !areas.is_known();
  part.breached = pilot.breached_area() >= 0;
  part.breached_area = static_cast<uint32_t>(pilot.breached_area() + 1);
}

void Fill(const ReplanCounters& counters, control::ReplanPart& part) {
  static_assert(control::kReplanReasonCount == kReplanReasons);
  part.plans = counters.plans;
  part.kept = counters.kept;
  part.extended = counters.extended;
  Copy(counters.replaced, part.replaced);
  part.stopped = counters.stopped;
  part.failed = counters.failed;
  part.reanchored = counters.reanchored;
  part.late = counters.late;
  part.refused = counters.refused;
}

void Fill(const InsSample& sample, control::InsPart& part) {
  part.mode = static_cast<uint8_t>(sample.status.mode);
  part.gnss_fix = sample.status.gnss_fix;
  part.time_error = sample.status.time_error;
  part.imu_error = sample.status.imu_error;
  part.magnetometer_or_pressure_error = sample.status.magnetometer_or_pressure_error;
  part.gnss_error = sample.status.gnss_error;
  part.has_position = sample.has_position;
  part.latitude_ndeg = sample.latitude_ndeg;
  part.longitude_ndeg = sample.longitude_ndeg;
  part.position_uncertainty_m = sample.position_uncertainty_m;
}

void Fill(const MapperCounters& counters, control::MapperPart& part) {
  part.columns_without_pose = counters.columns_without_pose;
  part.columns_over_limit = counters.columns_over_limit;
  part.folded_with_labels = counters.folded_with_labels;
  part.folded_without_labels = counters.folded_without_labels;
  part.folded_early = counters.folded_early;
  part.late_unclassed_columns = counters.late_unclassed_columns;
  part.returns_off_map = counters.returns_off_map;
  part.overhead_returns = counters.overhead_returns;
  part.height_jumps = counters.height_jumps;
  part.position_jumps = counters.position_jumps;
  part.sensor_restarts = counters.sensor_restarts;
}

}  // namespace

void RunLoop::Report(control::StatusReport& report) const {
  const Pilot& pilot = vehicle_.pilot();
  report = kNothing;
  report.program = program_;
  report.program.uptime_ns = pilot.now_ns() - first_ns_;
  report.program.tick_index = index_;
  report.program.decision_hash = pilot.decision_hash();
  if (options_.allocations != nullptr) report.program.heap_allocations = options_.allocations();
  Fill(pilot, report.vehicle);
  Fill(vehicle_, report.vehicle);
  Fill(pilot.odometry(), report.odometry);
  Fill(pilot.map_from_odom(), report.odometry);
  Fill(pilot, report.inputs);
  Fill(pilot, report.goal);
  Fill(pilot, report.plan);
  Fill(pilot, report.safety);
  Fill(pilot, report.areas);
  Fill(pilot, report.sight);
  Fill(pilot.replanner().counters(), report.replan);
  Fill(pilot.newest_ins(), report.ins);
  Fill(pilot.mapper().counters(), report.mapper);
  report.loop = pilot.counters();
  vehicle_.Report(report);
  report.can.state = static_cast<uint8_t>(devices_.can->state());
  report.can.bus = devices_.can->counters();
  report.lidar_socket = devices_.lidar->counters();
  if (devices_.ins != nullptr) report.ins_socket = devices_.ins->counters();
  if (devices_.labels != nullptr) report.label_socket = devices_.labels->counters();
  if (devices_.recorder != nullptr) report.recorder = devices_.recorder->counters();
  if (devices_.control != nullptr) report.control = devices_.control->counters();
}

}  // namespace hardpack
