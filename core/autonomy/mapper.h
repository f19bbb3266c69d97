// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "config/parameters.h"
#include "core/base/fixed_vector.h"
#include "core/base/status.h"
#include "core/costmap/costmap.h"
#include "core/costmap/height_grid.h"
#include "core/measurements/measurements.h"
#include "core/scan/pose_history.h"
#include "core/scan/scan.h"
#include "core/segmentation/label_table.h"
#include "core/segmentation/segmentation.h"
#include "core/segmentation/wire_finder.h"

// The perception half of the chain: lidar columns, poses and labels in, heights out
// (docs/algorithm.md sections 1 and 8). Combines core/scan, core/segmentation and core/costmap;
// owns the ring of columns, the pose history and the height grid. It does not decode and does not
// plan.
//
// Configure once; then, as data arrives,
//   AddPose     odometry pose -> the map follows
//   AddColumn   pose at its time -> ring (raw) -> directions complete? -> class, local ground,
//               observed ground into the grid, ageing by what the direction saw -> (classed)
//   AddLabels   classes by label -> into the grid
//   Advance     every tick; past the deadline: into the grid with the geometric class
// and Planner::Begin takes the mapper whenever a plan is needed. Columns without a pose for their
// time are refused, so the odometry must be ahead of them or at most 50 ms behind.
//
// A column is folded into the grid once: minima and maxima cannot be undone. Between being classed
// and being folded it is pending, and MarkPending adds its obstacles to every build. With
// use_labels 0 it is folded as soon as it is classed. A direction is what all beams saw that looked
// the same way: one return per beam, each from the column in which it was fired
// (BeamModel::column_shift). It has the sequence number of the column at its own angle. All times
// are in our clock (core/timebase).

namespace hardpack {

struct MapperCounters {
  uint32_t columns_without_pose = 0;   // not filed
  uint32_t columns_over_limit = 0;     // not filed: the tick's limit of directions was used up
  uint32_t folded_with_labels = 0;     // columns
  uint32_t folded_without_labels = 0;  // by deadline, or because labels are not used
  uint32_t folded_early = 0;           // of both: their slot was needed before the deadline
  // Arrived too late, or had to be folded too early, for some of their rows to be classed: those
  // rows are hard.
  uint32_t late_unclassed_columns = 0;
  uint32_t returns_off_map = 0;
  uint32_t overhead_returns = 0;  // above the clearance height: not filed
  uint32_t height_jumps = 0;
  uint32_t position_jumps = 0;
  uint32_t sensor_restarts = 0;
};

class Mapper {
 public:
  // A sensor that sends nothing for this long has ended its revolution.
  static constexpr int64_t kSilence_ns = 50'000'000;
  // Odometry steps up to these rates are not jumps, whatever the time between two poses.
  static constexpr float kMaxClimb_mps = 3.0f;
  static constexpr float kMaxSpeed_mps = 15.0f;
  // Radius of the ground under the vehicle, which stands on it.
  static constexpr float kStandingRadius_m = 0.7f;
  // Most columns that one tick folds, not counting those that must be folded in any case: more than
  // any sensor sends in 10 ms.
  static constexpr int kMaxFolds = 256;
  // After this many columns in a row that are all too late, the sensor's count is taken as right:
  // the ring is ahead.
  static constexpr int kMaxLateRun = 32;
  // Most directions that one AddColumn classes: those waiting when a column ends a gap.
  static constexpr int kMaxDirections = kMaxColumnShift + Segmenter::kLag + 2;
  // Most cells between returns that one direction files as ground or forgets, except for the last
  // stretch: a line from the middle of the map crosses no more than kMapSize_cells. And the most
  // for one tick: those of 128 directions that see as far as the map's edge, or of more directions
  // if what they see is near.
  static constexpr uint32_t kMaxCrossed_cells = 3 * kMapSize_cells / 2;
  static constexpr uint32_t kMaxCrossedInTick_cells = 128 * kMapSize_cells;

  // Sets everything up for one sensor and empties the map. kParameterOutOfRange (mount,
  // segmentation, mapping or costmap); kInvalidArgument: label table, an empty model or a window
  // that is not the sensor's; kCapacityExceeded: the ring. On failure the mapper accepts nothing.
  // Cost: clears the grid and the ring.
  Status Configure(const PerceptionParams& params, const CostmapParams& rule,
                   const LabelTable& table, const BeamModel& model, int window_first,
                   int window_last);

  // Bounds the work of a tick. Until the next call, AddColumn and Advance class no more than
  // `directions` directions (a column that arrives too late for its own counts as one), cross no
  // more than kMaxCrossedInTick_cells, age no more than kMaxAged_cells, and Advance folds no more
  // columns once kMaxFolds are folded. Without this call there is no limit. A limit below
  // kMaxDirections is of no use.
  void BeginTick(int directions) {
    directions_left_ = directions;
    folds_left_ = kMaxFolds;
    crossing_ends_ = heights_.crossed_cells() + kMaxCrossedInTick_cells;
    is_limited_ = true;
    heights_.BeginTick(kMaxAged_cells);
  }
  // Most cells with an obstacle that age in a tick: twice what a revolution of 1024 columns in
  // 0.1 s sees in a dense forest.
  static constexpr int kMaxAged_cells = 8192;

  // Adds an odometry pose, in time order. The first one centres the map, and the ground around it
  // counts as observed (start_ground_radius_m); each later one moves the window. A height step
  // beyond height_jump_m (and kMaxClimb_mps) is a jump: the map, the pending columns and the
  // history are converted to the new heights, and nothing is lost (unless jumps add up to 100 m:
  // then the map is emptied). A position step beyond position_jump_m (and kMaxSpeed_mps) empties
  // the map. The statuses of PoseHistory::Add; kNotStarted. Cost: cells that enter the window; with
  // a jump, the grid or the ring.
  Status AddPose(const StampedPose& pose);

  // Adds a lidar column, taken at time_ns. The statuses of ScanRing::Push; kNoPose, counted;
  // kSensorRestarted: the sensor's count has restarted, and columns are refused until Advance has
  // folded those that are pending; kCapacityExceeded, counted: more directions than BeginTick
  // allows would have to be classed. Cost: one column filed; normally one direction classed and one
  // column folded, at most kMaxDirections of each.
  Status AddColumn(const LidarColumn& column, uint64_t time_ns);

  // Adds the labels of one column. kOk: it is folded, or will be as soon as it is classed; the
  // statuses of ScanRing::FindForLabels; kInvalidArgument: wrong number of beams; kNotStarted.
  // Cost: one column.
  Status AddLabels(const ColumnLabels& labels);

  // Call once per tick, after adding its input: folds columns that have waited too long for their
  // labels, oldest first, at most kMaxFolds columns, and ends the revolution of a silent sensor.
  // Cost: those columns; at the end of a revolution also kMaxDirections directions and, with
  // use_labels 0, as many columns.
  void Advance(uint64_t now_ns);

  // HeightGrid::NotePerson, FlagPerson and ReleasePerson.
  void NotePerson(Vec2 place_odom, float radius_m) { heights_.NotePerson(place_odom, radius_m); }
  void FlagPerson(Vec2 place_odom, float radius_m) { heights_.FlagPerson(place_odom, radius_m); }
  void ReleasePerson(Vec2 place_odom, float radius_m) {
    heights_.ReleasePerson(place_odom, radius_m);
  }

  // The end of a recording: classes and folds everything. Not for use on board: it costs the whole
  // ring.
  void Finish();

  // Read at the start of a build: MarkPending then adds what was not folded at that time.
  uint32_t fold_count() const { return ring_.fold_count(); }

  // Marks the obstacles of one column that is pending, or was folded after fold_count() had been
  // `since`, in a builder whose cells are classed. slot: 0 .. ring().slots() - 1. Cost: one column.
  void MarkPending(int slot, uint32_t since, CostmapBuilder& builder) const;

  // A column that ends a gap classes the columns waiting on both sides of it.
  static constexpr int kMaxFresh = 2 * kMaxDirections + 2;
  // Ring slots whose columns were classed, or already classed and now labelled, in the last call of
  // AddColumn, AddLabels or Advance, in order: the input for a check of single returns.
  std::span<const int16_t> fresh() const {
    return {fresh_.begin(), static_cast<size_t>(fresh_.size())};
  }

  // How a single return of a classed column would mark its cell in MarkPending: Costmap::kHard,
  // kHard | kPerson, kSoft or 0. If not 0, sets point_odom to the position of the return. 0 for a
  // return further away than max_range_mm. Preconditions: 0 <= slot < ring().slots(), 0 <= row <
  // model().beams. Constant cost.
  uint8_t ObstacleOf(int slot, int row, uint32_t max_range_mm, Vec2& point_odom) const;

  // Height of a ground return of a classed column above the lowest ground of its cell. False: the
  // return is not ground, is further away than max_range_mm, or the cell has no ground.
  // Preconditions and cost otherwise as for ObstacleOf.
  bool GroundStepOf(int slot, int row, uint32_t max_range_mm, Vec2& point_odom,
                    float& step_m) const;

  // Time, in our clock, of the newest column that looked along a level direction in odom, with the
  // sensor's newest pose; 0: none within the ring's last kLookBack revolutions. Constant cost.
  static constexpr int kLookBack = 3;
  uint64_t NewestLook_ns(Vec2 direction_odom) const;

  bool started() const { return configured_; }
  // A pose and a column have arrived: cells that the map calls free are not just unobserved.
  bool has_seen() const { return configured_ && poses_.size() > 0 && ring_.newest_sequence() >= 0; }
  const HeightGrid& heights() const { return heights_; }
  const ScanRing& ring() const { return ring_; }
  const PoseHistory& poses() const { return poses_; }
  const BeamModel& model() const { return model_; }
  const MapperCounters& counters() const { return counters_; }

 private:
  // A direction passing through the segmenter; beams from the lowest to the highest.
  struct Direction {
    int64_t sequence = -1;
    int32_t slot = 0;                 // ring slot of its own angle
    Vec3 point_odom[kMaxBeams] = {};  // of the returns that were seen
    bool nothing[kMaxBeams] = {};     // fired, and nothing came back
    SightFan fan;
  };

  void Forget();
  void JudgeStep(const StampedPose& before, const StampedPose& pose);
  void FoldOccupant(int64_t sequence);
  void MarkSelf(const LidarColumn& column);
  void StartDirections();
  void EndDirections();
  void BeginRestart();
  void ClassDirections(int64_t sequence, int64_t newest);
  int64_t DirectionsFor(int64_t sequence, int64_t newest) const;
  bool IsOccupantRaw(int64_t sequence) const;
  int64_t DirectionsToEnd() const;
  void ClassUpTo(int64_t last);
  void ClassAsHard(int slot, int64_t looked);
  void FinishColumn(int slot);
  void MarkFresh(int slot);
  Direction& DirectionOf(int64_t sequence);
  void LookAlong(int64_t sequence);
  void LookWithBeam(int beam, int own_id, const Transform3& pose, Direction& direction);
  void PassThroughNothing(Direction& direction);
  void UseClasses();
  void FileGround(const Direction& direction, int beam, const DirectionClasses& classes);
  bool MayCross() const;
  void ClassReturn(const Direction& direction, int beam, const DirectionClasses& classes);
  ReturnClass FiledClass(PackedReturn packed) const;
  bool IsOverhead(PackedReturn packed) const;
  bool StandsLow(const DirectionClasses& classes, int beam) const;
  bool IsLow(const DirectionClasses& classes, int beam) const;
  void FileWires(const Direction& direction, const DirectionClasses& classes);
  uint32_t RevolutionOf(int64_t sequence) const;
  SinCosPair EncoderOf(int slot) const;
  Vec3 PointOdom(const ScanColumn& column, SinCosPair encoder, int row, PackedReturn packed) const;
  int64_t HeldBeside(int64_t sequence) const;
  void Fold(int slot);
  bool FoldPending(uint64_t now_ns, uint64_t deadline_ns);
  bool MayBeObstacle(PackedReturn packed) const;
  uint8_t PendingFlags(PackedReturn packed, int32_t height_cm,
                       const HeightGrid::CellHeights& cell) const;

  bool configured_ = false;
  bool restarting_ = false;  // the sensor has restarted; pending columns are being folded
  bool silent_ = true;
  bool is_limited_ = false;              // BeginTick was called
  uint32_t crossed_before_ = 0;          // cells, at the start of the direction being classed
  uint32_t crossing_ends_ = 0;           // cells crossed at which the tick's limit is used up
  int32_t directions_left_ = INT32_MAX;  // in this tick
  int32_t folds_left_ = INT32_MAX;       // in this tick; below 0 by the folds that had to be done
  int32_t late_run_ = 0;                 // columns refused as late, in a row
  int64_t next_direction_ = -1;          // to be looked along; -1: set by the next column
  int64_t fold_next_ = -1;               // no column before it is pending; -1: none has arrived
  uint64_t newest_time_ns_ = 0;          // of all columns
  float self_reach_m_ = 0.0f;
  float obstacle_height_m_ = 0.0f;
  float band_m_ = 0.0f;  // anything up to this height above the ground is ground
  float growth_height_m_ = 0.0f;
  int32_t growth_cm_ = 0;
  bool knows_low_ = true;
  int32_t clearance_cm_ = 0;
  uint64_t deadline_ns_ = 0;
  Transform3 body_from_sensor_;
  Vec3 body_origin_sensor_;
  PerceptionParams params_;
  LabelTable table_;
  MapperCounters counters_;
  FixedVector<int16_t, kMaxFresh> fresh_;
  uint8_t self_[kMaxBeams] = {};
  DirectionView view_;
  Direction directions_[Segmenter::kLag + 1];  // by sequence, modulo
  BeamModel model_;
  PoseHistory poses_;
  Segmenter segmenter_;
  WireFinder wires_;
  ScanRing ring_;
  HeightGrid heights_;
};
static_assert(std::is_trivially_copyable_v<Mapper>);

}  // namespace hardpack
