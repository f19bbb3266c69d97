// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/parameters.h"
#include "core/astar/astar.h"
#include "core/autonomy/lead_out.h"
#include "core/autonomy/mapper.h"
#include "core/base/decision_hash.h"
#include "core/base/progress.h"
#include "core/base/status.h"
#include "core/costmap/costmap.h"
#include "core/costmap/height_grid.h"
#include "core/optimizer/optimizer.h"
#include "core/path/path.h"
#include "core/path/path_smoother.h"
#include "core/safety/path_check.h"
#include "core/speed/speed.h"
#include "core/speed/speed_caps.h"

// The planning half of the chain: a mapper's heights and pending columns (or cells), costmap, base
// path, actuator path, optimized path, check, speeds. Resumable by units; owns every stage; the one
// place in core that sees them all. It plans once, from one pose to one goal; when to plan again,
// and which plan to drive, is not decided here. Source: docs/algorithm.md sections 1 to 6, in that
// order.
//
// A goal at most kHere_m from where the vehicle stands is where it is: the plan is two points at
// one place, with a turn on the spot between them where the goal has another heading, and nothing
// is searched for. Only what a turn sweeps is checked.
//
// Second tries, each at most once:
// - The start heading is more than max_join_heading_rad off the base path: a turn on the spot
//   first, which only a vehicle that stands may do.
// - The path touches something, but within its last kMaxShort_m only: it ends before that, and the
//   goal counts as moved. (The search takes a goal that has room for the vehicle's middle; the
//   check asks for the whole vehicle.)
// - The path, optimized for preferred_curvature_rate_per_m2, touches: it is optimized again, for
//   max_curvature_rate_per_m2. If that touches too, its seed is checked in its place, then the base
//   path as joined. If they touch too, and the vehicle stands and has not turned on the spot, it
//   turns first and the rest is done again, for max_curvature_rate_per_m2 alone.
// - There is no room to turn on the spot where the vehicle stands, or no way at all out of what is
//   too near: it leads out along its heading (lead_out.h), and all the rest is planned from there.
//   The check is of both, from where the vehicle stands; the lead-out is driven slowly.
// - The path sweeps what stands beside the place where the map began, which nobody has seen: the
//   same, unseen_start_m from that place, if that is free; else the path is taken as it is.

namespace hardpack {

// Up to here a cell's centre is exact in float32: 2^22 cells, 838 km.
inline constexpr float kMaxRequestPosition_m = 4194304.0f * kCellSize_m;

struct PlanRequest {
  PathStart start;
  Vec2 goal_odom;
  bool has_goal_heading = false;
  float goal_heading_rad = 0.0f;  // where the path ends at the goal; else it has no effect
  // The map began while the vehicle was at unseen_start, and it is near that place still.
  bool has_unseen_start = false;
  Pose2 unseen_start = {};
  // The last plans from here began with a motion that would have touched: the path leads out of it,
  // at least kLeastLead_m, by the one of LeadOut's ways with this number, from 1 on, if that is
  // free. 0: as it comes.
  int32_t lead_out = 0;
};

// What is planned: everything that plan.json, the tracker and the decision hash need.
struct Plan {
  // The gravest of the stages' (the largest code), or kNarrowGap where that is graver; usable only
  // if checked free. kNotStarted while busy.
  Status status = Status::kNotStarted;
  Status base_status = Status::kNotStarted;  // of search and sampling, the graver
  Status optimizer_status = Status::kNotStarted;
  Status check_status = Status::kNotStarted;
  bool pivots_first = false;
  bool pivots_last = false;  // the goal heading is reached by a turn on the spot
  bool stays = false;        // the goal is where the vehicle stands: path is a turn, or nothing
  // The start is in an obstacle: the outline overlaps a hard cell, or the axle's centre is nearer
  // to one than obstacles are dilated. Whatever graver thing the status says.
  bool starts_in_obstacle = false;
  bool narrow = false;      // somewhere with little room, see SpeedCaps
  bool is_seed = false;     // path is the seed: the optimized one would have touched
  bool ends_short = false;  // path ends before the base path does: there it would have touched
  WorldPath base;           // resampled base path
  WorldPath path;           // [n] poses; with pivots_first the first two share their place, with
                            // pivots_last the last two
  ActuatorPath actuator;    // [n - 1] steps
  SpeedProfile speed;  // [n]; empty unless status is usable. The last one is above 0 only where
                       // the start speed is too high to stop within the path
  // Both at the limits that the path was optimized for: the preferred ones or the last.
  PathCost cost_before;  // of the base path, joined to the start's heading
  PathCost cost_after;  // of path, before turns on the spot were added or it was made to end short;
                        // behind a lead-out
  PathCheckResult check;
  int32_t slow_points = 0;  // first points of path that are driven slowly, out of an obstacle
  int32_t lead_points = 0;  // of these the first that lead out of where there is no room to turn
  AstarResult search;
};

enum class PlanStage : uint8_t {
  kIdle,
  kHeights,  // cells from heights
  kPending,  // and from columns that are not in them yet
  kCostmap,
  kSearch,
  kSample,
  kLeadOut,
  kOptimize,
  kCheck,
  kSpeed,
  kDone
};

class Planner {
 public:
  // On the map as it is, and with what comes into it until its cells are classed.
  // kParameterOutOfRange; kNotFinite: a number of the request; kInvalidArgument: its speed is
  // negative or above kMaxRequestSpeed_mps, its curvature beyond kCurvatureCeiling_per_m, its place
  // beyond kMaxRequestPosition_m, or an angle beyond kSinCosMaxAngle_rad; kNotStarted: no pose or
  // no column has come to the mapper. Then nothing is started, and result().status says the same.
  Status Begin(const Mapper& mapper, const PlannerParams& params, const PlanRequest& request);

  // The same on heights alone, filed by whoever owns the grid.
  Status Begin(const HeightGrid& heights, const PlannerParams& params, const PlanRequest& request);

  // The same on given cells: between BeginCells and the first StepCells, call
  // costmap_builder().SetCell.
  Status BeginCells(const GridWindow& window, const PlannerParams& params,
                    const PlanRequest& request);

  // Once more on the map of the plan that is done, as it is: another start or another goal.
  // kNotStarted: no plan is done; and those of the request, as above. Then StepCells; any Step
  // does, as no cells are read.
  Status BeginOnMap(const PlanRequest& request);

  // The same kind of Step as of Begin: the others assert it. At most `units`
  // units of the stages' (see there; of pending columns a slot of the ring, of the search
  // kSearchUnits of its own, which are that much shorter than a row of the costmap), and at most
  // kPortion_units of one stage; what a stage leaves of them is lost.
  // Between stages a unit may also join, assemble or begin, which costs a few passes over the path.
  // kMaxUnits steps of one unit end any plan. Any split of the units gives the same plan while the
  // mapper stays as it is. Results: those of the stages, and kPivotBlocked.
  Progress Step(const Mapper& mapper, int units);
  Progress Step(const HeightGrid& heights, int units);
  Progress StepCells(int units);

  PlanStage stage() const { return stage_; }
  const Plan& result() const { return plan_; }
  const Costmap& costmap() const { return builder_.result(); }
  CostmapBuilder& costmap_builder() { return builder_; }

  static constexpr int kPortion_units = 64;
  // A tick that closes cells is then no longer than one that builds the costmap (about 400
  // instructions a cell against 7,000 a row, test/instructions/counts.txt).
  static constexpr int kSearchUnits = 8;
  static constexpr float kMaxShort_m = 1.0f;
  static constexpr float kHere_m = 0.3f;  // a cell's diagonal
  static constexpr float kLeastLead_m = 0.6f;
  static constexpr float kGoalHeading_rad = 0.05f;  // an end further off is turned on the spot
  static constexpr int kMaxTransitions = 32;
  // From one start on the map that there is.
  static constexpr int kMaxRouteUnits = kMaxTransitions + AstarSearch::kMaxUnits / kSearchUnits +
                                        1 + PathSampler::kMaxUnits + PathSmoother::kMaxPasses +
                                        3 * Optimizer::kMaxUnits + 14 * PathCheck::kMaxUnits;
  // Where the vehicle is, behind a lead-out, and again where it is.
  static constexpr int kMaxRoutes = 3;
  static constexpr int kMaxUnits =
      CostmapBuilder::kUnits + ScanRing::kMaxColumns + kMaxRoutes * kMaxRouteUnits +
      4 * (LeadOut::kBends + 1) * (LeadOut::kMaxUnits + 1) +
      4 * LeadOut::kBends * PathCheck::kMaxUnits + SpeedCaps::kMaxUnits;

 private:
  // What the cells are made from: heights and, if there is one, the mapper that pends columns.
  struct Source {
    const HeightGrid* heights = nullptr;
    const Mapper* mapper = nullptr;
  };

  Status BeginOn(const HeightGrid& heights, const PlannerParams& params,
                 const PlanRequest& request);
  Status Started(Status status, PlanStage first);
  Status Prepare(const PlannerParams& params, const PlanRequest& request);
  Progress Run(const Source& source, int units);
  void StepStage(const Source& source, int units);
  void StepHeights(const Source& source, int units);
  void StepPending(const Source& source, int units);
  void StepCostmap(int units);
  void StepSearch(int units);
  void StepSample(int units);
  void StepSampler(int units);
  void StepLeadOut(int units);
  void StepOptimize(int units);
  void StepCheck(int units);
  void StepSpeed(int units);

  void BeginSearch();
  bool IsHere() const;
  void Stay();
  [[nodiscard]] bool MayPivot() const;
  [[nodiscard]] bool BeginLeadOut(Status failure);
  void LookForLeadOut();
  bool SweepsUnseen() const;
  void StepLeadCheck(int units);
  void RefuseLead();
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
  bool keeps_end_heading_ = false;
  bool has_goal_heading_ = false;  // and the path ends at the goal
  PlannerParams params_;
  PlanRequest request_;
  Plan plan_;
  WorldPath seed_;
  WorldPath lead_;       // from where the vehicle is; else empty
  PathStart own_start_;  // of the request, before lead_ took its place
  LeadOut lead_out_;
  bool led_out_ = false;                       // a lead-out was looked for
  bool looks_bent_ = false;                    // the one that is looked for may be bent
  bool looks_across_ = false;                  // and cells may lie across its flanks
  Status lead_failure_ = Status::kNotStarted;  // what it fails with without one; kOk: it does not
  CostmapBuilder builder_;
  AstarSearch search_;
  PathSampler sampler_;
  bool sampled_ = false;  // and the smoother has begun
  PathSmoother smoother_;
  bool seed_is_smooth_ = false;
  bool is_gentle_ = false;  // optimized for the preferred rate of curvature
  Optimizer optimizer_;
  PathCheck check_;
  SpeedCaps caps_;
};
static_assert(std::is_trivially_copyable_v<Planner>);

// Planning as a whole: heights, costs, search, paths.
inline constexpr int kPlanningBudget_bytes = 6 * 1024 * 1024;
static_assert(sizeof(Planner) + sizeof(HeightGrid) <= kPlanningBudget_bytes);

// Every parameter within its range, and all that plans go by together (config/conflicts.h): kOk or
// kParameterOutOfRange.
Status CheckPlannerParams(const PlannerParams& params);

// Adds every decision of a plan, field by field.
void AddToHash(const Plan& plan, DecisionHash& hash);

}  // namespace hardpack
