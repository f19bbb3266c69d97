// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/parameters.h"
#include "core/areas/area_set.h"
#include "core/astar/astar.h"
#include "core/autonomy/lead_out.h"
#include "core/autonomy/mapper.h"
#include "core/base/decision_hash.h"
#include "core/base/progress.h"
#include "core/base/status.h"
#include "core/costmap/costmap.h"
#include "core/costmap/height_grid.h"
#include "core/manoeuvre/manoeuvre.h"
#include "core/optimizer/optimizer.h"
#include "core/path/path.h"
#include "core/path/path_smoother.h"
#include "core/path/route.h"
#include "core/safety/path_check.h"
#include "core/speed/ground_ahead.h"
#include "core/speed/speed.h"
#include "core/speed/speed_caps.h"

// The planning half of the chain: a mapper's heights and pending columns (or cells), costmap, base
// path, actuator path, optimized path, check, speeds. Resumable in units. It owns every stage and
// is the only place in core that includes them all. It plans once, from one pose to one goal; when
// to plan again, and which plan to drive, is decided elsewhere. Source: docs/algorithm.md sections
// 1 to 6, in that order.
//
// A goal at most kHere_m from the vehicle counts as reached: the plan is two points at one place,
// with a turn on the spot between them if the goal has another heading, and nothing is searched.
// Only what a turn sweeps is checked.
//
// With vias (core/path/route.h) the base path is joined from one search for each leg, in the same
// memory, and goes on from where a leg ends as long as
// - that is within pass_radius_m of its via, neither off the map nor cut, and
// - the corner there is gentle (IsGentle) for max_curvature_per_m and pass_radius_m.
// Otherwise, or where a leg has no way, the path ends before that leg, at rest. A via at most
// kHere_m from the place before it counts as passed. The optimizer is told the vias (PassingPlaces,
// with half of pass_radius_m); a path that passes one of them farther away than pass_radius_m is
// replaced by its seed, and if that does so too, is made to end there.
//
// Second attempts, each at most once:
// - The start heading is more than max_join_heading_rad off the base path: a turn on the spot
//   first, which only a standing vehicle may do.
// - The path touches something, but only within its last kMaxShort_m: it ends before that, and the
//   goal counts as moved. (The search accepts a goal with room for the vehicle's centre; the check
//   requires room for the whole vehicle.)
// - The path, optimized for preferred_curvature_rate_per_m2, touches: it is optimized again, for
//   max_curvature_rate_per_m2. If that touches too, its seed is checked instead, then the base path
//   as joined. If they touch too, and the vehicle stands and has not turned on the spot, it turns
//   first and the rest is repeated, for max_curvature_rate_per_m2 only.
// - The path to several places touches: it is made again to the first of them only.
// - There is no room to turn on the spot where the vehicle stands, or no way out of the lethal
//   region: it leads out along its heading (lead_out.h), and the rest is planned from there. The
//   check covers both, from the vehicle's position; the lead-out is driven slowly.
// - There is no such way, or no path from its end: the same in reverse, for reverse_out_m at most.
// - What holds the path up lies far ahead: it ends before that, cut (kPathCut), kMaxCuts times at
//   most.
// - All of this has failed, the vehicle stands and may reverse: what was closed is open again, and
//   it leads out in several moves (core/manoeuvre), and the rest is planned from their end. If that
//   cannot be driven either, the moves lead past the place that it touches, or end elsewhere,
//   kMaxMoves times at most.
// - The path sweeps the unseen area beside the place where the map began: the same, unseen_start_m
//   from that place, if that is free; otherwise the path is taken as it is.
// - The path touches something farther than kNearRefusal_m from where it starts and from where it
//   leads: the search has taken something for a way that is none. Its cells there are closed
//   (CostmapBuilder::Refuse), and it looks again, kMaxRefusals times at most. The next plan begins
//   on a new map, which has them open again.
//
// Areas (core/areas) close cells of the map as hard obstacles do, so that the search, the
// optimizer, the check and the speeds all see the same; speed zones limit the speeds. Their shapes
// are read during the build, as the heights are. An area without a place in odom closes nothing:
// its owner must not drive then.

namespace hardpack {

// Up to this position a cell's centre is exact in float32: 2^22 cells, 838 km.
inline constexpr float kMaxRequestPosition_m = 4194304.0f * kCellSize_m;

inline constexpr int kLeadOuts = 2 * LeadOut::kBends;

struct PlanRequest {
  PathStart start;
  Vec2 goal_odom;
  bool has_goal_heading = false;
  float goal_heading_rad = 0.0f;  // used if the path ends at the goal
  // The map began with the vehicle at unseen_start, and the vehicle is still near that place.
  bool has_unseen_start = false;
  Pose2 unseen_start = {};
  // The last plans from here began with a motion that would have touched: the path leads out, for
  // at least kLeastLead_m, by LeadOut's way with this number, if that is free: from 1 those ahead,
  // from LeadOut::kBends + 1 to kLeadOuts those in reverse. 0: no preference.
  int32_t lead_out = 0;
  // Where the lidar is, and how near to it what was not observed is dear; its reach is 0 if that is
  // not known.
  NearUnknownParams near_unknown = {};
  Route route = {};  // the way to the goal; the goal's heading is used only if the path reaches it
};

// A complete plan: everything that plan.json, the tracker and the decision hash need.
struct Plan {
  // The most severe of the stages' statuses (the largest code), or kNarrowGap if that is more
  // severe; usable only if checked free. kNotStarted while busy.
  Status status = Status::kNotStarted;
  Status base_status = Status::kNotStarted;  // of search and sampling, the more severe
  Status optimizer_status = Status::kNotStarted;
  Status check_status = Status::kNotStarted;
  bool pivots_first = false;
  bool pivots_last = false;  // the goal heading is reached by a turn on the spot
  bool stays = false;        // the goal is at the vehicle: path is a turn, or nothing
  // The start is in an obstacle: the outline overlaps a hard cell, or the axle's centre is closer
  // to one than the dilation radius. Set even if the status says something more severe.
  bool starts_in_obstacle = false;
  bool narrow = false;      // has a place with little room, see SpeedCaps
  bool is_seed = false;     // path is the seed: the optimized one would have touched
  bool ends_short = false;  // path ends before the base path, where it would have touched
  WorldPath base;           // resampled base path
  WorldPath path;           // [n] poses; with pivots_first the first two share their place, with
                            // pivots_last the last two
  ActuatorPath actuator;    // [n - 1] steps
  SpeedProfile speed;       // [n]; empty unless status is usable. The last is above 0 only if
                            // the start speed is too high to stop within the path
  // Both for the limits that the path was optimized for: the preferred ones or the final ones.
  PathCost cost_before;  // of the base path, joined to the start's heading
  PathCost cost_after;   // of path, before turns on the spot were added or it was shortened;
                         // behind a lead-out
  PathCheckResult check;
  int32_t slow_points = 0;  // first points of path, driven slowly out of an obstacle
  int32_t lead_points = 0;  // the first of these, which belong to a lead-out
  int32_t refusals = 0;     // places that the search took for a way and the check refused
  // Of all legs together: status is the gravest, cost and expansions are sums, start_in_obstacle is
  // of the first and the rest of the last leg.
  AstarResult search;
  // The path leads to this one of the places, the vias from 0 on and then the goal.
  int32_t target = 0;
};

enum class PlanStage : uint8_t {
  kIdle,
  kHeights,  // cells from heights
  kPending,  // and from columns not folded into them yet
  kCostmap,
  kSearch,
  kSample,
  kLeadOut,
  kManoeuvre,
  kOptimize,
  kCheck,
  kSpeed,
  kDone
};

class Planner {
 public:
  // Plans on the present map, including data that arrive until its cells are classed.
  // kParameterOutOfRange; kNotFinite: a number of the request; kInvalidArgument: its speed is
  // negative or above kMaxRequestSpeed_mps, its curvature beyond kCurvatureCeiling_per_m, its
  // position beyond kMaxRequestPosition_m, or an angle beyond kSinCosMaxAngle_rad; kNotStarted: the
  // mapper has received no pose or no column. In these cases nothing is started, and
  // result().status says the same.
  Status Begin(const Mapper& mapper, const PlannerParams& params, const PlanRequest& request);

  // The same on heights alone, filed by the owner of the grid.
  Status Begin(const HeightGrid& heights, const PlannerParams& params, const PlanRequest& request);

  // The same on given cells: between BeginCells and the first StepCells, call
  // costmap_builder().SetCell.
  Status BeginCells(const GridWindow& window, const PlannerParams& params,
                    const PlanRequest& request);

  // Plans again on the map of the finished plan, with what that refused open again: another start
  // or another goal.
  // kNotStarted: no plan is done; and the statuses for the request, as above. Continue with
  // StepCells; any Step works, as no cells are read.
  Status BeginOnMap(const PlanRequest& request);

  // Use the Step that matches Begin; the others assert this. Does at most `units` units of the
  // stages (see there; for pending columns a slot of the ring, for the search kSearchUnits of its
  // own, which are that much shorter than a row of the costmap), and at most kPortion_units of one
  // stage; what a stage leaves of them is lost. Between stages a unit may also join, assemble or
  // begin, which costs a few passes over the path. Before the costmap's own units one closes the
  // cells of one area in one row. kMaxUnits steps of one unit end any plan. Any split of the units
  // gives the same plan while mapper and areas are unchanged. areas: the same set, with the same
  // areas, from Begin on; null: none. Results: those of the stages, and kPivotBlocked.
  Progress Step(const Mapper& mapper, int units, const AreaSet* areas = nullptr);
  Progress Step(const HeightGrid& heights, int units, const AreaSet* areas = nullptr);
  Progress StepCells(int units, const AreaSet* areas = nullptr);

  PlanStage stage() const { return stage_; }
  const Plan& result() const { return plan_; }
  const Costmap& costmap() const { return builder_.result(); }
  const Terrain& terrain() const { return builder_.terrain(); }
  CostmapBuilder& costmap_builder() { return builder_; }

  static constexpr int kPortion_units = 64;
  // So a tick that closes cells takes no longer than one that builds the costmap (about 400
  // instructions per cell against 7,000 per row, test/instructions/counts.txt).
  static constexpr int kSearchUnits = 8;
  static constexpr float kMaxShort_m = 1.0f;
  static constexpr float kHere_m = 0.3f;  // a cell's diagonal
  static constexpr float kLeastLead_m = 0.6f;
  static constexpr float kGoalHeading_rad =
      0.05f;  // a larger error is corrected by a turn on the spot
  static constexpr int kMaxTransitions = 32;
  // From one start on the present map.
  static constexpr int kMaxLegUnits =
      AstarSearch::kMaxUnits / kSearchUnits + 1 + PathSampler::kMaxUnits;
  // The path itself; the same again once it was shortened, which it is twice at most. (Without vias
  // there is one leg, and it is never shortened.)
  static constexpr int kMaxPathUnits = kMaxTransitions + PathSmoother::kMaxPasses +
                                       3 * Optimizer::kMaxUnits + 14 * PathCheck::kMaxUnits;
  // A route whose far end cannot be driven is cut, each time nearer.
  static constexpr int kMaxCuts = 2;
  static constexpr int kMaxRouteUnits =
      (kMaxVias + 1) * kMaxLegUnits + (3 + kMaxCuts) * kMaxPathUnits;
  static constexpr int kMaxRefusals = CostmapBuilder::kMaxRefused;
  static constexpr float kNearRefusal_m = 1.5f;
  // From the vehicle, from the end of a lead-out, and again from the vehicle or from the end of one
  // in reverse; and once more for each refusal.
  // And from the vehicle for a way to lead moves to, and from the end of each of them.
  static constexpr int kMaxMoves = 8;
  static constexpr int kMaxRoutes = 4 + kMaxRefusals + kMaxMoves;
  // Looks for a lead-out: straight, bent, across cells; in reverse bent and across.
  static constexpr int kLeadLooks = 5;
  static constexpr int kAreaUnits = kMaxAreas * kMapSize_cells;
  static constexpr int kMaxUnits =
      CostmapBuilder::kUnits + ScanRing::kMaxColumns + kAreaUnits + kMaxRoutes * kMaxRouteUnits +
      kLeadLooks * (LeadOut::kBends + 1) * (LeadOut::kMaxUnits + 1) +
      (kLeadLooks * LeadOut::kBends + kMaxMoves) * PathCheck::kMaxUnits + Manoeuvre::kMaxUnits +
      kMaxMoves + SpeedCaps::kMaxUnits;

 private:
  // The source of the cells: heights and, if there is one, the mapper with pending columns.
  struct Source {
    const HeightGrid* heights = nullptr;
    const Mapper* mapper = nullptr;
    const AreaSet* areas = nullptr;
  };

  Status BeginOn(const HeightGrid& heights, const PlannerParams& params,
                 const PlanRequest& request);
  Status Started(Status status, PlanStage first);
  Status Prepare(const PlannerParams& params, const PlanRequest& request);
  Progress Run(const Source& source, int units);
  void StepStage(const Source& source, int units);
  void StepHeights(const Source& source, int units);
  void StepPending(const Source& source, int units);
  void StepCostmap(const Source& source, int units);
  void CloseAreas(const AreaSet& areas, int units);
  void StepSearch(int units);
  void KeepSearch();
  Status BeginSample();
  void StepSample(int units);
  void StepSampler(int units);
  void StepLeadOut(int units);
  void StepManoeuvre(int units);
  void StepOptimize(int units);
  void StepCheck(int units);
  void StepSpeed(const Source& source, int units);

  void BeginSearch();
  void BeginLeg(Vec2 from_odom);
  Vec2 PlaceAt(int target) const;
  void KeepLeg();
  [[nodiscard]] bool MayLeadOn() const;
  [[nodiscard]] bool NextLeg();
  Vec2 DirectionAtEnd() const;
  bool AppendLeg();
  void EndLegs();
  void BeginSmoothing();
  [[nodiscard]] bool Shorten(int target);
  int FirstMissed() const;
  PassingPlaces Places() const;
  bool IsHere() const;
  void Stay();
  [[nodiscard]] bool MayPivot() const;
  [[nodiscard]] bool BeginLeadOut(Status failure);
  [[nodiscard]] bool LookBack();
  [[nodiscard]] bool LookElsewhere();
  void LookForLeadOut();
  void LookForForward();
  void LookForReverse();
  bool EndsReverse() const;
  bool SweepsUnseen() const;
  void StepLeadCheck(int units);
  void RefuseLead();
  [[nodiscard]] bool MayMove(Status failure) const;
  [[nodiscard]] bool LookForMoves(Status failure);
  void NoteBlocked();
  float SharpestCurvature() const;
  [[nodiscard]] bool CutBase();
  void BeginWay();
  void BeginFromGoal();
  void EndWay();
  [[nodiscard]] bool BeginManoeuvre();
  void RefuseMoves();
  void BeginPath();
  void BeginSpeed();
  void BeginSeed();
  OptimizerParams CostParams() const;
  [[nodiscard]] bool MakeSeed(const WorldPath& base);
  PathCost SeedCost() const;
  float StartCurvature() const;
  void MakePath(const WorldPath& driven);
  Status StartCheck();
  void BeginCheck();
  void TryAgain();
  bool MayEndShort() const;
  void EndShort();
  int SlowPoints() const;
  void Finish();
  void Fail(Status status);
  void End(Status status);

  PlanStage stage_ = PlanStage::kIdle;
  uint32_t folded_before_ = 0;  // columns, when this plan began
  int32_t pending_slot_ = 0;    // next
  int32_t area_ = 0;            // next to close cells ...
  int32_t area_row_ = 0;        // ... and of its rows, from its first
  bool keeps_end_heading_ = false;
  bool has_goal_heading_ = false;  // and the path ends at the goal
  PlannerParams params_;
  PlanRequest request_;
  Plan plan_;
  WorldPath seed_;
  WorldPath lead_;       // from the vehicle; empty if none
  PathStart own_start_;  // of the request, before lead_ replaced it
  LeadOut lead_out_;
  Manoeuvre manoeuvre_;
  bool led_out_ = false;       // a lead-out was searched
  bool looks_bent_ = false;    // the lead-out may be bent
  bool looks_back_ = false;    // in reverse
  bool looks_across_ = false;  // and cells may overlap its flanks
  // A way out in several moves: not looked for; due, once what was refused is open again; a way
  // that tells where to lead to; how they begin; and they are looked for, checked, or followed by
  // the rest.
  enum class Moves : uint8_t { kNone, kDue, kWay, kBegin, kSearch };
  Moves moves_ = Moves::kNone;
  int32_t moves_refused_ = 0;
  int32_t cuts_ = 0;          // of the present route
  bool from_goal_ = false;    // no way leads out: search_ is to tell where one would come in
  bool has_blocked_ = false;  // where what was planned without them touches
  Vec2 blocked_odom_;
  Vec2 first_refused_odom_;
  Status lead_failure_ = Status::kNotStarted;  // status without one; kOk: continues
  CostmapBuilder builder_;
  AstarSearch search_;
  PathSampler sampler_;
  bool sampled_ = false;  // and the smoother has begun
  // A leg that is part of the base path: where it ends there, and the search up to there. Not an
  // AstarResult, which is copied as a block, by a loop that no bound is recorded for.
  struct Leg {
    int32_t end_point = 0;
    Status status = Status::kNotStarted;
    bool goal_moved = false;
    Cell goal;
    Cell end;
    int32_t path_cells = 0;
    int64_t cost = 0;
    int32_t expansions = 0;
  };
  // The first that was searched, and the present one.
  int32_t first_leg_ = 0;
  int32_t leg_ = 0;
  Vec2 leg_from_;  // where it begins
  Leg legs_[kMaxVias + 1];
  Status sample_status_ = Status::kNotStarted;  // of the last one's sampler
  bool shortened_ = false;
  PathSmoother smoother_;
  bool seed_is_smooth_ = false;
  bool is_gentle_ = false;   // optimized for the preferred curvature rate
  bool is_to_seed_ = false;  // BeginSeed is due
  Optimizer optimizer_;
  PathCheck check_;
  SpeedParams speed_params_;  // on the path's ground
  SpeedCaps caps_;
};
static_assert(std::is_trivially_copyable_v<Planner>);

// Planning as a whole: heights, costs, search, paths.
inline constexpr int kPlanningBudget_bytes = 34 * 256 * 1024;  // 8.5 MiB
static_assert(sizeof(Planner) + sizeof(HeightGrid) <= kPlanningBudget_bytes);

// Every parameter in range and mutually consistent as plans need it (config/conflicts.h): kOk or
// kParameterOutOfRange.
Status CheckPlannerParams(const PlannerParams& params);

// Adds every decision of a plan, field by field; target only if it is not 0.
void AddToHash(const Plan& plan, DecisionHash& hash);

}  // namespace hardpack
