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
// (docs/algorithm.md sections 1 and 8). Joins core/scan, core/segmentation and core/costmap; owns
// the ring of columns, the pose history and the height grid. It does not decode and does not plan.
//
// Configure once; then, as things come in,
//   AddPose     a pose of the odometry -> the map follows
//   AddColumn   pose of its time -> ring (raw) -> directions complete? -> class, local ground,
//               observed ground into the grid, ageing by what the direction saw -> (classed)
//   AddLabels   classes by label -> into the grid
//   Advance     every tick; the deadline is over: into the grid with the geometric class
// and Planner::Begin takes the mapper whenever a plan is wanted. Columns without a pose for their
// time are refused, so the odometry has to run ahead of them or at most 50 ms behind.
//
// A column is folded into the grid once: minima and maxima cannot be undone. From its being classed
// until then it is pending, and MarkPending puts its obstacles into every build. With use_labels 0
// it is folded as soon as it is classed. A direction is what the beams saw that looked the same
// way, one return a beam, each from the column that it was fired in (BeamModel::column_shift); it
// has the sequence number of the column at its own angle. All times are of our clock
// (core/timebase).

namespace hardpack {

struct MapperCounters {
  uint32_t columns_without_pose = 0;   // not filed
  uint32_t columns_over_limit = 0;     // not filed: the tick's directions were classed
  uint32_t folded_with_labels = 0;     // columns
  uint32_t folded_without_labels = 0;  // by deadline, or because labels are not used
  uint32_t folded_early = 0;           // of both: their slot was needed before the deadline
  // Came too late, or had to be folded too early, for some of their rows to be classed: those rows
  // are hard.
  uint32_t late_unclassed_columns = 0;
  uint32_t returns_off_map = 0;
  uint32_t overhead_returns = 0;  // above the clearance height: not filed
  uint32_t height_jumps = 0;
  uint32_t position_jumps = 0;
  uint32_t sensor_restarts = 0;
};

class Mapper {
 public:
  // A sensor that sends nothing for so long has ended its revolution.
  static constexpr int64_t kSilence_ns = 50'000'000;
  // Steps of the odometry that are no jump, whatever the time between two poses.
  static constexpr float kMaxClimb_mps = 3.0f;
  static constexpr float kMaxSpeed_mps = 15.0f;
  // Ground under the vehicle, which stands on it.
  static constexpr float kStandingRadius_m = 0.7f;
  // Columns that one tick folds at most, those aside that are due whether it has time or not: more
  // than come in 10 ms from any sensor.
  static constexpr int kMaxFolds = 256;
  // So many columns in a row that are all too late are the sensor's count, and the ring is ahead.
  static constexpr int kMaxLateRun = 32;
  // Directions classed by one AddColumn at most: those that wait when a column ends a gap.
  static constexpr int kMaxDirections = kMaxColumnShift + Segmenter::kLag + 2;
  // Cells between returns that one direction files as ground or forgets, but for the last stretch:
  // a line from the middle of the map crosses no more than kMapSize_cells. And that one tick does:
  // those of 128 directions that see as far as the map's edge, and more where what they see is
  // near.
  static constexpr uint32_t kMaxCrossed_cells = 3 * kMapSize_cells / 2;
  static constexpr uint32_t kMaxCrossedInTick_cells = 128 * kMapSize_cells;

  // Sets everything up for one sensor and empties the map. kParameterOutOfRange (mount,
  // segmentation, mapping or costmap); kInvalidArgument: label table, an empty model or a window
  // that is not the sensor's; kCapacityExceeded: the ring. On failure the mapper takes nothing.
  // Cost: the grid and the ring cleared.
  Status Configure(const PerceptionParams& params, const CostmapParams& rule,
                   const LabelTable& table, const BeamModel& model, int window_first,
                   int window_last);

  // From now on AddColumn and Advance class no more than so many directions (a column that came too
  // late for its own counts as one), cross no more than
  // kMaxCrossedInTick_cells, let no more than kMaxAged_cells age, and Advance folds no column when
  // kMaxFolds are folded, until the next call; without it there is no limit. What keeps a tick's
  // work within bounds: no limit that is below kMaxDirections is of use.
  void BeginTick(int directions) {
    directions_left_ = directions;
    folds_left_ = kMaxFolds;
    crossing_ends_ = heights_.crossed_cells() + kMaxCrossedInTick_cells;
    is_limited_ = true;
    heights_.BeginTick(kMaxAged_cells);
  }
  // Cells with an obstacle that age in a tick at most: what a revolution of 1024 columns in 0.1 s
  // sees of a dense forest, twice.
  static constexpr int kMaxAged_cells = 8192;

  // A pose of the odometry, in order of time. The first one centres the map, and the ground around
  // it is taken as observed (start_ground_radius_m); each later one moves the window. A step of its
  // height beyond height_jump_m (and kMaxClimb_mps) is a jump: the map, the pending columns and the
  // history are told in the new heights, and nothing is lost (unless jumps add up to 100 m: then
  // the map is emptied). A step of its position beyond position_jump_m (and kMaxSpeed_mps) empties
  // the map. The statuses of PoseHistory::Add; kNotStarted. Cost: cells that come into the window;
  // with a jump, the grid or the ring.
  Status AddPose(const StampedPose& pose);

  // A column of the lidar, taken at time_ns. The statuses of ScanRing::Push; kNoPose, counted;
  // kSensorRestarted: the sensor counts anew, and columns are refused until Advance has folded what
  // is pending; kCapacityExceeded, counted: more directions than BeginTick allows would have to be
  // classed. Cost: one column filed; as a rule one direction classed and one column folded, at
  // most kMaxDirections of each.
  Status AddColumn(const LidarColumn& column, uint64_t time_ns);

  // The labels of one column. kOk: it is folded, or will be as soon as it is classed; the statuses
  // of ScanRing::FindForLabels; kInvalidArgument: another number of beams; kNotStarted.
  // Cost: one column.
  Status AddLabels(const ColumnLabels& labels);

  // Once a tick, after what came in it: folds what has waited for its labels for too long, the
  // oldest first, at most kMaxFolds columns, and ends the revolution of a sensor that is silent.
  // Cost: those columns; at the end of a revolution kMaxDirections directions, and with use_labels
  // 0 as many columns, besides.
  void Advance(uint64_t now_ns);

  // The end of a recording: classes and folds everything. Not for on board: its cost is the ring.
  void Finish();

  // What a build begins with: MarkPending then adds what was not folded when it began.
  uint32_t fold_count() const { return ring_.fold_count(); }

  // Marks the obstacles of one column that is pending, or was folded after fold_count() had been
  // `since`, in a builder whose cells are classed. slot: 0 .. ring().slots() - 1. Cost: one column.
  void MarkPending(int slot, uint32_t since, CostmapBuilder& builder) const;

  // A column that ends a gap classes what waits on both sides of it.
  static constexpr int kMaxFresh = 2 * kMaxDirections + 2;
  // Slots of the ring whose columns were classed, or were classed and got their labels, in the last
  // call of AddColumn, AddLabels or Advance, in order: what a test of single returns is to look at.
  std::span<const int16_t> fresh() const {
    return {fresh_.begin(), static_cast<size_t>(fresh_.size())};
  }

  // What a return of a classed column by itself makes of its cell, as MarkPending would mark it:
  // Costmap::kHard, kHard | kPerson, kSoft or 0. Where it is not 0 it sets where the return lies;
  // 0 for one further away than max_range_mm. Preconditions: 0 <= slot < ring().slots(), 0 <= row <
  // model().beams. Constant cost.
  uint8_t ObstacleOf(int slot, int row, uint32_t max_range_mm, Vec2& point_odom) const;

  // How far a return of a classed column that is ground lies above the lowest ground of its cell.
  // False: it is none, lies further away than max_range_mm, or the cell has no ground. The other
  // preconditions and the cost as of ObstacleOf.
  bool GroundStepOf(int slot, int row, uint32_t max_range_mm, Vec2& point_odom,
                    float& step_m) const;

  // Our time of the newest column that looked along a level direction of odom with the sensor's
  // newest pose; 0: none within the ring's last kLookBack revolutions. Constant cost.
  static constexpr int kLookBack = 3;
  uint64_t NewestLook_ns(Vec2 direction_odom) const;

  bool started() const { return configured_; }
  // A pose and a column have come: what the map calls free was not just never looked at.
  bool has_seen() const { return configured_ && poses_.size() > 0 && ring_.newest_sequence() >= 0; }
  const HeightGrid& heights() const { return heights_; }
  const ScanRing& ring() const { return ring_; }
  const PoseHistory& poses() const { return poses_; }
  const BeamModel& model() const { return model_; }
  const MapperCounters& counters() const { return counters_; }

 private:
  // A direction on its way through the segmenter; beams from the lowest to the highest.
  struct Direction {
    int64_t sequence = -1;
    int32_t slot = 0;                 // of the ring, of its own angle
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
  bool restarting_ = false;  // the sensor has; what is pending is being folded
  bool silent_ = true;
  bool is_limited_ = false;              // BeginTick was called
  uint32_t crossed_before_ = 0;          // cells, when the direction that is classed began
  uint32_t crossing_ends_ = 0;           // cells crossed, where the tick's are used up
  int32_t directions_left_ = INT32_MAX;  // of this tick
  int32_t folds_left_ = INT32_MAX;       // the same; below 0 by what was due
  int32_t late_run_ = 0;                 // columns refused as late, in a row
  int64_t next_direction_ = -1;          // to be looked along; -1: the next column says
  int64_t fold_next_ = -1;               // no column before it is pending; -1: none has come
  uint64_t newest_time_ns_ = 0;          // of all columns
  float self_reach_m_ = 0.0f;
  float obstacle_height_m_ = 0.0f;
  float band_m_ = 0.0f;  // what is no higher above the ground is ground
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
