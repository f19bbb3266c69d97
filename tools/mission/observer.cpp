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

double Distance_m(world::Point2 a, world::Point2 b) {
  return std::sqrt((a.x_m - b.x_m) * (a.x_m - b.x_m) + (a.y_m - b.y_m) * (a.y_m - b.y_m));
}

// Of a point to a chord, with the place of the nearest one on it.
double ToChord_m(world::Point2 p, world::Point2 from, world::Point2 to, double& share) {
  const double dx = to.x_m - from.x_m;
  const double dy = to.y_m - from.y_m;
  const double length2 = dx * dx + dy * dy;
  share = length2 > 0.0 ? ((p.x_m - from.x_m) * dx + (p.y_m - from.y_m) * dy) / length2 : 0.0;
  share = std::clamp(share, 0.0, 1.0);
  return Distance_m(p, {from.x_m + share * dx, from.y_m + share * dy});
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

// Contact counts after another end too, on the way to rest.
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
  WatchMotion(now);
  WatchContact(now, t_s);
  WatchMode(now, t_s);
  Sample(now, t_s);
}

void Observer::WatchContact(const Moment& now, double t_s) {
  const sim::Pose& pose = now.vehicle->vehicle().pose();
  const double speed_mps = std::fabs(now.vehicle->vehicle().speed_mps());
  const world::Contact contact =
      world::ContactOf(now.vehicle->world(), pose.x_m, pose.y_m, pose.theta_rad, now.time_s);
  result_.clearance_m = std::min(result_.clearance_m, std::max(0.0, contact.hard_m));
  if (contact.hard_m < 0.0 || contact.in_ditch || contact.too_steep()) {
    EndBy(Outcome::kContact, t_s,
          contact.in_ditch       ? "in a ditch"
          : contact.hard_m < 0.0 ? "touched"
                                 : "too steep");
  }
  if (speed_mps <= kPersonSpeed_mps) return;
  result_.person_clearance_m =
      std::min(result_.person_clearance_m, std::max(0.0, contact.person_m));
  if (contact.person_m < 0.0) {
    EndBy(Outcome::kPerson, t_s, "touched a person at " + std::to_string(speed_mps) + " m/s");
  }
}

// A path is held against where the vehicle is in truth; it lies where the odometry was when it was
// committed.
void Observer::WatchPlan(const Moment& now, double t_s) {
  if (now.plan == plan_) return;
  if (plan_ != 0 && now.plan != 0) ++result_.replans;
  plan_ = now.plan;
  path_.clear();
  if (now.plan == 0 || now.committed == nullptr) return;
  const WorldFromOdom frame(now.vehicle->vehicle().pose(), now.odometry);
  for (const Pose2& pose : now.committed->path)
    path_.push_back(frame.ToWorld({pose.x_m, pose.y_m}));
  if (trace_ != nullptr) trace_->plans.push_back({t_s, path_});
}

double Observer::CrossTrack_m(const sim::Pose& pose) const {
  double least_m = INFINITY;
  double share = 0.0;
  const world::Point2 here = {pose.x_m, pose.y_m};
  for (size_t i = 0; i + 1 < path_.size(); ++i) {
    least_m = std::min(least_m, ToChord_m(here, path_[i], path_[i + 1], share));
  }
  return least_m;
}

void Observer::WatchMotion(const Moment& now) {
  const double speed_mps = now.vehicle->vehicle().speed_mps();
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
  if (path_.size() < 2 || now.mode != Mode::kDriving) return;
  cross_track_m_ = CrossTrack_m(now.vehicle->vehicle().pose());
  if (std::fabs(speed_mps) > 0.1) result_.cross_track_m.Add(cross_track_m_);
}

void Observer::WatchMode(const Moment& now, double t_s) {
  const std::string reason = ReasonName(now.reason);
  if (now.mode != mode_ || reason != said_) {
    Note(t_s, ModeName(now.mode) + (reason == "none" ? "" : ": " + reason));
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
  if (drove_ && stands && mode_ == Mode::kArmed && now.goals == 0) {
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

void Observer::Sample(const Moment& now, double t_s) {
  if (trace_ == nullptr || t_s < next_sample_s_) return;
  next_sample_s_ = t_s + kSample_s - 1.0e-6;
  const sim::SimVehicle& vehicle = now.vehicle->vehicle();
  trace_->samples.push_back({t_s, vehicle.pose().x_m, vehicle.pose().y_m, vehicle.pose().theta_rad,
                             vehicle.speed_mps(), now.planned_mps, vehicle.yaw_rate_radps(),
                             now.commanded_yaw_radps, cross_track_m_, now.reaction_m});
}

void Observer::Finish(uint64_t decision_hash) {
  if (jerks_ > 0) result_.jerk_rms_mps3 = std::sqrt(jerk2_sum_ / static_cast<double>(jerks_));
  result_.decision_hash = decision_hash;
}

}  // namespace hardpack::mission
