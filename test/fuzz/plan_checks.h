// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "config/parameters.h"
#include "core/autonomy/planner.h"
#include "test/fuzz/mapper_script.h"

// What the headers promise of a usable plan, held against the plan and the cells that were drawn
// alone, in double: neither the costmap nor a stage is asked.

namespace hardpack {

// The drawn cells, and how far a disc is from the hard ones.
struct DrawnCells {
  GridWindow window;
  const uint8_t* flags;  // [kMapCells]

  bool Contains(const Pose2& pose) const { return window.Contains(CellAt({pose.x_m, pose.y_m})); }

  // From a disc's edge to the nearest hard cell's square [m]; at most a cell beyond its edge.
  double Clearance(double x_m, double y_m, double radius_m) const {
    const double x = x_m * static_cast<double>(kCellsPerMeter);
    const double y = y_m * static_cast<double>(kCellsPerMeter);
    const int reach = static_cast<int>(radius_m * static_cast<double>(kCellsPerMeter)) + 2;
    const int middle_x = static_cast<int>(std::floor(x));
    const int middle_y = static_cast<int>(std::floor(y));
    double nearest2 = static_cast<double>(reach - 1) * (reach - 1);
    for (int cell_y = middle_y - reach; cell_y <= middle_y + reach; ++cell_y) {
      for (int cell_x = middle_x - reach; cell_x <= middle_x + reach; ++cell_x) {
        if (!IsHard({cell_x, cell_y})) continue;
        const double dx = std::max({0.0, cell_x - x, x - (cell_x + 1)});
        const double dy = std::max({0.0, cell_y - y, y - (cell_y + 1)});
        nearest2 = std::min(nearest2, dx * dx + dy * dy);
      }
    }
    return std::sqrt(nearest2) / static_cast<double>(kCellsPerMeter) - radius_m;
  }

 private:
  bool IsHard(Cell cell) const {
    if (!window.Contains(cell)) return false;
    constexpr uint8_t kHards = Costmap::kHard | Costmap::kPerson;
    return (flags[window.Index(cell)] & kHards) != 0;
  }
};

// One disc of the footprint along the path: it may drive out of what it stands in, and into nothing
// else (core/safety/path_check.h).
class DiscWitness {
 public:
  DiscWitness(const DrawnCells& cells, const VehicleParams& vehicle, double side)
      : cells_(cells),
        radius_m_(static_cast<double>(vehicle.footprint_disc_radius_m)),
        offset_m_(side * static_cast<double>(vehicle.footprint_disc_offset_m)) {}

  // A point of the path, which the check has looked at. `clear`: it says that it is clear there.
  void AtPoint(const Pose2& pose, bool clear) {
    const double clearance_m = At(pose.x_m, pose.y_m, pose.theta_rad);
    if (is_first_) start_m_ = clearance_m;
    is_first_ = false;
    Require(!clear || clearance_m > -kRounding_m);
    was_clear_ = was_clear_ || clear || clearance_m > kRounding_m;
    Require(clearance_m > Least() - kRounding_m);
  }

  // Between two of them, where it has looked a quarter of a cell from here.
  void AtSample(double x_m, double y_m, double theta_rad) const {
    constexpr double kQuarterCell_m = 0.25 / static_cast<double>(kCellsPerMeter);
    Require(At(x_m, y_m, theta_rad) > Least() - kQuarterCell_m - kRounding_m);
  }

 private:
  static constexpr double kRounding_m = 1e-4;

  double At(double x_m, double y_m, double theta_rad) const {
    return cells_.Clearance(x_m + offset_m_ * std::cos(theta_rad),
                            y_m + offset_m_ * std::sin(theta_rad), radius_m_);
  }
  double Least() const {
    if (was_clear_) return 0.0;
    return std::min(0.0, start_m_ - static_cast<double>(PathCheck::kDeeperTolerance_m));
  }

  const DrawnCells& cells_;
  double radius_m_;
  double offset_m_;
  double start_m_ = 0.0;
  bool is_first_ = true;
  bool was_clear_ = false;
};

class PlanWitness {
 public:
  PlanWitness(const PlannerParams& params, const PlanRequest& request, const Plan& plan)
      : params_(params), start_(request.start), plan_(plan) {}

  void CheckAll(const DrawnCells& cells) const {
    Require(plan_.path.size() >= 2 && plan_.speed.size() == plan_.path.size());
    Require(plan_.actuator.steps.size() == plan_.path.size() - 1);
    for (int k = 0; k + 1 < plan_.path.size(); ++k) CheckStep(k);
    CheckShape();
    for (int k = 0; k < plan_.path.size(); ++k) CheckSpeed(k);
    CheckEnd();
    CheckClear(cells);
  }

 private:
  static bool IsChord(const ActuatorStep& step) { return HasLength(step.dr_m); }
  static double Way(const ActuatorStep& step) { return std::abs(static_cast<double>(step.dr_m)); }
  static double Turn(double rad) { return std::remainder(rad, 2.0 * static_cast<double>(kPi)); }
  static double Square(float value) {
    return static_cast<double>(value) * static_cast<double>(value);
  }

  // The step is the one that leads from a point to the next, along its heading.
  void CheckStep(int k) const {
    const ActuatorStep& step = plan_.actuator.steps[k];
    const Pose2& from = plan_.path[k];
    const Pose2& to = plan_.path[k + 1];
    Require(IsFinite(from) && IsFinite(to) && IsFinite(step.dr_m) && IsFinite(step.phi_rad));
    Require(std::abs(step.phi_rad) <= kPi);
    const double theta_rad = static_cast<double>(from.theta_rad);
    const double turned_rad = static_cast<double>(to.theta_rad) - theta_rad;
    Require(std::abs(Turn(turned_rad - static_cast<double>(step.phi_rad))) <= 1e-5);
    const double x_m = static_cast<double>(to.x_m) - static_cast<double>(from.x_m);
    const double y_m = static_cast<double>(to.y_m) - static_cast<double>(from.y_m);
    const double along_m = x_m * std::cos(theta_rad) + y_m * std::sin(theta_rad);
    Require(std::abs(std::hypot(x_m, y_m) - Way(step)) <= 1e-5 * Way(step) + 1e-7);
    if (!IsChord(step)) return;
    Require(std::abs(along_m - static_cast<double>(step.dr_m)) <= 1e-4 * Way(step));
  }

  bool MustStand(int k) const {
    const ActuatorStep& before = plan_.actuator.steps[k - 1];
    const ActuatorStep& after = plan_.actuator.steps[k];
    return !IsChord(before) || !IsChord(after) || (before.dr_m < 0.0f) != (after.dr_m < 0.0f);
  }

  // Curvatures and their rates are within the limits, to the check's tolerance, but where it says
  // otherwise: then one is not.
  void CheckShape() const {
    const double most = static_cast<double>(params_.optimizer.max_curvature_per_m);
    const double most_rate = static_cast<double>(params_.optimizer.max_curvature_rate_per_m2);
    double kappa_before = static_cast<double>(start_.curvature_per_m);
    double excess = 0.0;  // the largest, as a multiple of its limit, less what is rounding
    double surely = 0.0;  // and with it
    for (int k = 1; k < plan_.actuator.steps.size(); ++k) {
      const ActuatorStep& before = plan_.actuator.steps[k - 1];
      double kappa = 0.0;
      if (!MustStand(k)) {
        const double way_m = 0.5 * (Way(before) + Way(plan_.actuator.steps[k]));
        kappa = static_cast<double>(before.phi_rad) / way_m;
        const double rate = std::abs(kappa - kappa_before) / way_m;
        const double rounding = 1e-5 * (std::abs(kappa) + std::abs(kappa_before)) / way_m;
        excess = std::max({excess, std::abs(kappa) / most, (rate - rounding) / most_rate});
        surely = std::max({surely, std::abs(kappa) / most, (rate + rounding) / most_rate});
      }
      kappa_before = kappa;
    }
    const double limit = 1.0 + static_cast<double>(PathCheck::kLimitTolerance);
    const bool exceeds = plan_.check_status == Status::kLimitExceeded;
    Require(exceeds ? surely >= limit - 1e-4 : excess <= limit + 1e-4);
    Require(!exceeds || plan_.status >= Status::kLimitExceeded);
  }

  // Within the largest, and to be had from the point before; where it has to stand it does.
  void CheckSpeed(int k) const {
    const float speed_mps = plan_.speed[k];
    Require(IsFinite(speed_mps) && speed_mps >= 0.0f);
    if (k == 0) return Require(speed_mps == start_.speed_mps);
    Require(speed_mps <= std::max(params_.speed.max_speed_mps, start_.speed_mps) + 1e-3f);
    const bool stands = k + 1 < plan_.path.size() && MustStand(k);
    Require(!stands || speed_mps == 0.0f);
    const double gain_m2ps2 = Square(speed_mps) - Square(plan_.speed[k - 1]);
    const double way_m = Way(plan_.actuator.steps[k - 1]);
    const double rounding = 1e-5 * std::max(Square(speed_mps), Square(plan_.speed[k - 1])) + 1e-6;
    const SpeedParams& limits = params_.speed;
    Require(gain_m2ps2 <=
            2.0 * static_cast<double>(limits.max_acceleration_mps2) * way_m + rounding);
    Require(stands ||
            gain_m2ps2 >=
                -2.0 * static_cast<double>(limits.max_deceleration_mps2) * way_m - rounding);
  }

  // At rest, unless it brakes all the way and that does not do.
  void CheckEnd() const {
    if (plan_.speed.back() == 0.0f) return;
    double way_m = 0.0;
    for (const ActuatorStep& step : plan_.actuator.steps) way_m += Way(step);
    const double start_m2ps2 = Square(start_.speed_mps);
    const double left_m2ps2 =
        start_m2ps2 - 2.0 * static_cast<double>(params_.speed.max_deceleration_mps2) * way_m;
    Require(std::abs(Square(plan_.speed.back()) - left_m2ps2) <= 1e-4 * start_m2ps2);
  }

  // The whole footprint, at every point and on the way to the next; no point off the map.
  void CheckClear(const DrawnCells& cells) const {
    DiscWitness discs[] = {{cells, params_.vehicle, 1.0}, {cells, params_.vehicle, -1.0}};
    for (int k = 0; k < plan_.path.size(); ++k) {
      Require(cells.Contains(plan_.path[k]));
      for (DiscWitness& disc : discs) {
        disc.AtPoint(plan_.path[k], k >= plan_.check.overlap_points);
        if (k + 1 < plan_.path.size()) CheckWay(k, disc);
      }
    }
  }

  // Along the chord behind a point, and in the turn at its end.
  void CheckWay(int k, const DiscWitness& disc) const {
    const Pose2& from = plan_.path[k];
    const Pose2& to = plan_.path[k + 1];
    const double theta_rad = static_cast<double>(from.theta_rad);
    const double turn_rad = static_cast<double>(plan_.actuator.steps[k].phi_rad);
    constexpr double kPiece_m = 0.07;  // not theirs, so that it falls between theirs
    const int pieces = 1 + static_cast<int>(Way(plan_.actuator.steps[k]) / kPiece_m);
    for (int i = 1; i < pieces; ++i) {
      const double share = static_cast<double>(i) / pieces;
      disc.AtSample(std::lerp(static_cast<double>(from.x_m), static_cast<double>(to.x_m), share),
                    std::lerp(static_cast<double>(from.y_m), static_cast<double>(to.y_m), share),
                    theta_rad);
    }
    const double arc_m =
        std::abs(turn_rad) * static_cast<double>(params_.vehicle.footprint_disc_offset_m);
    const int turns = 1 + static_cast<int>(arc_m / kPiece_m);
    for (int i = 0; i < turns; ++i) {
      disc.AtSample(static_cast<double>(to.x_m), static_cast<double>(to.y_m),
                    theta_rad + turn_rad * i / turns);
    }
  }

  const PlannerParams& params_;
  const PathStart& start_;
  const Plan& plan_;
};

}  // namespace hardpack
