// SPDX-License-Identifier: Apache-2.0
#include "tools/mission/observer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tools/ctl/code_names.h"
#include "tools/world/contact.h"

namespace hardpack::mission {
namespace {

using experiment::Outcome;

constexpr double kRest_mps = 0.03;
constexpr double kSample_s = 0.05;
// The jerk is the second difference of speeds so many ticks apart: what passengers feel, not the
// step of one tick.
constexpr size_t kJerkTicks = 5;

world::Point2 Here(const LockStep& run) {
  const sim::Pose& pose = run.vehicle().vehicle().pose();
  return {pose.x_m, pose.y_m};
}

// Of the committed plan where the vehicle is; 0 without one.
double PlannedSpeed_mps(const Replanner& replanner) {
  const CommittedPlan& plan = replanner.committed();
  const PathPlace& place = replanner.place();
  if (plan.number == 0 || place.point + 1 >= plan.speed.size()) return 0.0;
  const double from_mps = double{plan.speed[place.point]};
  return from_mps + double{place.share} * (double{plan.speed[place.point + 1]} - from_mps);
}

std::string ReasonName(StopReason reason) {
  return ctl::NameOf(control::FieldKind::kStopReason, static_cast<uint8_t>(reason)).name;
}
std::string ModeName(Mode mode) {
  return ctl::NameOf(control::FieldKind::kMode, static_cast<uint8_t>(mode)).name;
}

}  // namespace

void Observer::Note(double t_s, const std::string& text) {
  if (trace_ != nullptr) trace_->events.push_back({t_s, text});
}

void Observer::End(Outcome outcome) {
  if (ended_) return;
  ended_ = true;
  result_.outcome = outcome;
}

void Observer::Watch(const LockStep& run) {
  const double t_s = run.time_s() - start_s_;
  result_.time_s = t_s;
  result_.max_speed_mps =
      std::max(result_.max_speed_mps, std::fabs(run.vehicle().vehicle().speed_mps()));
  WatchPlan(run, t_s);
  WatchMotion(run, t_s);
  WatchContact(run, t_s);
  WatchMode(run, t_s);
  Sample(run, t_s);
}

void Observer::WatchContact(const LockStep& run, double t_s) {
  const sim::Pose& pose = run.vehicle().vehicle().pose();
  const double speed_mps = std::fabs(run.vehicle().vehicle().speed_mps());
  const world::Contact contact =
      world::ContactOf(run.world(), pose.x_m, pose.y_m, pose.theta_rad, run.time_s());
  clearance_m_ = std::max(0.0, contact.hard_m);
  result_.clearance_m = std::min(result_.clearance_m, clearance_m_);
  if (contact.hard_m < 0.0 || contact.in_ditch || contact.too_steep()) {
    if (!ended_) {
      Note(t_s, contact.in_ditch ? "in a ditch" : contact.hard_m < 0.0 ? "touched" : "too steep");
    }
    End(Outcome::kContact);
  }
  if (speed_mps <= kPersonSpeed_mps) return;
  result_.person_clearance_m =
      std::min(result_.person_clearance_m, std::max(0.0, contact.person_m));
  if (contact.person_m < 0.0) {
    if (!ended_) Note(t_s, "touched a person at " + std::to_string(speed_mps) + " m/s");
    End(Outcome::kPerson);
  }
}

// A path is held against where the vehicle is in truth; it lies where the odometry was when it was
// committed.
void Observer::WatchPlan(const LockStep& run, double t_s) {
  const CommittedPlan& plan = run.loop().replanner().committed();
  if (plan.number == plan_) return;
  const bool is_replan = plan_ != 0 && plan.number != 0;
  if (is_replan) ++result_.replans;
  plan_ = plan.number;
  path_.clear();
  if (plan.number == 0) return;
  const WorldFromOdom frame(run.vehicle().vehicle().pose(), run.loop().odometry().pose());
  for (const Pose2& pose : plan.path) path_.push_back(frame.ToWorld({pose.x_m, pose.y_m}));
  result_.way.off_base_m =
      std::max(result_.way.off_base_m, OffBase_m(run.loop().replanner().planner().result()));
  way_.Committed(path_, Here(run), is_replan);
  if (trace_ != nullptr) trace_->plans.push_back({t_s, path_});
}

void Observer::WatchMotion(const LockStep& run, double t_s) {
  const double speed_mps = run.vehicle().vehicle().speed_mps();
  speeds_mps_.push_back(speed_mps);
  if (speeds_mps_.size() > 2 * kJerkTicks) {
    constexpr double kStep_s = static_cast<double>(kJerkTicks) * 0.01;
    const double jerk_mps3 =
        (speeds_mps_[2 * kJerkTicks] - 2.0 * speeds_mps_[kJerkTicks] + speeds_mps_[0]) /
        (kStep_s * kStep_s);
    jerk2_sum_ += jerk_mps3 * jerk_mps3;
    ++jerks_;
    speeds_mps_.pop_front();
  }
  way_.Moved(Here(run));
  if (path_.size() < 2 || run.loop().permission().mode != Mode::kDriving) return;
  cross_track_m_ = DistanceToPath_m(Here(run), path_);
  if (std::fabs(speed_mps) <= 0.1) return;
  result_.cross_track_m.Add(cross_track_m_);
  way_.Followed(t_s, cross_track_m_);
}

void Observer::WatchMode(const LockStep& run, double t_s) {
  const Permission& permission = run.loop().permission();
  const std::string reason = ReasonName(permission.reason);
  if (permission.mode != mode_ || reason != said_) {
    Note(t_s, ModeName(permission.mode) + (reason == "none" ? "" : ": " + reason));
    said_ = reason;
    said_since_s_ = t_s;
  }
  mode_ = permission.mode;
  if (reason != "none") result_.reason = reason;
  const bool stands = std::fabs(run.vehicle().vehicle().speed_mps()) < kRest_mps &&
                      std::fabs(run.vehicle().vehicle().yaw_rate_radps()) < kRest_mps;
  if (stands && !stands_ && drove_) ++result_.stops;
  if (stands != stands_) stands_since_s_ = t_s;
  stands_ = stands;
  drove_ = drove_ || !stands;
  if (mode_ == Mode::kFault || mode_ == Mode::kEmergencyStop) End(Outcome::kFault);
  if (drove_ && stands && mode_ == Mode::kArmed && run.loop().goals() == 0) {
    End(Outcome::kReached);
  }
  if (!stands) return;
  const double stood_s = t_s - stands_since_s_;
  if (said_ != "none" && stood_s > kSaid_s && t_s - said_since_s_ > kSaid_s) {
    End(Outcome::kSaid);
  } else if (stood_s > kStuck_s) {
    End(Outcome::kStuck);
  }
}

void Observer::Sample(const LockStep& run, double t_s) {
  if (trace_ == nullptr) return;
  maps_.Watch(run, t_s, trace_->maps);
  if (t_s < next_sample_s_) return;
  next_sample_s_ = t_s + kSample_s - 1.0e-6;
  const sim::SimVehicle& vehicle = run.vehicle().vehicle();
  const TrackingOutput& commanded = run.loop().tracking();
  MissionTrace::Sample sample;
  sample.t_s = t_s;
  sample.x_m = vehicle.pose().x_m;
  sample.y_m = vehicle.pose().y_m;
  sample.yaw_rad = vehicle.pose().theta_rad;
  sample.speed_mps = vehicle.speed_mps();
  sample.commanded_mps = commanded.speed_mps;
  sample.planned_mps = PlannedSpeed_mps(run.loop().replanner());
  sample.yaw_rate_radps = vehicle.yaw_rate_radps();
  sample.commanded_yaw_radps = commanded.yaw_rate_radps;
  sample.commanded_curvature_per_m = commanded.curvature_per_m;
  sample.cross_track_m = cross_track_m_;
  sample.clearance_m = clearance_m_;
  reaction_.Add(run.loop().reaction().radius_bins());
  sample.reaction_median_m = reaction_.Radius_m(0.5);
  sample.reaction_p99_m = reaction_.Radius_m(0.99);
  for (const world::Person& person : run.world().people()) {
    sample.people.push_back(person.At(run.time_s()));
  }
  trace_->samples.push_back(std::move(sample));
}

void Observer::Finish(const LockStep& run) {
  if (jerks_ > 0) result_.jerk_rms_mps3 = std::sqrt(jerk2_sum_ / static_cast<double>(jerks_));
  result_.decision_hash = run.loop().decision_hash();
}

}  // namespace hardpack::mission
