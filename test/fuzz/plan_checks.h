// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "config/parameters.h"
#include "core/autonomy/planner.h"
#include "test/core/safety/rectangle.h"
#include "test/fuzz/mapper_script.h"

// What the headers promise of a usable plan, held against the plan and the cells that were drawn
// alone, in double: neither the costmap nor a stage is asked.

namespace hardpack {

// The drawn cells, and how far an outline is from the hard ones.
struct DrawnCells {
  GridWindow window;
  const uint8_t* flags;  // [kMapCells]

  bool Contains(const Pose2& pose) const { return window.Contains(CellAt({pose.x_m, pose.y_m})); }

  // The least distance of the outline to the square of a hard cell; and to those only that are
  // further than `beyond_m` from another outline [m]. At most a cell or so.
  double Clearance(const Quad& outline, const Quad* other = nullptr, double beyond_m = 0.0) const {
    constexpr double kCell_m = 0.2;
    double low_x = 1e9, low_y = 1e9, high_x = -1e9, high_y = -1e9;
    for (const TestPoint& corner : outline) {
      low_x = std::min(low_x, corner.x);
      low_y = std::min(low_y, corner.y);
      high_x = std::max(high_x, corner.x);
      high_y = std::max(high_y, corner.y);
    }
    const auto cell_of = [](double m) { return static_cast<int>(std::floor(m / kCell_m)); };
    double nearest = kCell_m;
    for (int y = cell_of(low_y) - 1; y <= cell_of(high_y) + 1; ++y) {
      for (int x = cell_of(low_x) - 1; x <= cell_of(high_x) + 1; ++x) {
        if (!IsHard({x, y})) continue;
        const Quad box = BoxQuad(kCell_m * x, kCell_m * y, kCell_m * (x + 1), kCell_m * (y + 1));
        if (other != nullptr && DistanceBetween(*other, box) <= beyond_m) continue;
        nearest = std::min(nearest, DistanceBetween(outline, box));
      }
    }
    return nearest;
  }

 private:
  bool IsHard(Cell cell) const {
    if (!window.Contains(cell)) return false;
    constexpr uint8_t kHards = Costmap::kHard | Costmap::kPerson;
    return (flags[window.Index(cell)] & kHards) != 0;
  }
};

// The outline along the path: it may drive out of what it stands in, and into nothing else
// (core/safety/path_check.h).
class OutlineWitness {
 public:
  OutlineWitness(const DrawnCells& cells, const PlannerParams& params, const Pose2& start)
      : cells_(cells),
        vehicle_(params.vehicle),
        margin_m_(static_cast<double>(params.path.margin_m)),
        start_(At(static_cast<double>(start.x_m), static_cast<double>(start.y_m),
                  static_cast<double>(start.theta_rad))) {}

  // A pose, and whether the check says that it is clear of its start there. Between two that it has
  // looked at the margin may be less by half of what a sample's turn moves.
  void Judge(double x_m, double y_m, double theta_rad, bool clear) const {
    const Quad outline = At(x_m, y_m, theta_rad);
    if (clear) {
      Require(cells_.Clearance(outline) >= std::min(margin_m_, 0.2) - kRounding_m);
      return;
    }
    // What was not near it at the start it does not touch.
    const double deeper_m = static_cast<double>(PathCheck::kDeeperTolerance_m) + kBetween_m;
    Require(cells_.Clearance(outline, &start_, deeper_m) > 0.0 || margin_m_ == 0.0);
  }

 private:
  static constexpr double kRounding_m = 1e-3;
  static constexpr double kBetween_m = 0.03;

  Quad At(double x_m, double y_m, double theta_rad) const {
    return OutlineQuad(vehicle_, x_m, y_m, theta_rad);
  }

  const DrawnCells& cells_;
  const VehicleParams& vehicle_;
  double margin_m_;
  Quad start_;
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

  // The whole outline, at every point and on the way to the next; no point off the map.
  void CheckClear(const DrawnCells& cells) const {
    // Nothing is driven where it stays, but for a turn.
    if (plan_.stays && !plan_.pivots_last) return;
    const OutlineWitness witness(cells, params_, plan_.path[0]);
    for (int k = 0; k < plan_.path.size(); ++k) {
      Require(cells.Contains(plan_.path[k]));
      if (k + 1 < plan_.path.size()) CheckWay(k, witness);
    }
  }

  // Along the chord behind a point, and in the turn at its end.
  void CheckWay(int k, const OutlineWitness& witness) const {
    const Pose2& from = plan_.path[k];
    const Pose2& to = plan_.path[k + 1];
    const bool clear = k >= plan_.check.overlap_points;
    const double theta_rad = static_cast<double>(from.theta_rad);
    const double turn_rad = static_cast<double>(plan_.actuator.steps[k].phi_rad);
    constexpr double kPiece_m = 0.07;  // not theirs, so that it falls between theirs
    const int pieces = 1 + static_cast<int>(Way(plan_.actuator.steps[k]) / kPiece_m);
    for (int i = 0; i < pieces; ++i) {
      const double share = static_cast<double>(i) / pieces;
      witness.Judge(std::lerp(static_cast<double>(from.x_m), static_cast<double>(to.x_m), share),
                    std::lerp(static_cast<double>(from.y_m), static_cast<double>(to.y_m), share),
                    theta_rad, clear);
    }
    const double arc_m = std::abs(turn_rad) * static_cast<double>(PivotRadiusOf(params_.vehicle));
    const int turns = 1 + static_cast<int>(arc_m / kPiece_m);
    for (int i = 0; i < turns; ++i) {
      witness.Judge(static_cast<double>(to.x_m), static_cast<double>(to.y_m),
                    theta_rad + turn_rad * i / turns, clear);
    }
  }

  const PlannerParams& params_;
  const PathStart& start_;
  const Plan& plan_;
};

}  // namespace hardpack
