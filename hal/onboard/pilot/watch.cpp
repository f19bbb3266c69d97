// SPDX-License-Identifier: Apache-2.0
#include "core/base/footprint.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/base/units.h"
#include "hal/onboard/pilot/pilot.h"

// Pilot: what is looked after besides planning. Returns against the corridor of the path,
// motion against commands, why there is no way, how long it takes to react, and the gate.

namespace hardpack {
namespace {

// Beyond the corridor's reach no return matters to it, and nobody to the speeds beyond what they
// may walk while the vehicle stops.
constexpr float kBeyondReach_m = 3.0f;
// A person so near is why there is no way.
constexpr int32_t kPersonNear_cells = 25;
constexpr uint64_t kPersonNear_ns = 1'000'000'000;
// Around a return from somebody lie all others from them, and those of the next revolutions.
constexpr float kBodyReach_m = 0.8f;
constexpr float kSameLook_m = 0.1f;
// From the middle of what is seen of somebody to all that belongs to them for sure.
constexpr float kBody_m = 0.4f;
// Labels that come no more for so long are none.
constexpr uint64_t kLabelsSilent_ns = 1'000'000'000;
// Whoever was lost stands within this of where they were last seen.
constexpr int32_t kLost_cells = 3;
// What somebody leaves behind lies within this of where returns came from them.
constexpr float kLeftBehind_m = 0.6f;
// The path is looked along at so many places for the oldest look at it.
constexpr int kLooks = 5;

// As a person's body is, and nothing low.
constexpr int32_t kTall_cm = 60;
bool IsTall(PackedReturn packed) {
  const bool is_hard = packed.return_class() == ReturnClass::kHard && !packed.self();
  return is_hard && packed.range_mm() != 0 && packed.height_known() &&
         packed.height_cm() >= kTall_cm;
}

}  // namespace

Status Pilot::ConfigureSafety() {
  const VehicleParams& vehicle = config_.planner.vehicle;
  const SafetyParams& safety = config_.onboard.safety;
  corridor_.Reset();
  ConfigureSweep();
  reaction_.Reset();
  no_way_ = StopReason::kNone;
  round_tick_ = 0;
  speed_on_ground_ = config_.planner.speed;
  seen_plan_ = 0;
  seen_check_ns_ = 0;
  Status status =
      gate_.Configure({vehicle.max_wheel_speed_radps, safety.max_wheel_acceleration_radps2});
  if (IsUsable(status)) status = motion_.Configure(safety);
  return status;
}

CorridorSize Pilot::SizeOfCorridor() const {
  const VehicleParams& vehicle = config_.planner.vehicle;
  const SpeedParams& speed = config_.planner.speed;
  // Out of where there is no room to turn the way is slow, and as wide as the vehicle.
  const float margin_m = IsOnLeadOut() ? 0.0f : config_.onboard.safety.corridor_margin_m;
  return {.half_width_m = 0.5f * vehicle.width_m + margin_m,
          .pivot_radius_m = PivotRadiusOf(vehicle) + margin_m,
          .reach_m = Min(StoppingDistance(speed, speed.max_speed_mps) + FrontOf(vehicle) +
                             0.5f * vehicle.length_m,
                         Corridor::kMaxReach_m)};
}

// What the mapper has just classed. A column counts as filed when it comes, not when its labels do.
void Pilot::TestReturns(bool are_new) {
  const SpeedParams& speed = config_.planner.speed;
  const float walk_m = speed.person_speed_mps * StoppingTime(speed, speed.max_speed_mps);
  const float reach_mm = (SizeOfCorridor().reach_m + kBeyondReach_m + walk_m) *
                         static_cast<float>(kMillisecondsPerSecond);
  const auto max_range_mm = static_cast<uint32_t>(RoundToInt(reach_mm));
  HP_LOOP_BOUND(Mapper::kMaxFresh)
  for (const int16_t slot : mapper_.fresh()) {
    if (are_new && on_mission_) reaction_.Filed(mapper_.ring().column(slot).time_ns);
    TestColumn(slot, max_range_mm, are_new);
    if (are_new && MayWatchMount(slot)) WatchMount(slot);
  }
}

// Not inlined: its calls are counted (config/timing.toml).
[[gnu::noinline]] void Pilot::TestColumn(int slot, uint32_t max_range_mm, bool is_new) {
  const int beams = mapper_.model().beams;
  bool has_person = false;
  Vec2 person_odom;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int row = 0; row < beams; ++row) {
    Vec2 point_odom;
    const uint8_t flags = mapper_.ObstacleOf(slot, row, max_range_mm, point_odom);
    if ((flags & Costmap::kHard) == 0) continue;
    const bool is_person = (flags & Costmap::kPerson) != 0;
    if (is_person) person_odom = point_odom;
    has_person = has_person || is_person;
    static_cast<void>(corridor_.File(point_odom, is_person));
    sweep_.File(point_odom);
  }
  const uint64_t time_ns = mapper_.ring().column(slot).time_ns;
  if (has_person && MayLookAtPerson(person_odom)) LookAtPerson(person_odom, time_ns);
  if (is_new && !HasLabels()) LookForBody(slot, max_range_mm);
}

bool Pilot::HasLabels() const {
  return labels_ns_ != 0 && now_ns_ - labels_ns_ < kLabelsSilent_ns;
}

// Without labels, who walks is told by how they move. Not inlined: its calls are counted
// (config/timing.toml).
[[gnu::noinline]] void Pilot::LookForBody(int slot, uint32_t max_range_mm) {
  const int beams = mapper_.model().beams;
  const int step = beams > kBodyRows ? 2 : 1;
  uint32_t nearest_mm = max_range_mm;
  int nearest_row = -1;
  HP_LOOP_BOUND(kBodyRows)
  for (int row = 0; row < beams; row += step) {
    const PackedReturn packed = mapper_.ring().at(slot, row);
    const bool is_nearer = IsTall(packed) && packed.range_mm() < nearest_mm;
    nearest_mm = is_nearer ? packed.range_mm() : nearest_mm;
    nearest_row = is_nearer ? row : nearest_row;
  }
  Vec2 nearest_odom;
  const bool has_return =
      nearest_row >= 0 &&
      (mapper_.ObstacleOf(slot, nearest_row, max_range_mm, nearest_odom) & Costmap::kHard) != 0;
  const float distance_m =
      static_cast<float>(nearest_mm) / static_cast<float>(kMillisecondsPerSecond);
  Vec2 body_odom;
  if (!bodies_.Column(has_return, nearest_odom, distance_m, now_ns_, body_odom)) return;
  if (body_looks_ < kMaxBodyLooks) LookAtBody(body_odom, mapper_.ring().column(slot).time_ns);
}

// Not inlined: its calls are counted (config/timing.toml).
[[gnu::noinline]] void Pilot::LookAtBody(Vec2 body_odom, uint64_t measured_ns) {
  ++body_looks_;
  const Vec3& here = odometry_.pose().position;
  const bool moves = bodies_.Look(body_odom, now_ns_, {here.x_m, here.y_m}, mapper_.heights());
  if (!moves || person_looks_ >= kMaxPersonLooks) return;
  LookAtPerson(body_odom, measured_ns);
  mapper_.FlagPerson(body_odom, kBody_m);
}

bool Pilot::MayLookAtPerson(Vec2 person_odom) const {
  const bool is_beside =
      person_looks_ > 0 && AreWithin(person_odom, person_look_odom_, kSameLook_m);
  return !is_beside && person_looks_ < kMaxPersonLooks;
}

// Not inlined: its calls are counted (config/timing.toml).
[[gnu::noinline]] void Pilot::LookAtPerson(Vec2 person_odom, uint64_t measured_ns) {
  ++person_looks_;
  person_look_odom_ = person_odom;
  people_.Look(person_odom, now_ns_, measured_ns);
  mapper_.NotePerson(person_odom, kBodyReach_m);
}

// Somebody out of sight is no longer there if no cell is a person's any more.
void Pilot::LookForLost() {
  Vec2 place_odom;
  if (!people_.LookForLost(now_ns_, place_odom)) return;
  const Cell middle = CellAt(place_odom);
  bool is_there = false;
  HP_LOOP_BOUND(2 * kLost_cells + 1)
  for (int dy = -kLost_cells; dy <= kLost_cells; ++dy) {
    HP_LOOP_BOUND(2 * kLost_cells + 1)
    for (int dx = -kLost_cells; dx <= kLost_cells; ++dx) {
      const Cell cell = {SaturatedSum(middle.x, dx), SaturatedSum(middle.y, dy)};
      is_there = is_there || mapper_.heights().At(cell).person;
    }
  }
  if (!is_there) people_.ForgetLost();
}

void Pilot::ReleaseLeftPlace() {
  person_looks_ = 0;
  body_looks_ = 0;
  Vec2 place_odom;
  if (people_.TakeLeft(now_ns_, place_odom)) mapper_.ReleasePerson(place_odom, kLeftBehind_m);
}

// The corridor is of the plan that was checked last, whose map may lack what came while it was
// made.
void Pilot::FollowPlan() {
  const CommittedPlan& plan = replanner_.committed();
  if (plan.number == seen_plan_ && plan.checked_ns == seen_check_ns_) return;
  seen_plan_ = plan.number;
  seen_check_ns_ = plan.checked_ns;
  speed_on_ground_ = OnGround(config_.planner.speed, plan.ground);
  if (plan.number == 0) return corridor_.Clear();
  // Beside a way out of where there is no room to turn stand things that whole cells would put in
  // the way: it is the sweep that knows better where they are.
  const uint32_t since = IsOnLeadOut() ? static_cast<uint32_t>(index_) : round_tick_;
  // A path that is none has no corridor, and is not followed either.
  static_cast<void>(
      corridor_.Build(plan.path, replanner_.place().along_m, SizeOfCorridor(), since));
}

WayAhead Pilot::Ahead() const {
  if (replanner_.committed().number == 0) return WayAhead::kClear;
  const PathPlace& place = replanner_.place();
  const bool reverse = IsReversed(replanner_.committed().path, place.point);
  const float driven_mps = odometry_.speed_mps();
  return corridor_.Ahead(speed_on_ground_, config_.planner.vehicle, place.along_m,
                         reverse ? -driven_mps : driven_mps, tracker_.speed_mps(), reverse);
}

// The yaw rate about the body's z axis, of the INS's own (whose z points down).
float Pilot::MeasuredYawRate() const {
  const InsParams& mount = config_.onboard.ins;
  const SinCosPair pitch = SinCos(mount.pitch_rad);
  const SinCosPair roll = SinCos(mount.roll_rad);
  const AngularRate& rate = ins_rate_;
  return pitch.sin * rate.x_radps - pitch.cos * (roll.sin * rate.y_radps + roll.cos * rate.z_radps);
}

// Only while the drives have torque: else anybody may push the vehicle.
void Pilot::WatchMotion(const WheelFeedback& wheels) {
  const Mode mode = permission_.mode;
  const bool has_torque = mode == Mode::kArmed || mode == Mode::kDriving || mode == Mode::kSafeStop;
  if (!has_torque) {
    if (mode == Mode::kStandby) {
      motion_.Reset();
      gate_.ClearFault();
    }
    return;
  }
  static_cast<void>(motion_.Judge(SampleMotion(wheels), tick_s_));
}

MotionSample Pilot::SampleMotion(const WheelFeedback& wheels) const {
  const VehicleParams& vehicle = config_.planner.vehicle;
  const float max_age_s = config_.onboard.safety.max_ins_age_s;
  const float rim_m = vehicle.wheel_radius_m * config_.onboard.odometry.ground_per_wheel;
  const WheelCommand& told = gate_.last();
  MotionSample sample;
  sample.commanded_mps = 0.5f * (told.left_radps + told.right_radps) * rim_m;
  sample.commanded_radps = (told.right_radps - told.left_radps) * rim_m / vehicle.skid_baseline_m;
  sample.has_wheels = wheels.valid;
  sample.wheels_mps = 0.5f * (wheels.left_radps + wheels.right_radps) * rim_m;
  sample.wheels_radps = (wheels.right_radps - wheels.left_radps) * rim_m / vehicle.skid_baseline_m;
  sample.has_yaw_rate = ins_rate_ns_ != 0 && SecondsBetween(ins_rate_ns_, now_ns_) <= max_age_s;
  sample.yaw_rate_radps = MeasuredYawRate();
  sample.has_ground = ins_speed_ns_ != 0 && SecondsBetween(ins_speed_ns_, now_ns_) <= max_age_s;
  sample.ground_mps = ins_speed_mps_;
  return sample;
}

// Only where it creeps over ground that nothing has shown. After a wheel has dropped it does not
// creep before an operator, who has looked at it, arms anew.
void Pilot::WatchGround() {
  ground_drops_ = false;
  if (permission_.mode == Mode::kStandby) may_creep_ = true;
  if (permission_.mode != Mode::kDriving || !replanner_.committed().creeps) {
    ground_.Reset();
    return;
  }
  const StampedPose& here = odometry_.pose();
  ground_drops_ = ground_.Judge(here.pitch_rad, here.roll_rad, here.yaw_rad, odometry_.driven_m());
  if (ground_drops_) may_creep_ = false;
}

StopReason Pilot::Misbehaves() const {
  if (gate_.has_fault()) return StopReason::kBadCommand;
  switch (motion_.fault()) {
    case MotionFault::kRunaway:
      return StopReason::kRunaway;
    case MotionFault::kWrongTurn:
      return StopReason::kWrongTurn;
    case MotionFault::kStuck:
      return StopReason::kStuck;
    case MotionFault::kSpin:
      return StopReason::kWheelSpin;
    case MotionFault::kNone:
      break;
  }
  return StopReason::kNone;
}

bool Pilot::IsPersonNear() const {
  const Costmap& map = replanner_.planner().costmap();
  const Vec3& here = odometry_.pose().position;
  constexpr float kNear_m = static_cast<float>(kPersonNear_cells) * kCellSize_m;
  if (people_.IsAnyoneWithin({here.x_m, here.y_m}, kNear_m, now_ns_, kPersonNear_ns)) return true;
  const Cell middle = CellAt({here.x_m, here.y_m});
  const Cell low = map.window.Nearest({middle.x - kPersonNear_cells, middle.y - kPersonNear_cells});
  const Cell high =
      map.window.Nearest({middle.x + kPersonNear_cells, middle.y + kPersonNear_cells});
  HP_LOOP_BOUND(2 * kPersonNear_cells + 1)
  for (int32_t y = low.y; y <= high.y; ++y) {
    HP_LOOP_BOUND(2 * kPersonNear_cells + 1)
    for (int32_t x = low.x; x <= high.x; ++x) {
      if ((map.flags[map.window.Index({x, y})] & Costmap::kPerson) != 0) return true;
    }
  }
  return false;
}

// While the map of the round that has just been judged is still there.
void Pilot::NoteNoWay() {
  const ReplanOutcome& outcome = replanner_.outcome();
  no_way_ = StopReason::kNone;
  const bool has_map = outcome.plan_status != Status::kNotStarted;
  if (!has_map || IsUsable(outcome.plan_status) || HasPlan()) return;
  ways_out_.FoundNoPlan();
  no_way_ = IsPersonNear() ? StopReason::kPerson : StopReason::kNoWay;
  if (outcome.plan_status == Status::kGoalInObstacle) no_way_ = StopReason::kGoalInObstacle;
}

StopReason Pilot::HeldBy() const {
  if (!on_mission_ || replanner_.outcome().status == Status::kNotStarted) {
    return StopReason::kNone;
  }
  if (!HasPlan()) return no_way_;
  const ReplanOutcome& outcome = replanner_.outcome();
  if (!outcome.held) return StopReason::kNone;
  switch (outcome.held_by) {
    case CapCause::kPerson:
      return StopReason::kPerson;
    case CapCause::kSteepGround:
      return StopReason::kSteepGround;
    default:
      return StopReason::kUnseenGround;
  }
}

// How old what is known of the ground ahead will be when a plan that begins now is driven: the age
// of the oldest newest column among those that looked along the path, and what a plan takes. Where
// none did for long the vehicle stops by itself once that is as old as a look may be.
float Pilot::ReactionTime() const {
  const CommittedPlan& plan = replanner_.committed();
  if (plan.number == 0) return 0.0f;
  const Vec3& here = odometry_.pose().position;
  const float reach_m = SizeOfCorridor().reach_m;
  float oldest_s = 0.0f;
  HP_LOOP_BOUND(kLooks)
  for (int look = 1; look <= kLooks; ++look) {
    const float ahead_m = reach_m * static_cast<float>(look) / static_cast<float>(kLooks);
    const Pose2 place = StateAt(plan, replanner_.place().along_m + ahead_m).pose;
    const uint64_t seen_ns = mapper_.NewestLook_ns({place.x_m - here.x_m, place.y_m - here.y_m});
    const float age_s = seen_ns == 0
                            ? config_.onboard.safety.max_look_age_s
                            : (seen_ns < now_ns_ ? SecondsBetween(seen_ns, now_ns_) : 0.0f);
    oldest_s = Max(oldest_s, age_s);
  }
  return oldest_s + replanner_.latency_s();
}

// Around PlanOn's one step: what it began is what everything that was filed until now is in.
void Pilot::NoteRound(bool was_busy, bool is_judged) {
  if (!was_busy) {
    sweep_.MapBegun();
    round_tick_ = static_cast<uint32_t>(index_);
    reaction_.RoundBegun();
  }
  if (!is_judged) return;
  if (replanner_.outcome().plan_status != Status::kNotStarted) {
    sweep_.MapDone(replanner_.planner().costmap());
  }
  NoteNoWay();
  // A round that could not begin has checked nothing.
  if (replanner_.committed().checked_ns != seen_check_ns_) reaction_.RoundJudged();
}

// The one way to the drives.
WheelCommand Pilot::PassGate() {
  const bool may_move =
      (permission_.mode == Mode::kDriving && permission_.motion == Motion::kFollow) ||
      ((permission_.mode == Mode::kDriving || permission_.mode == Mode::kSafeStop) &&
       permission_.motion == Motion::kStopAlong);
  const WheelCommand passed = gate_.Pass(tracking_output_.wheels, may_move, tick_s_);
  if (permission_.mode == Mode::kDriving) {
    reaction_.Commanded(now_ns_, odometry_.speed_mps());
  } else {
    reaction_.Pause();
  }
  return passed;
}

}  // namespace hardpack
