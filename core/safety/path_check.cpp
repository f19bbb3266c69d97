// SPDX-License-Identifier: Apache-2.0
#include "core/safety/path_check.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/kinematics/kinematics.h"
#include "core/speed/speed.h"

namespace hardpack {
namespace {

constexpr float kSample_m = 0.5f / kCellsPerMeter;
// Less is no turn, but what floats leave of none.
constexpr float kLeastTurn_rad = 1.0e-3f;
constexpr float kTurnSample_m = 0.25f / kCellsPerMeter;
constexpr float kDeeper_cells = PathCheck::kDeeperTolerance_m * kCellsPerMeter;
constexpr float kFar_cells = 1.0e6f;
constexpr float kAcross_cells = PathCheck::kAcross_m * kCellsPerMeter;
constexpr float kReach_cells = kClearanceReach_m * kCellsPerMeter;
// A little above the square root of two: a cell's diagonal.
constexpr float kDiagonal_cells = 1.41422f;
// What floats may be off by in the distance of an outline to a square.
constexpr float kRounding_cells = 1.0e-4f;

// Lowers nearest2_cells2 to the squared distance from a point to the nearest hard cell's centre
// that is nearer than that. As the map tells the distance between centres, every centre is at least
// that less half a diagonal away, and where that is no less than `nearest` nothing is scanned. A
// cell n columns (or rows) from the point's own is at least n - 1 away, which bounds the box.
void LowerToNearestCentre(const Costmap& map, Vec2 point_odom, float& nearest2_cells2) {
  const Cell cell = map.window.Nearest(CellAt(point_odom));
  const float reach_cells = Sqrt(nearest2_cells2);
  const float least = reach_cells + kDiagonal_cells;
  if (static_cast<float>(map.hard_distance2[map.window.Index(cell)]) >= least * least) return;
  const float u = point_odom.x_m * kCellsPerMeter - static_cast<float>(cell.x) - 0.5f;
  const float v = point_odom.y_m * kCellsPerMeter - static_cast<float>(cell.y) - 0.5f;
  const int32_t half = ClampInt(FloorToInt(reach_cells) + 1, 0, PathCheck::kMiddleReach_cells);
  const Cell low = map.window.Nearest({cell.x - half, cell.y - half});
  const Cell high = map.window.Nearest({cell.x + half, cell.y + half});
  HP_LOOP_BOUND(2 * PathCheck::kMiddleReach_cells + 1)
  for (int32_t y = low.y; y <= high.y; ++y) {
    const float dy2 = Squared(static_cast<float>(y - cell.y) - v);
    if (dy2 >= nearest2_cells2) continue;
    const uint8_t* flags = &map.flags[map.window.Index({low.x, y})];
    HP_LOOP_BOUND(2 * PathCheck::kMiddleReach_cells + 1)
    for (int32_t x = low.x; x <= high.x; ++x) {
      if ((flags[x - low.x] & Costmap::kHard) == 0) continue;
      nearest2_cells2 = Min(nearest2_cells2, Squared(static_cast<float>(x - cell.x) - u) + dy2);
    }
  }
}

// Number of even pieces, none longer than `longest_m`.
int32_t PiecesOf(float way_m, float longest_m, int32_t most) {
  return ClampInt(FloorToInt(Min(way_m / longest_m, 1.0e6f)) + 1, 1, most);
}

bool TurnsOnTheSpot(const Pose2& from, const Pose2& to) {
  const ActuatorStep step = PlanarModel::Inverse(from, to);
  return !HasLength(step.dr_m) && Abs(step.phi_rad) > kLeastTurn_rad;
}

Status CheckInput(const VehicleParams& vehicle, const WorldPath& path, float start_curvature_per_m,
                  float margin_m) {
  const bool fits = vehicle.length_m >= 0.0f && vehicle.length_m <= Outline::kMaxLength_m &&
                    vehicle.width_m >= 0.0f && vehicle.width_m <= Outline::kMaxWidth_m &&
                    Abs(vehicle.axle_offset_m) <= 0.5f * vehicle.length_m && margin_m >= 0.0f &&
                    margin_m <= PathCheck::kMaxMargin_m;
  if (!fits) return Status::kParameterOutOfRange;
  if (!IsFinite(start_curvature_per_m)) return Status::kNotFinite;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (const Pose2& pose : path) {
    if (!IsFinite(pose)) return Status::kNotFinite;
  }
  return path.size() < 2 ? Status::kPathTooShort : Status::kOk;
}

}  // namespace

Status PathCheck::Begin(const VehicleParams& vehicle, const OptimizerParams& limits,
                        const WorldPath& path, float start_curvature_per_m, float margin_m,
                        int across_chords) {
  *this = PathCheck{};
  result_.status = CheckInput(vehicle, path, start_curvature_per_m, margin_m);
  if (!IsUsable(result_.status)) return result_.status;
  result_.status = Status::kNotStarted;
  footprint_ = FootprintOf(vehicle);
  limits_ = limits;
  margin_cells_ = margin_m * kCellsPerMeter;
  across_chords_ = across_chords;
  nearest_cells_ = kReach_cells;
  middle2_cells2_ = Squared(kReach_cells);
  JudgeShape(path, start_curvature_per_m);
  if (!CanDrive(vehicle, path)) {
    result_.status = Status::kNeedsManoeuvre;
    return Status::kOk;  // and it is done: Step has nothing to look at
  }
  phase_ = Phase::kTurn;
  samples_ = 1;  // At the first point nothing is turned: the pose itself.
  return Status::kOk;
}

// What cannot be driven is no matter of a limit. SR-PLN05
bool PathCheck::CanDrive(const VehicleParams& vehicle, const WorldPath& path) const {
  if (CanPivot(vehicle)) return true;
  const float most_per_m = MostCurvature(vehicle);
  if (result_.largest_curvature_per_m > most_per_m * (1.0f + kLimitTolerance)) return false;
  bool turns = false;
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int k = 0; k + 1 < path.size(); ++k) turns = turns || TurnsOnTheSpot(path[k], path[k + 1]);
  return !turns;
}

// Where the vehicle stands, at a turn on the spot or a change of direction, there is no curvature,
// and the next one is taken against none.
void PathCheck::JudgeShape(const WorldPath& path, float start_curvature_per_m) {
  ActuatorStep before = PlanarModel::Inverse(path[0], path[1]);
  float kappa_before = start_curvature_per_m;
  HP_LOOP_BOUND(kMaxPathPoints - 2)
  for (int k = 1; k + 1 < path.size(); ++k) {
    const ActuatorStep after = PlanarModel::Inverse(path[k], path[k + 1]);
    float kappa = 0.0f;
    if (HasLength(before.dr_m) && HasLength(after.dr_m) &&
        (before.dr_m < 0.0f) == (after.dr_m < 0.0f)) {
      const float before_m = Abs(before.dr_m);
      const float after_m = Abs(after.dr_m);
      kappa = CurvatureBetween(before.phi_rad, before_m, after_m);
      const float rate = Abs(kappa - kappa_before) / MeanChord(before_m, after_m);
      if (Abs(kappa) > result_.largest_curvature_per_m) result_.sharpest_point = k;
      result_.largest_curvature_per_m = Max(result_.largest_curvature_per_m, Abs(kappa));
      result_.largest_curvature_rate_per_m2 = Max(result_.largest_curvature_rate_per_m2, rate);
    }
    kappa_before = kappa;
    before = after;
  }
  result_.curvature_excess_per_m =
      Max(0.0f, result_.largest_curvature_per_m - limits_.max_curvature_per_m);
  result_.curvature_rate_excess_per_m2 =
      Max(0.0f, result_.largest_curvature_rate_per_m2 - limits_.max_curvature_rate_per_m2);
}

Progress PathCheck::Step(const Costmap& map, const WorldPath& path, int units) {
  HP_LOOP_BOUND(kMaxUnits)
  for (int unit = 0; unit < units && phase_ != Phase::kDone; ++unit) StepOnce(map, path);
  return phase_ == Phase::kDone ? Progress::kDone : Progress::kBusy;
}

void PathCheck::StepOnce(const Costmap& map, const WorldPath& path) {
  ++sample_;
  const float share = static_cast<float>(sample_) / static_cast<float>(samples_);
  Pose2 pose = path[point_];
  if (phase_ == Phase::kTurn) {
    // Backward from the new heading, so that the last sample has exactly that.
    pose.theta_rad -= (1.0f - share) * turn_rad_;
  } else {
    const Pose2& next = path[point_ + 1];
    pose.x_m = sample_ == samples_ ? next.x_m : pose.x_m + share * (next.x_m - pose.x_m);
    pose.y_m = sample_ == samples_ ? next.y_m : pose.y_m + share * (next.y_m - pose.y_m);
  }
  if (!JudgePose(map, pose)) {
    --sample_;
    return;
  }
  if (MayLieAcross()) --across_left_;
  if (result_.leaves_map) {
    Finish(path);
  } else if (sample_ == samples_) {
    EnterNext(path);
  }
  is_clear_ = was_clear_ && !MayLieAcross();
}

// From a turn to the chord behind it, where there is one; from a chord to the turn at its end.
void PathCheck::EnterNext(const WorldPath& path) {
  sample_ = 0;
  if (phase_ == Phase::kTurn) {
    if (point_ + 1 == path.size()) {
      Finish(path);
      return;
    }
    const Pose2& from = path[point_];
    const Vec2 chord = {path[point_ + 1].x_m - from.x_m, path[point_ + 1].y_m - from.y_m};
    const float chord_m = Sqrt(chord.x_m * chord.x_m + chord.y_m * chord.y_m);
    if (HasLength(chord_m)) {
      phase_ = Phase::kChord;
      samples_ = PiecesOf(chord_m, kSample_m, kMaxChordSamples);
      const SinCosPair heading = SinCos(from.theta_rad);
      const float aside_m = Abs(chord.x_m * heading.sin - chord.y_m * heading.cos);
      between_cells_ = 0.5f * aside_m * kCellsPerMeter / static_cast<float>(samples_);
      return;
    }
  }
  ++point_;
  phase_ = Phase::kTurn;
  turn_rad_ = WrapAngle(path[point_].theta_rad - path[point_ - 1].theta_rad);
  const float arc_m = Abs(turn_rad_) * footprint_.pivot_radius_m;
  samples_ = PiecesOf(arc_m, kTurnSample_m, kMaxTurnSamples);
  between_cells_ = 0.5f * arc_m * kCellsPerMeter / static_cast<float>(samples_);
}

// False: it is clear of its start here, and to be judged by that once more.
bool PathCheck::JudgePose(const Costmap& map, const Pose2& pose) {
  const Vec2 axle = {pose.x_m, pose.y_m};
  if (!map.window.Contains(CellAt(axle))) {
    result_.leaves_map = true;
    Collide();
    return true;
  }
  const Outline outline = OutlineAt(map.window, footprint_, pose);
  if (!is_clear_) {
    LeaveStart(map, outline);
    return !is_clear_;
  }
  JudgeClear(map, pose, outline);
  JudgeMiddle(map, pose);
  return true;
}

void PathCheck::JudgeMiddle(const Costmap& map, const Pose2& pose) {
  const float before2_cells2 = middle2_cells2_;
  LowerToNearestCentre(map, {pose.x_m, pose.y_m}, middle2_cells2_);
  if (middle2_cells2_ < before2_cells2) {
    result_.smallest_hard_distance_m = Sqrt(middle2_cells2_) / kCellsPerMeter;
  }
}

void PathCheck::JudgeClear(const Costmap& map, const Pose2& pose, const Outline& outline) {
  const float asked_cells = margin_cells_ + between_cells_;
  const float reach_cells = Max(nearest_cells_ + between_cells_, asked_cells + kRounding_cells);
  if (NearestHardAtLeast(map, footprint_, pose) >= reach_cells) return;
  const float within2_cells2 = Squared(Min(reach_cells, kReach_cells));
  float nearest2_cells2 = within2_cells2;
  LowerToNearestHard(map, outline, nearest2_cells2);
  if (nearest2_cells2 >= within2_cells2) return;
  const float distance_cells = Sqrt(nearest2_cells2);
  NoteClearance(distance_cells - between_cells_);
  // What touches collides, with a margin of nothing too.
  if (distance_cells <= 0.0f || distance_cells < asked_cells) Collide();
}

void PathCheck::NoteClearance(float clearance_cells) {
  if (clearance_cells >= nearest_cells_) return;
  nearest_cells_ = clearance_cells;
  result_.smallest_clearance_m = clearance_cells / kCellsPerMeter;
  result_.smallest_clearance_point = point_;
}

// Every hard cell that is nearer than the margin. Not inlined, as LeaveCell: its calls of that are
// counted (config/timing.toml).
[[gnu::noinline]] void PathCheck::LeaveStart(const Costmap& map, const Outline& outline) {
  if (!has_start_) {
    start_ = outline;
    start_least_cells_ = kReach_cells;
  }
  near_left_ = kMaxNearCells;
  const float asked_cells = margin_cells_ + between_cells_;
  asked_cells_ = asked_cells;
  least_cells_ = asked_cells;
  least_across_cells_ = MayLieAcross() ? -kAcross_cells : kFar_cells;
  const auto on_map = [](float cells) {
    return ClampInt(FloorToInt(cells), 0, kMapSize_cells - 1);
  };
  const int32_t first = on_map(outline.middle.x_m - outline.half_x_cells - asked_cells);
  const int32_t last = on_map(outline.middle.x_m + outline.half_x_cells + asked_cells);
  const int32_t first_row = on_map(outline.middle.y_m - outline.half_y_cells - asked_cells);
  const int32_t last_row = on_map(outline.middle.y_m + outline.half_y_cells + asked_cells);
  // Of a cell's middle in the body's axes, and a hair for what the sums below are off by.
  const float beyond = outline.half_cell_cells + asked_cells + 1.0e-3f;
  const float most_ahead = outline.half_length_cells + beyond;
  const float most_left = outline.half_width_cells + beyond;
  HP_LOOP_BOUND(Outline::kMaxNearSpan_cells)
  for (int32_t y = first_row; y <= last_row; ++y) {
    const uint8_t* flags = &map.flags[y * kMapSize_cells];
    const float dx = static_cast<float>(first) + 0.5f - outline.middle.x_m;
    const float dy = static_cast<float>(y) + 0.5f - outline.middle.y_m;
    float ahead = dx * outline.cos + dy * outline.sin;
    float left = dy * outline.cos - dx * outline.sin;
    HP_LOOP_BOUND(Outline::kMaxNearSpan_cells)
    for (int32_t x = first; x <= last && near_left_ > 0; ++x) {
      const bool is_near = Abs(ahead) <= most_ahead && Abs(left) <= most_left;
      if (is_near && (flags[x] & Costmap::kHard) != 0) LeaveCell(outline, x, y, flags[x]);
      ahead += outline.cos;
      left -= outline.sin;
    }
  }
  has_start_ = true;
  if (near_left_ == 0) Collide();
  is_clear_ = least_cells_ >= asked_cells;
  was_clear_ = was_clear_ || is_clear_;
  if (is_clear_) return;
  NoteClearance(least_cells_ - between_cells_);
  // The chord's end too: until there it is not clear.
  if (result_.collision_point < 0) result_.overlap_points = point_ + 2;
}

[[gnu::noinline]] void PathCheck::LeaveCell(const Outline& outline, int32_t x, int32_t y,
                                            uint32_t flags) {
  --near_left_;
  const CellApart now = ApartFrom(outline, x, y);
  if (now.least_cells >= asked_cells_) return;
  least_cells_ = Min(least_cells_, now.least_cells);
  if (!has_start_) {
    if (now.least_cells > 0.0f) {
      start_least_cells_ = Min(start_least_cells_, now.least_cells);
    } else {
      result_.start_overlaps = true;
    }
    return;
  }
  if (now.least_cells < LeastLeft(now, ApartFrom(start_, x, y), flags)) Collide();
}

// How near to a cell the outline may be, or how deep in it, while it leaves its start.
float PathCheck::LeastLeft(const CellApart& now, const CellApart& at_start, uint32_t flags) const {
  const bool is_closed = (flags & Costmap::kClosed) != 0;
  if (!is_closed && now.aside_cells >= least_across_cells_) return -kAcross_cells;
  if (at_start.least_cells <= 0.0f) {
    return at_start.least_cells - (is_closed ? kRounding_cells : kDeeper_cells);
  }
  const bool is_beside = now.aside_cells >= 0.0f;
  const float from_cells =
      is_beside ? Min(start_least_cells_, at_start.least_cells) : at_start.least_cells;
  const float kept_cells = Max(from_cells - kDeeper_cells, 0.5f * from_cells);
  // At least what may be swept from here to the next pose.
  return Min(margin_cells_, kept_cells) + between_cells_;
}

void PathCheck::Collide() {
  if (result_.collision_point < 0) result_.collision_point = point_;
}

void PathCheck::Finish(const WorldPath& path) {
  phase_ = Phase::kDone;
  result_.overlap_points = ClampInt(result_.overlap_points, 0, path.size());
  const bool exceeds =
      result_.curvature_excess_per_m > kLimitTolerance * limits_.max_curvature_per_m ||
      result_.curvature_rate_excess_per_m2 > kLimitTolerance * limits_.max_curvature_rate_per_m2;
  const bool ends_in = !is_clear_ && least_cells_ <= 0.0f;
  if (result_.collision_point >= 0 || ends_in) {
    result_.status = Status::kCollision;
  } else if (exceeds) {
    result_.status = Status::kLimitExceeded;
  } else if (result_.start_overlaps) {
    result_.status = Status::kStartInObstacle;
  } else {
    result_.status = result_.overlap_points > 0 ? Status::kNarrowGap : Status::kOk;
  }
}

}  // namespace hardpack
