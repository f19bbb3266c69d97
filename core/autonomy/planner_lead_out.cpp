// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/planner.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/kinematics/kinematics.h"

// Planner: the way out of where there is no room to turn, or of where nobody has seen what there
// is.

namespace hardpack {
namespace {

// A vehicle that turns at speed swings its tail out further than its path says: it turns about a
// point ahead of its middle (odometry.turning_point_m).
constexpr float kTailLever_m = 0.6f;
// Behind and ahead of the outline nothing low is seen from the start either.
constexpr float kBehindRear_m = 1.0f;
constexpr float kAheadOfFront_m = 0.7f;
constexpr float kGoalBehind_m = 1.0f;
// The shortest way out in reverse.
constexpr float kLeastReverse_m = 0.2f;

float AlongHeading(const Pose2& from, const Pose2& to) {
  const SinCosPair heading = SinCos(from.theta_rad);
  return heading.cos * (to.x_m - from.x_m) + heading.sin * (to.y_m - from.y_m);
}

float LeftOfHeading(const Pose2& from, const Pose2& to) {
  const SinCosPair heading = SinCos(from.theta_rad);
  return heading.cos * (to.y_m - from.y_m) - heading.sin * (to.x_m - from.x_m);
}

}  // namespace

// Once in a plan, by a vehicle that stands. False: there is none to be looked for.
bool Planner::BeginLeadOut(Status failure) {
  const bool may = !led_out_ && request_.start.speed_mps == 0.0f && params_.path.lead_out_m > 0.0f;
  if (!may) return false;
  led_out_ = true;
  lead_failure_ = failure;
  looks_bent_ = !request_.has_unseen_start || !CanPivot(params_.vehicle);
  looks_across_ = false;
  looks_back_ = request_.lead_out > LeadOut::kBends;
  LookForLeadOut();
  stage_ = PlanStage::kLeadOut;
  return true;
}

// Where there is none ahead, or none that leads on. False: there is none to be looked for.
bool Planner::LookBack() {
  const bool may = !looks_back_ && lead_failure_ != Status::kOk && request_.lead_out == 0 &&
                   params_.path.reverse_out_m > 0.0f;
  if (!may) return false;
  looks_back_ = true;
  looks_bent_ = true;
  looks_across_ = false;
  lead_.Clear();
  request_.start = own_start_;
  LookForLeadOut();
  stage_ = PlanStage::kLeadOut;
  return true;
}

void Planner::LookForLeadOut() {
  if (looks_back_) {
    LookForReverse();
  } else {
    LookForForward();
  }
}

// Of what was not seen beside the map's first place as far back as ahead, if there is such a way.
void Planner::LookForReverse() {
  LeadOut::Ways ways;
  ways.reverse = true;
  ways.longest_m = params_.path.reverse_out_m;
  ways.least_m = kLeastReverse_m;
  if (request_.has_unseen_start && !looks_across_) {
    const float ahead_m = AlongHeading(request_.unseen_start, request_.start.pose);
    ways.least_m = Max(params_.path.unseen_start_m + ahead_m, kLeastReverse_m);
  }
  const bool is_tried = request_.lead_out > 0;
  if (is_tried) {
    ways.least_m = kLeastLead_m;
    ways.first_bend = ClampInt(request_.lead_out - LeadOut::kBends - 1, 0, LeadOut::kBends - 1);
    ways.end_bend = ways.first_bend + 1;
  }
  lead_out_.Begin(params_.vehicle, params_.path, request_.start.pose, PlaceAt(first_leg_), ways);
}

// For what was not seen no further than it takes; for what is in the way as far as there is one.
void Planner::LookForForward() {
  float least_m = 0.0f;
  if (request_.has_unseen_start) {
    least_m =
        Max(params_.path.unseen_start_m - AlongHeading(request_.unseen_start, request_.start.pose),
            0.0f);
  }
  const Vec2 place = PlaceAt(first_leg_);
  const Pose2 goal = {place.x_m, place.y_m, 0.0f};
  const float goal_ahead_m = AlongHeading(request_.start.pose, goal);
  const bool is_tried = request_.lead_out > 0;
  if (is_tried) least_m = Max(least_m, kLeastLead_m);
  const bool is_for_unseen = lead_failure_ == Status::kOk && !is_tried;
  const bool is_beside = is_for_unseen && Abs(goal_ahead_m) < least_m + kGoalBehind_m &&
                         Abs(LeftOfHeading(request_.start.pose, goal)) < least_m + kGoalBehind_m;
  const float longest_m = is_beside ? 0.0f : Max(params_.path.lead_out_m, least_m);
  const int first = is_tried ? ClampInt(request_.lead_out - 1, 0, LeadOut::kBends - 1) : 0;
  const int end = is_tried ? first + 1 : (looks_bent_ ? LeadOut::kBends : 1);
  lead_out_.Begin(
      params_.vehicle, params_.path, request_.start.pose, place,
      {.least_m = least_m, .longest_m = longest_m, .first_bend = first, .end_bend = end});
}

void Planner::StepLeadOut(int units) {
  if (!lead_.empty()) return StepLeadCheck(units);
  if (lead_out_.Step(costmap(), units) == Progress::kBusy) return;
  if (lead_out_.found()) {
    lead_out_.Poses(lead_);
    const Status status =
        check_.Begin(params_.vehicle, params_.optimizer, lead_, own_start_.curvature_per_m,
                     params_.path.margin_m, looks_across_ ? lead_.size() - 1 : 0);
    if (!IsUsable(status)) RefuseLead();
    return;
  }
  const bool may_bend = lead_failure_ != Status::kOk && request_.lead_out == 0;
  if (!looks_bent_ && may_bend) {
    looks_bent_ = true;
    return LookForLeadOut();
  }
  const bool is_tried = request_.lead_out > 0;
  if (!looks_across_ && (is_tried || lead_failure_ != Status::kOk)) {
    looks_across_ = true;
    looks_bent_ = looks_back_ || !request_.has_unseen_start;
    return LookForLeadOut();
  }
  if (LookBack()) return;
  // Looked for before anything else, or behind a path that is free.
  if (plan_.path.empty() && lead_failure_ == Status::kOk) return BeginSearch();
  if (lead_failure_ == Status::kOk) return BeginSpeed();
  if (!LookForMoves(lead_failure_)) End(lead_failure_);
}

// The way out by itself, from where the vehicle is: with the rest behind it it is checked again.
void Planner::StepLeadCheck(int units) {
  if (check_.Step(costmap(), lead_, units) == Progress::kBusy) return;
  if (!IsUsable(check_.result().status)) return RefuseLead();
  const float curvature_per_m = CanPivot(params_.vehicle) ? 0.0f : lead_out_.curvature_per_m();
  request_.start = {lead_.back(), curvature_per_m, 0.0f};
  BeginSearch();
}

void Planner::RefuseLead() {
  lead_.Clear();
  lead_out_.RefuseFound();
}

// Whether a pose of the path has a corner beside the place where the map began, off the strip that
// the vehicle itself stood on or drives straight ahead.
bool Planner::SweepsUnseen() const {
  const Footprint footprint = FootprintOf(params_.vehicle);
  const float aside_m = footprint.half_width_m + PathCheck::kBesideFlank_m;
  const float low_m = footprint.rear_m - kBehindRear_m;
  const float high_m = footprint.front_m + kAheadOfFront_m;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (const Pose2& pose : plan_.path) {
    const float ahead_m = AlongHeading(request_.unseen_start, pose);
    const float left_m = LeftOfHeading(request_.unseen_start, pose);
    const SinCosPair turn = SinCos(WrapAngle(pose.theta_rad - request_.unseen_start.theta_rad));
    HP_LOOP_BOUND(4)
    for (int corner = 0; corner < 4; ++corner) {
      const float x_m = corner < 2 ? footprint.front_m : footprint.rear_m - kTailLever_m;
      const float y_m = corner % 2 == 0 ? footprint.half_width_m : -footprint.half_width_m;
      const float corner_x_m = ahead_m + turn.cos * x_m - turn.sin * y_m;
      const float corner_y_m = left_m + turn.sin * x_m + turn.cos * y_m;
      const bool is_beside = corner_x_m >= low_m && corner_x_m <= high_m;
      if (is_beside && Abs(corner_y_m) > aside_m) return true;
    }
  }
  return false;
}

}  // namespace hardpack
