// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/parameters.h"
#include "core/autonomy/planner.h"
#include "core/base/decision_hash.h"
#include "core/base/progress.h"
#include "core/base/status.h"
#include "core/committed_plan/committed_plan.h"
#include "core/safety/path_check.h"
#include "core/speed/speed_caps.h"

// When to plan again, and which plan to drive. Owns a Planner and the committed plan. It reads no
// clock, measures nothing and commands nothing; time comes in with Update. Ours; the paper only
// says that it replans at 4 to 10 Hz ([OS] Experiments). docs/algorithm.md sections 3, 6 and 8.
//
//        v vehicle (predicted)     A anchor                            E end
//   -----o------------------------>o---------------------------------->o     committed path
//        |---- kept stretch ------> \____                          __/
//                                        \___ new plan ___________/
//
// One round, begun as soon as the previous one was evaluated:
// 1. Anchor. The predicted pose is projected onto the committed path. The new plan starts on that
//    path, with its pose, curvature and speed, at the first point beyond the stretch that is driven
//    during the round: min_latency_s, or 1.5 times the longest of the last rounds (their length in
//    the owner's time, so the same in replay), and no closer to the place where the map began than
//    unseen_start_m. The result is kept stretch + new plan. It starts from the predicted pose
//    itself if there is no committed plan, if the vehicle is farther beside it than there is room
//    there (max_cross_track_m at most, least_cross_track_m at least), or turned away from it by
//    more than max_join_heading_rad (at rest kMaxStandingOff_m and kMaxStandingTurn_rad), or if it
//    stands at the path's end, at a turn on the spot or on a path that was cut to a stop.
// 2. The new plan, on the present map.
// 3. The rest of the committed path, from the vehicle's projection on, is checked on that map, with
//    path.kept_margin_m around the outline: the allowance for tracking error. It is less than a new
//    plan's path.margin_m, because an object in a hard square may be anywhere in it, and in a gap
//    that is just wide enough its edge moves by a cell with every build. Meanwhile each return
//    itself is tested against the corridor (core/safety/corridor.h).
// 4. If the ends differ, costs cannot be compared. So the committed path is extended: its rest up
//    to a point B, and a second plan from B to the goal on the same map.
//    - Its rest is free and ends short of the goal (which is off the map, or farther than a path is
//      long), and the new plan reaches it or gets extend_m closer: B is kTail_m before its end,
//      because the last stretch was bent toward a temporary end point.
//    - Its rest is blocked more than kFarBlock_m beyond the anchor: B is half way to the block.
//      Distant changes do not affect the side on which the next obstacle is passed.
//    - In its last kTail_m it is not extended: the new plan itself is the extension.
// 5. Decision, on that one map, from the anchor on. F is the optimizer's cost (CostOf). If both end
//    at the same place (kSameEnd_m), the new plan is clearly cheaper where
//      F(committed) - F(new) > max(cheaper_share F(committed), cheaper_floor).
//    If they do not, because one is cut at the capacity of a path, the same test is applied to the
//    whole way to the search's end: length + F_map of the committed stretch + cost of the search
//    from B, against the cost of the new plan's search. If there is no common end at all, it is not
//    cheaper.
//    The shares are there to keep the vehicle on the side on which it passes an obstacle. A new
//    plan that ends at the same place and is nowhere farther away than the vehicle is wide has no
//    obstacle between: kSameWayShare and kSameWayFloor are enough for it. So what was planned with
//    less in view does not stay.
//      no committed plan, or the vehicle is off it, or the goal has changed, or the committed plan
//      was a stop, or its rest is blocked or too short and cannot be extended, or the new plan is
//      clearly cheaper                               the new plan replaces it
//      its rest is free or was extended              it is kept, with the extension
//      neither is possible                           it is cut to come to rest as soon as it can,
//                                                    within what was checked free, and the
//                                                    outcome says kStop: the owner stops
// 6. Speeds. Whatever is driven from now on gets new speeds on this map, from the state at the
//    moment of publication.
// A goal with vias (core/path/route.h) has not changed as long as the committed path leads to one
// of its places and passes those before it, so that it is kept when the vehicle has passed one. A
// path that ends at one of them, at rest, ends short of the goal if the new plan leads to a later
// one. The new plan and an extension lead by those vias only that the committed path does not pass
// before they begin. Speeds keep the limits of the legs.
//
// A stretch in reverse is driven to its end: a new plan starts there, and none that starts from a
// vehicle in reverse is used.
//
// A new plan that arrives after the vehicle has passed its anchor is not used (counted as late),
// and the next anchor is farther ahead. A plan that could not come to rest within its length from
// the present speed is not used either.

namespace hardpack {

// The predicted vehicle, including dead time, when a command given now takes effect.
struct VehicleState {
  Pose2 pose;  // odom
  float curvature_per_m = 0.0f;
  // A magnitude. With lagging drives, the speed commanded by then: a plan that starts from the
  // lagging speed would never let it accelerate.
  float speed_mps = 0.0f;
  float driven_mps = 0.0f;  // actual speed, including lag; in reverse: negative
  // Age that the knowledge of the ground ahead will have when a plan made now is driven. If it
  // exceeds SpeedParams::reaction_time_s, speeds are computed for it.
  float reaction_s = 0.0f;
  // How fast its wheels follow a turn, relative to the parameters. A slower vehicle is farther
  // beside its path in a bend: where there is little room it gets proportionally less of
  // SpeedParams::max_curvature_rate_per_s2, down to Replanner::kLeastQuickness; a quicker one gets
  // no more.
  float turn_quickness = 1.0f;
  Lookouts lookouts = {};
  bool has_unseen_start = false;  // see PlanRequest
  Pose2 unseen_start = {};
  int32_t lead_out = 0;
};

// For an owner without a history of commands: the state after ahead_s at constant speed and
// curvature.
VehicleState PredictAhead(const VehicleState& state, float ahead_s);

enum class ReplanDecision : uint8_t {
  kNone,      // nothing is committed: no plan
  kKept,      // the committed path is kept, with new speeds
  kExtended,  // the same, and extended
  kReplaced,
  kStop,  // the committed path is blocked, obsolete or left, with no alternative: stop
};

enum class ReplanReason : uint8_t {
  kNone,
  kFirst,        // nothing was committed
  kOffPath,      // the vehicle is too far from it
  kGoalChanged,  // it leads to another goal
  kAfterStop,    // it had been cut to a stop
  kBlocked,      // the blocked part was replaced, far ahead or entirely
  kEnds,         // it ends short of the goal and cannot be extended
  kCheaper,      // the new one is clearly cheaper
};
inline constexpr int kReplanReasons = 8;

// The result of the last round.
struct ReplanOutcome {
  ReplanDecision decision = ReplanDecision::kNone;
  ReplanReason reason = ReplanReason::kNone;
  // Usable: drive the committed plan, with any restriction it states. kCollision: it is blocked,
  // and no plan leads around; otherwise why there is no plan (the new plan's status).
  Status status = Status::kNotStarted;
  Status plan_status = Status::kNotStarted;  // of the new plan, used or not
  bool anchored = false;                     // the new plan started on the committed path ...
  bool late = false;                         // ... and arrived too late to be used
  // Whether the vehicle must hold where it is, and why: the committed plan says so, short of its
  // end, or it drives kTooFast_mps faster than a person allows, too fast for any ramp.
  bool held = false;
  CapCause held_by = CapCause::kPathEnd;
  float committed_cost = 0.0f;  // as compared; 0 if not compared
  float new_cost = 0.0f;
};

struct ReplanCounters {
  uint32_t plans = 0;  // rounds evaluated
  uint32_t kept = 0;
  uint32_t extended = 0;
  uint32_t replaced[kReplanReasons] = {};  // by reason; kBlocked includes extended paths
  uint32_t stopped = 0;
  uint32_t failed = 0;      // new plans that were not usable
  uint32_t reanchored = 0;  // rounds that found the vehicle off the path
  uint32_t late = 0;
  uint32_t refused = 0;  // Updates
};

class Replanner {
 public:
  // Drops everything. kParameterOutOfRange: nothing changes.
  Status Configure(const PlannerParams& params);

  // Drops the committed plan, the round in progress and the newest state, for example after a jump
  // of the odometry or of the clock. The next round needs an Update.
  void Forget();

  // Every tick. kInvalidArgument: time runs backwards, a speed is below -kStanding_mps or above
  // kMaxRequestSpeed_mps, a number is beyond PlanRequest's limits, or the goal's number is below
  // that of its vias; kNotFinite. In these cases only counters().refused changes. walkers: the
  // people near the vehicle, for the speeds; null: those that the map's cells tell of. Cost: one
  // pass over the committed path.
  Status Update(uint64_t now_ns, const VehicleState& state, const PlanGoal& goal,
                const Walkers* walkers = nullptr);

  // At most `units` units of the stages, as Planner::Step. Ends with the round, so that the owner
  // sees each one. Begins a round if none is in progress. kDone: a round has been evaluated, or
  // none could begin, and outcome() is new. kMaxUnits steps of one unit end any round. Any split of
  // the units gives the same outcome while map, areas and state are unchanged. areas: as for
  // Planner::Step; Forget before other ones are used.
  Progress Step(const Mapper& mapper, int units, const AreaSet* areas = nullptr);
  Progress Step(const HeightGrid& heights, int units, const AreaSet* areas = nullptr);

  // The same on given cells: BeginCells begins the round (kNotStarted: no state yet), then SetCell
  // on costmap_builder(), then StepCells until done. Failures of Begin are outcomes.
  Status BeginCells(const GridWindow& window);
  Progress StepCells(int units, const AreaSet* areas = nullptr);
  CostmapBuilder& costmap_builder() { return planner_.costmap_builder(); }

  const CommittedPlan& committed() const { return committed_; }
  const ReplanOutcome& outcome() const { return outcome_; }
  const ReplanCounters& counters() const { return counters_; }
  // Of the newest state on the committed path.
  const PathPlace& place() const { return place_; }
  bool busy() const { return phase_ != Phase::kIdle; }
  float latency_s() const { return latency_s_; }  // assumed for the next round
  // The last plan made, and its map.
  const Planner& planner() const { return planner_; }

  static constexpr float kWayCostPerMeter = kStraightLength * kCellsPerMeter;
  static constexpr float kStanding_mps = SpeedCaps::kStanding_mps;
  static constexpr float kTooFast_mps = 0.3f;
  // Off the path at rest, for example after an immediate stop: joining it from there would turn
  // through unchecked space.
  static constexpr float kMaxStandingOff_m = 0.15f;
  static constexpr float kMaxStandingTurn_rad = 0.3f;
  static constexpr float kSameEnd_m = 0.3f;  // a cell's diagonal
  static constexpr float kTail_m = 9.0f;
  static constexpr float kFarBlock_m = 10.0f;
  static constexpr float kNearerEnd_m = 0.5f;  // in the last kTail_m
  static constexpr float kSameWayShare = 0.1f;
  static constexpr float kSameWayFloor = 0.5f;
  // Effect of a slow turn: full up to this room, none from this room on, in the next so many
  // metres.
  static constexpr float kNoRoomToTurnLate_m = 1.2f;
  static constexpr float kRoomToTurnLate_m = 2.0f;
  static constexpr float kTurnsAhead_m = 6.0f;
  static constexpr float kLeastQuickness = 0.1f;
  static constexpr int kMaxUnits = 2 * Planner::kMaxUnits + PathCheck::kMaxUnits +
                                   3 * SpeedCaps::kMaxUnits + 4 * Planner::kPortion_units;

 private:
  enum class Phase : uint8_t { kIdle, kPlan, kCheck, kExtend, kSpeed };

  // A usable plan: what is still needed once the planner makes another.
  struct Fresh {
    Status status = Status::kNotStarted;
    WorldPath path;
    int32_t slow_points = 0;
    int32_t lead_points = 0;
    Cell search_end;
    PlanGoal goal;          // the place that it leads to, and the way there
    Vec2 end_odom;          // of the search: the path's end unless it was cut
    float way_cost = 0.0f;  // of the search, in metres at cost 0
  };

  // The next committed path, before its speeds.
  struct Candidate {
    ReplanDecision decision = ReplanDecision::kNone;
    ReplanReason reason = ReplanReason::kNone;
    Status status = Status::kNotStarted;
    WorldPath path;
    float start_curvature_per_m = 0.0f;
    float start_turn_rad = 0.0f;
    int32_t slow_points = 0;
    int32_t lead_points = 0;
    PlanGoal goal;       // the place that it leads to
    int32_t joint = -1;  // point of rest_ where it leaves the committed path; -1: none
    GroundAhead ground;  // along the path
  };

  template <typename StepPlanner>
  Progress Run(StepPlanner&& step_planner, int units, const AreaSet* areas);
  // core/autonomy/replanner.cpp: the phases of a round.
  bool Stands() const { return state_.speed_mps <= kStanding_mps; }
  bool BacksUp() const { return !Stands() && state_.driven_mps < 0.0f; }
  bool IsAt(int point) const;  // of the committed path, or beyond it
  bool MayBegin();
  void ChooseAnchor();
  int PointBehindStretch(int standing) const;
  bool IsBesideUnseen(const Pose2& pose) const;
  void FillRequest(const PathStart& start, int passed, PlanRequest& request) const;
  float PassReach_m() const { return params_.replan.pass_radius_m + kPassSlack_m; }
  PlanGoal PlannedGoal(int passed) const;
  void Begun(Status status);
  void StepOwn(int units, const AreaSet* areas);
  void EndPlan();
  void KeepFresh();
  void BeginCheck();
  void StepCheck(int units);
  void BeginExtension();
  void LimitLegs();
  float MostCrossTrack() const;
  float ReachOfRound() const;
  void EndRound();
  void Locate(float since_s);

  // core/autonomy/replanner_judge.cpp: its result.
  int AnchorOfRest() const;
  int ExtensionPoint();
  bool EndCouldBeNearer(int anchor) const;
  void Decide();
  bool IsSameWay() const;
  void CompareCosts();
  bool ExtensionIsUsable() const;
  bool FreshIsUsable() const;
  bool RestIsFree() const { return free_until_ + 1 >= rest_.size(); }
  bool GoalHasChanged() const;
  bool PassesVias() const;
  ReplanDecision Choose(ReplanReason& reason) const;
  ReplanDecision ChooseOnPath(ReplanReason& reason) const;
  void MakeCandidate(ReplanDecision decision, ReplanReason reason);
  void TakeFresh();
  void Join(int first, int last, const WorldPath* tail);
  int LastRoomyPoint() const;
  int StopPoint() const;
  bool ComesToRest() const;

  // core/autonomy/replanner_publish.cpp: the plan driven from now on.
  void Publish();
  void DropAll();
  Status StopStatus() const;
  bool HasPassedJoint() const;
  void Commit(const PathPlace& place);
  float TurnShare(int behind) const;
  Status TimeFrom(const PathPlace& place);

  PlannerParams params_;
  // Those of params_ on the candidate's ground, with the reaction time of this round.
  SpeedParams caps_params_;
  bool configured_ = false;
  bool has_state_ = false;
  uint64_t now_ns_ = 0;
  VehicleState state_;
  Walkers walkers_;
  bool has_walkers_ = false;
  PlanGoal goal_;
  float latency_s_ = 0.0f;
  float longest_s_ = 0.0f;  // round, fading

  CommittedPlan committed_;
  uint32_t last_number_ = 0;  // of a committed plan
  PathPlace place_;
  bool off_path_ = false;  // the newest state

  // The round.
  Phase phase_ = Phase::kIdle;
  ReplanOutcome round_;  // its result
  uint64_t begun_ns_ = 0;
  PlanGoal round_goal_;
  bool anchored_ = false;
  bool left_path_ = false;  // the vehicle was off the path when it began ...
  bool backed_up_ = false;  // ... or drove in reverse
  bool late_ = false;
  PlanRequest request_;
  int32_t passed_ = 0;                   // vias of the round before the new plan's start ...
  int32_t passed_before_extension_ = 0;  // ... and before B
  int32_t anchor_ = 0;                   // point of the committed path; where anchored
  int32_t dropped_ = 0;                  // points of the committed path before rest_
  WorldPath rest_;                       // of the committed path: empty without one
  float rest_curvature_per_m_ = 0.0f;
  float rest_turn_rad_ = 0.0f;
  int32_t free_until_ = -1;  // last point of rest_ that was checked free
  Fresh fresh_;
  int32_t extension_point_ = -1;  // B, of rest_; -1: none was planned
  bool ends_short_ = false;       // the committed path should be extended if possible
  bool is_cheaper_ = false;       // the new plan is clearly cheaper
  Candidate candidate_;
  ActuatorPath timed_;  // as driven from the vehicle's place on

  Planner planner_;
  PathCheck check_;
  SpeedCaps caps_;
  ReplanOutcome outcome_;
  ReplanCounters counters_;
};
static_assert(std::is_trivially_copyable_v<Replanner>);
static_assert(sizeof(Replanner) - sizeof(Planner) <= 40 * 1024);
static_assert(sizeof(Replanner) + sizeof(HeightGrid) <= kPlanningBudget_bytes);

// Adds the committed plan, the outcome and the counters.
void AddToHash(const Replanner& replanner, DecisionHash& hash);

}  // namespace hardpack
