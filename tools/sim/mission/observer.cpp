// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/mission/observer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "port_linux/hardpackctl/code_names.h"
#include "tools/sim/world/contact.h"

namespace hardpack::mission {
namespace {

using experiment::Outcome;

constexpr double kRest_mps = 0.03;
constexpr double kSample_s = 0.05;
// The jerk is the second difference of speeds this many ticks apart: what passengers feel, not the
// step of one tick.
constexpr double kTick_s = 0.01;
constexpr size_t kJerkTicks = 5;

world::Point2 Here(const Moment& now) {
  const sim::Pose& pose = now.vehicle->vehicle().pose();
  return {pose.x_m, pose.y_m};
}

// Precondition: it is known.
WorldFromOdom FrameOf(const Moment& now) {
  return {now.vehicle->vehicle().pose(), now.pilot->odometry().pose()};
}

// Of the committed plan where the vehicle is; 0 without one.
double PlannedSpeed_mps(const Replanner& replanner) {
  const CommittedPlan& plan = replanner.committed();
  const PathPlace& place = replanner.place();
  if (plan.number == 0 || place.point + 1 >= plan.speed.size()) return 0.0;
  const double from_mps = double{plan.speed[place.point]};
  const double speed_mps =
      from_mps + double{place.share} * (double{plan.speed[place.point + 1]} - from_mps);
  return IsReversed(plan.path, place.point) ? -speed_mps : speed_mps;
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

// Contact also counts after another end, until the vehicle is at rest.
void Observer::EndBy(Outcome contact, double t_s, const std::string& text) {
  const bool touched = result_.outcome == Outcome::kContact || result_.outcome == Outcome::kPerson;
  if (ended_ && touched) return;
  Note(t_s, text);
  ended_ = true;
  result_.outcome = contact;
}

void Observer::WatchRest(const Moment& now) {
  WatchContact(now, now.time_s - start_s_);
}

void Observer::Watch(const Moment& now) {
  const double t_s = now.time_s - start_s_;
  result_.time_s = t_s;
  result_.max_speed_mps =
      std::max(result_.max_speed_mps, std::fabs(now.vehicle->vehicle().speed_mps()));
  WatchPlan(now, t_s);
  WatchMotion(now, t_s);
  WatchContact(now, t_s);
  WatchMode(now, t_s);
  Sample(now, t_s);
}

void Observer::WatchContact(const Moment& now, double t_s) {
  const sim::Pose& pose = now.vehicle->vehicle().pose();
  const double speed_mps = std::fabs(now.vehicle->vehicle().speed_mps());
  const world::Contact contact =
      world::ContactOf(now.vehicle->world(), pose.x_m, pose.y_m, pose.theta_rad, now.time_s,
                       now.vehicle->vehicle().footprint());
  clearance_m_ = std::max(0.0, contact.hard_m);
  result_.clearance_m = std::min(result_.clearance_m, clearance_m_);
  const sim::BodyOnGround* body = now.vehicle->vehicle().body();
  const bool tips = body != nullptr && body->tipping() >= 1.0;
  if (contact.hard_m < 0.0 || contact.in_ditch || contact.too_steep() || contact.grounds() ||
      tips) {
    EndBy(Outcome::kContact, t_s,
          contact.in_ditch       ? "in a ditch"
          : contact.hard_m < 0.0 ? "touched"
          : tips                 ? "rolled over"
          : contact.grounds()    ? "aground"
                                 : "too steep");
  }
  if (contact.person_m < 0.0 && speed_mps > kTouch_mps) {
    EndBy(Outcome::kPerson, t_s, "touched a person at " + std::to_string(speed_mps) + " m/s");
  }
  if (speed_mps <= kPersonSpeed_mps) return;
  result_.person_clearance_m =
      std::min(result_.person_clearance_m, std::max(0.0, contact.person_m));
}

// A path is compared with the vehicle's estimated pose: the error of that estimate is the
// odometry's (WatchOdometry).
void Observer::WatchPlan(const Moment& now, double t_s) {
  if (now.plan == plan_) return;
  const bool is_replan = plan_ != 0 && now.plan != 0;
  if (is_replan) ++result_.replans;
  plan_ = now.plan;
  path_.clear();
  if (now.plan == 0 || now.pilot == nullptr) return;
  const Replanner& replanner = now.pilot->replanner();
  const WorldFromOdom frame = FrameOf(now);
  std::vector<world::Point2> in_world;
  for (const Pose2& pose : replanner.committed().path) {
    path_.push_back({double{pose.x_m}, double{pose.y_m}});
    in_world.push_back(frame.ToWorld({pose.x_m, pose.y_m}));
  }
  result_.way.off_base_m =
      std::max(result_.way.off_base_m, OffBase_m(replanner.planner().result()));
  way_.Committed(in_world, Here(now), is_replan);
  if (trace_ != nullptr) trace_->plans.push_back({t_s, std::move(in_world)});
}

// The drift of the odometry since the goal was accepted.
void Observer::WatchOdometry(const Moment& now) {
  if (now.pilot == nullptr) return;
  if (!first_) first_ = FrameOf(now);
  const auto& odom = now.pilot->odometry().pose().position;
  const world::Point2 taken =
      first_->ToWorld({static_cast<float>(odom.x_m), static_cast<float>(odom.y_m)});
  const world::Point2 here = Here(now);
  result_.odometry_off_m =
      std::max(result_.odometry_off_m, std::hypot(taken.x_m - here.x_m, taken.y_m - here.y_m));
}

void Observer::WatchReaction(const Moment& now) {
  if (now.pilot == nullptr) return;
  const auto bins = now.pilot->reaction().time_bins();
  const bool is_fast = now.vehicle->vehicle().speed_mps() >= kFast_mps;
  reactions_.resize(bins.size());
  experiment::Histogram& fast = result_.reaction_fast_s;
  for (size_t i = 0; i < bins.size(); ++i) {
    const uint32_t more = bins[i] - reactions_[i];
    if (is_fast && more > 0) fast.Add((static_cast<double>(i) + 0.5) * fast.width(), more);
    reactions_[i] = bins[i];
  }
}

void Observer::WatchMotion(const Moment& now, double t_s) {
  const double speed_mps = now.vehicle->vehicle().speed_mps();
  speeds_mps_.push_back(speed_mps);
  if (speeds_mps_.size() > 2 * kJerkTicks) {
    constexpr double kStep_s = static_cast<double>(kJerkTicks) * kTick_s;
    const double jerk_mps3 =
        (speeds_mps_[2 * kJerkTicks] - 2.0 * speeds_mps_[kJerkTicks] + speeds_mps_[0]) /
        (kStep_s * kStep_s);
    jerk2_sum_ += jerk_mps3 * jerk_mps3;
    ++jerks_;
    speeds_mps_.pop_front();
  }
  const double rise_mps = now.vehicle->suspension().rise_mps();
  if (now.vehicle->world().has_friction() && std::fabs(speed_mps) > 0.1) {
    result_.vertical_mps2.Add((rise_mps - rise_mps_) / kTick_s);
  }
  rise_mps_ = rise_mps;
  way_.Moved(Here(now));
  WatchOdometry(now);
  WatchReaction(now);
  if (path_.size() < 2 || now.mode != Mode::kDriving) return;
  const auto& odom = now.pilot->odometry().pose().position;
  cross_track_m_ = CrossTrack_m({double{odom.x_m}, double{odom.y_m}}, path_);
  if (std::fabs(speed_mps) <= 0.1) return;
  result_.cross_track_m.Add(cross_track_m_);
  way_.Followed(t_s, cross_track_m_);
}

void Observer::WatchMode(const Moment& now, double t_s) {
  const std::string reason = ReasonName(now.reason);
  if (now.mode != mode_ || reason != said_) {
    Note(t_s, ModeName(now.mode) + (reason == "none" ? "" : ": " + reason));
    if (reason != said_ && reason != "none") ++result_.reasons[reason];
    said_ = reason;
    said_since_s_ = t_s;
  }
  mode_ = now.mode;
  if (reason != "none") result_.reason = reason;
  const bool stands = std::fabs(now.vehicle->vehicle().speed_mps()) < kRest_mps &&
                      std::fabs(now.vehicle->vehicle().yaw_rate_radps()) < kRest_mps;
  if (stands && !stands_ && drove_) ++result_.stops;
  if (stands != stands_) stands_since_s_ = t_s;
  stands_ = stands;
  drove_ = drove_ || !stands;
  if (mode_ == Mode::kFault || mode_ == Mode::kEmergencyStop) End(Outcome::kFault);
  // A stop that gives up the goal ends in the same mode.
  if (stands && mode_ == Mode::kArmed && now.goals == 0) {
    const world::Point2 here = Here(now);
    const double off_m = std::hypot(here.x_m - goal_.x_m, here.y_m - goal_.y_m);
    if (drove_) End(off_m <= kAtGoal_m ? Outcome::kReached : Outcome::kSaid);
    // There was nothing to drive. A status may be from before the goal was accepted.
    if (!drove_ && reason == "none" && off_m <= kHere_m && t_s > kAccepted_s) {
      End(Outcome::kReached);
    }
  }
  if (!stands) return;
  const double stood_s = t_s - stands_since_s_;
  if (said_ != "none" && stood_s > patience_s_ && t_s - said_since_s_ > patience_s_) {
    End(Outcome::kSaid);
  } else if (stood_s > kStuck_s + patience_s_) {
    End(Outcome::kStuck);
  }
}

void Observer::SampleInside(const Pilot& pilot, MissionTrace::Sample& sample) {
  sample.planned_mps = PlannedSpeed_mps(pilot.replanner());
  sample.commanded_curvature_per_m = pilot.tracking().curvature_per_m;
  reaction_.Add(pilot.reaction().radius_bins());
  sample.reaction_median_m = reaction_.Radius_m(0.5);
  sample.reaction_p99_m = reaction_.Radius_m(0.99);
}

void Observer::Sample(const Moment& now, double t_s) {
  if (trace_ == nullptr) return;
  if (now.pilot != nullptr) {
    maps_.Watch(*now.pilot, now.vehicle->vehicle().pose(), t_s, trace_->maps);
  }
  if (t_s < next_sample_s_) return;
  next_sample_s_ = t_s + kSample_s - 1.0e-6;
  const sim::SimVehicle& vehicle = now.vehicle->vehicle();
  MissionTrace::Sample sample;
  sample.t_s = t_s;
  sample.x_m = vehicle.pose().x_m;
  sample.y_m = vehicle.pose().y_m;
  sample.yaw_rad = vehicle.pose().theta_rad;
  sample.speed_mps = vehicle.speed_mps();
  sample.commanded_mps = now.commanded_mps;
  sample.yaw_rate_radps = vehicle.yaw_rate_radps();
  sample.commanded_yaw_radps = now.commanded_yaw_radps;
  sample.cross_track_m = cross_track_m_;
  sample.clearance_m = clearance_m_;
  sample.reaction_median_m = now.reaction_m;
  if (now.pilot != nullptr) SampleInside(*now.pilot, sample);
  const world::World& world = now.vehicle->world();
  for (size_t i = 0; i < world.people().size(); ++i) {
    sample.people.push_back(world.PersonAt(i, now.time_s));
  }
  trace_->footprint = now.vehicle->vehicle().footprint();
  trace_->samples.push_back(std::move(sample));
}

void Observer::Finish(uint64_t decision_hash) {
  if (jerks_ > 0) result_.jerk_rms_mps3 = std::sqrt(jerk2_sum_ / static_cast<double>(jerks_));
  result_.decision_hash = decision_hash;
}

}  // namespace hardpack::mission
