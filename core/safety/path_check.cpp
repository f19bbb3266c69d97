// SPDX-License-Identifier: Apache-2.0
#include "core/safety/path_check.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/speed/speed.h"

namespace hardpack {
namespace {

constexpr float kSample_m = 0.5f / kCellsPerMeter;
// A little above the square root of two: twice the way from a cell's middle to its corner.
constexpr float kDiagonal_cells = 1.41422f;
// Poses closer than this are measured even after a closer one was found, so that an overlap is
// always known by its depth.
constexpr float kAlwaysMeasured_m = 0.1f;

enum class Metric { kToSquare, kToCentre };

// Distance along one axis [cells] from u, inside or near cell 0, to cell `offset`.
template <Metric kMetric>
float AxisDistance(float u_cells, int32_t offset) {
  const float low = static_cast<float>(offset);
  if constexpr (kMetric == Metric::kToCentre) return Abs(low + 0.5f - u_cells);
  return Max(0.0f, Max(low - u_cells, u_cells - (low + 1.0f)));
}

// How many cells of a row are passed from one on, itself included, until the first hard one; more
// than `most` where none of so many behind it is.
template <int kStep>
inline int32_t PassedToHard(const uint8_t* flags, int32_t most) {
  HP_LOOP_BOUND(PathCheck::kMaxScan_cells + 1)
  for (int32_t passed = 0; passed <= most; ++passed) {
    if ((flags[passed * kStep] & Costmap::kHard) != 0) return passed;
  }
  return most + 1;
}

// Lowers nearest2_cells2 to the squared distance from a point to the nearest hard cell that is
// nearer than that.
//
// With c the map's cell nearest to the point and D the map's distance from c's centre to the
// nearest hard centre: the point (or its projection onto the map, which is no further from any
// square of the map) lies in c, at most half a diagonal from its centre, and every point of a
// square lies at most half a diagonal from its own centre. So every hard square is at least
// D - one diagonal away, and where that is no less than `nearest` nothing is scanned. A saturated D
// is a lower bound still. Likewise a cell n columns (or rows) from c is at least n - 1 away, which
// bounds the box that is scanned. Of a row's cells on one side of the point
// the first hard one is the nearest.
template <Metric kMetric>
void LowerToNearestHard(const Costmap& map, Vec2 point_odom, float& nearest2_cells2) {
  const Cell cell = map.window.Nearest(CellAt(point_odom));
  const float reach_cells = Sqrt(nearest2_cells2);
  const float least = reach_cells + kDiagonal_cells;
  if (static_cast<float>(map.hard_distance2[map.window.Index(cell)]) >= least * least) return;

  const float u = point_odom.x_m * kCellsPerMeter - static_cast<float>(cell.x);
  const float v = point_odom.y_m * kCellsPerMeter - static_cast<float>(cell.y);
  const int32_t half = ClampInt(FloorToInt(reach_cells) + 1, 0, PathCheck::kMaxScan_cells);
  const Cell low = map.window.Nearest({cell.x - half, cell.y - half});
  const Cell high = map.window.Nearest({cell.x + half, cell.y + half});
  const int32_t most_right = high.x - cell.x;
  const int32_t most_left = cell.x - low.x;
  HP_LOOP_BOUND(2 * PathCheck::kMaxScan_cells + 1)
  for (int32_t y = low.y; y <= high.y; ++y) {
    const float dy = AxisDistance<kMetric>(v, y - cell.y);
    if (dy * dy >= nearest2_cells2) continue;
    const uint8_t* middle = &map.flags[map.window.Index({cell.x, y})];
    const int32_t right = PassedToHard<1>(middle, most_right);
    const int32_t left = PassedToHard<-1>(middle, most_left);
    if (right <= most_right) {
      const float dx = AxisDistance<kMetric>(u, right);
      nearest2_cells2 = Min(nearest2_cells2, dx * dx + dy * dy);
    }
    if (left <= most_left) {
      const float dx = AxisDistance<kMetric>(u, -left);
      nearest2_cells2 = Min(nearest2_cells2, dx * dx + dy * dy);
    }
  }
}

float Squared(float value) {
  return value * value;
}

// Number of even pieces, none longer than kSample_m.
int32_t PiecesOf(float way_m, int32_t most) {
  return ClampInt(FloorToInt(Min(way_m / kSample_m, 1.0e6f)) + 1, 1, most);
}

bool IsFootprint(float value_m) {
  return value_m >= 0.0f && value_m <= PathCheck::kMaxFootprint_m;
}

Status CheckInput(const VehicleParams& vehicle, const WorldPath& path,
                  float start_curvature_per_m) {
  if (!IsFootprint(vehicle.footprint_disc_radius_m) ||
      !IsFootprint(vehicle.footprint_disc_offset_m)) {
    return Status::kParameterOutOfRange;
  }
  if (!IsFinite(start_curvature_per_m)) return Status::kNotFinite;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (const Pose2& pose : path) {
    if (!IsFinite(pose)) return Status::kNotFinite;
  }
  return path.size() < 2 ? Status::kPathTooShort : Status::kOk;
}

}  // namespace

Status PathCheck::Begin(const VehicleParams& vehicle, const OptimizerParams& limits,
                        const WorldPath& path, float start_curvature_per_m) {
  *this = PathCheck{};
  result_.status = CheckInput(vehicle, path, start_curvature_per_m);
  if (!IsUsable(result_.status)) return result_.status;
  result_.status = Status::kNotStarted;
  vehicle_ = vehicle;
  limits_ = limits;
  nearest2_cells2_ =
      Squared((vehicle.footprint_disc_radius_m + kClearanceReach_m) * kCellsPerMeter);
  middle2_cells2_ = Squared(kClearanceReach_m * kCellsPerMeter);
  JudgeShape(path, start_curvature_per_m);
  phase_ = Phase::kTurn;
  samples_ = 1;  // At the first point nothing is turned: the pose itself.
  return Status::kOk;
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
  JudgePose(map, pose);
  if (result_.leaves_map) {
    Finish(path);
  } else if (sample_ == samples_) {
    EnterNext(path);
  }
}

// From a turn to the chord behind it, where there is one; from a chord to the turn at its end.
void PathCheck::EnterNext(const WorldPath& path) {
  sample_ = 0;
  if (phase_ == Phase::kTurn) {
    if (point_ + 1 == path.size()) {
      Finish(path);
      return;
    }
    const float chord_m = Abs(PlanarModel::Inverse(path[point_], path[point_ + 1]).dr_m);
    if (HasLength(chord_m)) {
      phase_ = Phase::kChord;
      samples_ = PiecesOf(chord_m, kMaxChordSamples);
      return;
    }
  }
  ++point_;
  phase_ = Phase::kTurn;
  turn_rad_ = WrapAngle(path[point_].theta_rad - path[point_ - 1].theta_rad);
  samples_ = PiecesOf(Abs(turn_rad_) * vehicle_.footprint_disc_offset_m, kMaxTurnSamples);
}

void PathCheck::JudgePose(const Costmap& map, const Pose2& pose) {
  const Vec2 middle = {pose.x_m, pose.y_m};
  if (!map.window.Contains(CellAt(middle))) {
    result_.leaves_map = true;
    Collide();
    return;
  }
  const SinCosPair heading = SinCos(pose.theta_rad);
  const float offset_m = vehicle_.footprint_disc_offset_m;
  const Vec2 arm = {offset_m * heading.cos, offset_m * heading.sin};
  const float radius_m = vehicle_.footprint_disc_radius_m;
  float front2_cells2 =
      Max(nearest2_cells2_, Squared((radius_m + kAlwaysMeasured_m) * kCellsPerMeter));
  float rear2_cells2 = front2_cells2;
  LowerToNearestHard<Metric::kToSquare>(map, {middle.x_m + arm.x_m, middle.y_m + arm.y_m},
                                        front2_cells2);
  LowerToNearestHard<Metric::kToSquare>(map, {middle.x_m - arm.x_m, middle.y_m - arm.y_m},
                                        rear2_cells2);
  const float pose2_cells2 = Min(front2_cells2, rear2_cells2);
  const float clearance_m = Sqrt(pose2_cells2) / kCellsPerMeter - radius_m;
  if (pose2_cells2 < nearest2_cells2_) {
    nearest2_cells2_ = pose2_cells2;
    result_.smallest_clearance_m = clearance_m;
    result_.smallest_clearance_point = point_;
  }
  const float middle2_cells2 = middle2_cells2_;
  LowerToNearestHard<Metric::kToCentre>(map, middle, middle2_cells2_);
  if (middle2_cells2_ < middle2_cells2) {
    result_.smallest_hard_distance_m = Sqrt(middle2_cells2_) / kCellsPerMeter;
  }
  JudgeOverlap(Sqrt(front2_cells2) / kCellsPerMeter - radius_m, front_);
  JudgeOverlap(Sqrt(rear2_cells2) / kCellsPerMeter - radius_m, rear_);
}

// A disc may drive out of what it stands in, and into nothing else: each is judged by itself, so
// that the one in an obstacle does not hide what the other one meets.
void PathCheck::JudgeOverlap(float clearance_m, DiscOverlap& disc) {
  disc.overlaps = clearance_m <= 0.0f;
  if (!disc.overlaps) {
    disc.has_been_clear = true;
    return;
  }
  if (disc.has_been_clear || (disc.overlapped && clearance_m < disc.deepest_m)) Collide();
  const float deepest_m = clearance_m - kDeeperTolerance_m;
  disc.deepest_m = disc.overlapped ? Max(disc.deepest_m, deepest_m) : deepest_m;
  disc.overlapped = true;
  // The chord's end too: until there it overlaps.
  if (result_.collision_point < 0) result_.overlap_points = point_ + 2;
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
  if (result_.collision_point >= 0 || front_.overlaps || rear_.overlaps) {
    result_.status = Status::kCollision;
  } else if (exceeds) {
    result_.status = Status::kLimitExceeded;
  } else {
    result_.status = result_.overlap_points > 0 ? Status::kStartInObstacle : Status::kOk;
  }
}

}  // namespace hardpack
