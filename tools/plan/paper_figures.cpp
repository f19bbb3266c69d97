// SPDX-License-Identifier: Apache-2.0
#include "tools/plan/paper_figures.h"

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "core/autonomy/planner.h"
#include "port_linux/command_line/command.h"
#include "tools/picture/axes.h"
#include "tools/picture/cell_image.h"
#include "tools/picture/cost_panels.h"
#include "tools/picture/palette.h"
#include "tools/plan/planner_run.h"

namespace hardpack::command {
namespace {

using picture::Axes;
using picture::Canvas;
using picture::DataPoint;
using picture::Rectangle;

// Cells whose middle lies in a rectangle get the flag.
struct Block {
  float low_x_m, low_y_m, high_x_m, high_y_m;
  uint8_t flag;
};

uint8_t FlagAt(const std::vector<Block>& blocks, Vec2 point) {
  for (const Block& block : blocks) {
    if (point.x_m >= block.low_x_m && point.x_m <= block.high_x_m && point.y_m >= block.low_y_m &&
        point.y_m <= block.high_y_m) {
      return block.flag | Costmap::kObserved;
    }
  }
  return Costmap::kObserved;
}

template <typename Builder>
void FillCells(Builder& builder, const GridWindow& window, const std::vector<Block>& blocks) {
  for (int i = 0; i < kMapCells; ++i) {
    builder.SetCell(i, FlagAt(blocks, CellCenter(window.FromIndex(i))));
  }
}

void RequireUsable(Status status, const char* what) {
  if (!IsUsable(status)) {
    throw CommandFailure(kWorkFailed, std::string(what) + ": " + StatusName(status));
  }
}

std::vector<DataPoint> PointsOf(const WorldPath& path) {
  std::vector<DataPoint> points;
  for (const Pose2& pose : path) points.push_back({double{pose.x_m}, double{pose.y_m}});
  return points;
}

ActuatorPath ActuatorOf(const WorldPath& path) {
  ActuatorPath actuator;
  RequireUsable(ToActuator<PlanarModel>(path, actuator), "actuator path");
  return actuator;
}

// Heading change at each point that has a chord on both sides: phi of step i turns at point i + 1.
std::vector<DataPoint> HeadingChanges(const ActuatorPath& path) {
  std::vector<DataPoint> points;
  for (int i = 0; i + 1 < path.steps.size(); ++i) {
    points.push_back({static_cast<double>(i + 1), double{path.steps[i].phi_rad}});
  }
  return points;
}

// Curvature at the end of each step over the distance: phi / mean length of the chords that meet.
std::vector<DataPoint> Curvatures(const ActuatorPath& path) {
  std::vector<DataPoint> points;
  double along_m = 0.0;
  for (int i = 0; i + 1 < path.steps.size(); ++i) {
    const double here_m = double{std::abs(path.steps[i].dr_m)};
    const double next_m = double{std::abs(path.steps[i + 1].dr_m)};
    along_m += here_m;
    points.push_back({along_m, double{path.steps[i].phi_rad} / ((here_m + next_m) / 2.0)});
  }
  return points;
}

struct LegendLine {
  const char* text;
  picture::Colour colour;
  bool dashed = false;
};

void DrawLegend(Canvas& canvas, double left_px, double y_px,
                const std::vector<LegendLine>& entries) {
  for (const LegendLine& entry : entries) {
    canvas.Line(left_px, y_px - 5.0, left_px + (entry.dashed ? 12.0 : 30.0), y_px - 5.0,
                entry.colour, 3.0);
    if (entry.dashed) {
      canvas.Line(left_px + 20.0, y_px - 5.0, left_px + 30.0, y_px - 5.0, entry.colour, 3.0);
    }
    canvas.Text(left_px + 38.0, y_px, entry.text, {.size_px = 15.0});
    left_px += 62.0 + canvas.TextWidth(entry.text, {.size_px = 15.0});
  }
}

picture::Range RangeOf(const std::vector<DataPoint>& points, double DataPoint::*member) {
  picture::Range range = {points.front().*member, points.front().*member};
  for (const DataPoint& point : points) range.Include(point.*member);
  return range;
}

std::unique_ptr<Planner> PlanAroundSquare(const PlannerParams& params) {
  const std::vector<Block> square = {{-2.5f, -2.5f, 2.5f, 2.5f, Costmap::kHard}};
  const GridWindow window = GridWindow::CenteredAt({});
  auto planner = std::make_unique<Planner>();
  PlanRequest request;
  request.start.pose = {-14.0f, -0.5f, 0.0f};
  request.goal_odom = {14.0f, -0.5f};
  RequireUsable(planner->BeginCells(window, params, request), "square");
  FillCells(planner->costmap_builder(), window, square);
  RunCellsToEnd(*planner);
  RequireUsable(planner->result().status, "square");
  return planner;
}

void DrawSquareWorld(Canvas& canvas, const Planner& planner) {
  Axes axes = Axes::OfMap(canvas, {80.0, 84.0, 1180.0, 560.0}, {-15.5, 15.5}, {-9.5, 5.0});
  picture::DrawCostmap(canvas, axes, planner.costmap());
  axes.ClipBegin();
  axes.Line(PointsOf(planner.result().base), {.colour = picture::kBasePath, .line_px = 3.0});
  axes.Line(PointsOf(planner.result().path), {.colour = picture::kOptimizedPath, .line_px = 3.5});
  canvas.Disc(axes.X(14.0), axes.Y(-0.5), 9.0, picture::kGoal);
  axes.ClipEnd();
  picture::DrawScaleBar(canvas, axes);
  axes.Frame("World space", "x [m]", "y [m]");
}

// Base path and optimized path over one another, with the limits of the optimized one.
void DrawTwo(Canvas& canvas, const Rectangle& area, const std::vector<DataPoint>& base,
             const std::vector<DataPoint>& optimized, double limit, const std::string& title,
             const std::string& x_label, const std::string& y_label) {
  picture::Range x = RangeOf(optimized, &DataPoint::x);
  x.Include(base.back().x);
  const picture::Range base_y = RangeOf(base, &DataPoint::y);
  picture::Range y = RangeOf(optimized, &DataPoint::y);
  for (const double value : {base_y.low, base_y.high, -limit, limit}) y.Include(value);
  Axes axes(canvas, area, x, y.WidenedBy(0.08 * y.span()));
  axes.Grid(picture::kGridLine);
  for (const double bound : {-limit, limit}) {
    axes.HorizontalLine(bound, {.colour = picture::kFaintInk, .line_px = 1.5, .dashed = true});
  }
  axes.Line(base, {.colour = picture::kBasePath, .line_px = 1.8});
  axes.Line(optimized, {.colour = picture::kOptimizedPath, .line_px = 2.6});
  axes.Frame(title, x_label, y_label);
}

// A gentle bend to the left, long enough for the window and a rest on both sides.
WorldPath GentleBend() {
  ActuatorPath bend;
  constexpr int kSteps = 40;
  for (int i = 0; i < kSteps; ++i) RequireUsable(bend.steps.PushBack({0.006f, 0.275f}), "bend");
  WorldPath path;
  RequireUsable(ToWorld<PlanarModel>(bend, path), "bend");
  return path;
}

WorldPath Perturbed(const WorldPath& path, bool damped) {
  constexpr int kStep = 5;
  constexpr float kDelta_rad = 0.5f;
  constexpr int kWindow = 25;
  WorldPath perturbed;
  RequireUsable(Perturb(path, kStep, kDelta_rad, kWindow, damped, perturbed), "perturbation");
  return perturbed;
}

}  // namespace

Canvas SquareFigure() {
  const PlannerParams params;
  const auto planner = PlanAroundSquare(params);
  const ActuatorPath base = ActuatorOf(planner->result().base);
  const ActuatorPath& optimized = planner->result().actuator;
  Canvas canvas(1300, 1130);
  canvas.Text(80.0, 36.0, "A path around a square obstacle in world and in actuator space",
              {.size_px = 20.0, .bold = true});
  DrawLegend(canvas, 720.0, 68.0,
             {{"base path (A*)", picture::kBasePath},
              {"optimized path", picture::kOptimizedPath},
              {"curvature limit", picture::kFaintInk, true}});
  DrawSquareWorld(canvas, *planner);
  const double max_curvature_per_m = double{params.optimizer.max_curvature_per_m};
  DrawTwo(canvas, {80.0, 736.0, 530.0, 330.0}, HeadingChanges(base), HeadingChanges(optimized),
          max_curvature_per_m * double{params.path.step_m}, "Actuator space: heading change",
          "point i", "φ [rad]");
  DrawTwo(canvas, {730.0, 736.0, 530.0, 330.0}, Curvatures(base), Curvatures(optimized),
          max_curvature_per_m, "The same per metre: curvature", "distance along the path [m]",
          "κ [1/m]");
  return canvas;
}

Canvas PerturbationFigure() {
  struct Curve {
    WorldPath path;
    picture::LineStyle style;
  };
  const WorldPath path = GentleBend();
  const std::array<Curve, 3> curves = {
      Curve{path, {.colour = picture::kUnperturbed, .line_px = 5.0, .dots_px = 4.5}},
      Curve{Perturbed(path, false), {.colour = picture::kBasePath, .line_px = 3.2, .dots_px = 3.6}},
      Curve{Perturbed(path, true),
            {.colour = picture::kOptimizedPath, .line_px = 1.8, .dots_px = 2.8}}};
  Canvas canvas(1500, 700);
  canvas.Text(80.0, 36.0, "A perturbation of 0.5 rad at step 5, damped over N = 25 steps",
              {.size_px = 20.0, .bold = true});
  DrawLegend(canvas, 80.0, 68.0,
             {{"unperturbed", picture::kUnperturbed},
              {"perturbed, no correction", picture::kBasePath},
              {"perturbed, with correction", picture::kOptimizedPath}});
  Axes actuator(canvas, {90.0, 112.0, 600.0, 510.0}, {0.0, 40.0}, {-0.14, 0.56});
  actuator.Grid(picture::kGridLine);
  for (const Curve& curve : curves) {
    actuator.Line(HeadingChanges(ActuatorOf(curve.path)), curve.style);
  }
  actuator.Frame("Actuator space", "point i", "heading change φ [rad]");
  Axes world = Axes::OfMap(canvas, {790.0, 112.0, 670.0, 510.0}, {-0.4, 11.4}, {-1.0, 6.6});
  world.Grid(picture::kGridLine);
  for (const Curve& curve : curves) world.Line(PointsOf(curve.path), curve.style);
  world.Frame("World space", "x [m]", "y [m]");
  return canvas;
}

Canvas CostmapFigure() {
  const std::vector<Block> blocks = {
      {-5.0f, -6.5f, -4.8f, 0.6f, Costmap::kHard}, {-5.0f, 3.4f, -4.8f, 7.5f, Costmap::kHard},
      {1.0f, 2.0f, 3.0f, 4.0f, Costmap::kHard},    {4.4f, -1.2f, 4.8f, -0.8f, Costmap::kHard},
      {2.2f, 4.2f, 5.0f, 5.6f, Costmap::kSoft},    {-1.5f, -5.5f, 2.0f, -2.5f, Costmap::kSoft}};
  const GridWindow window = GridWindow::CenteredAt({});
  const CostmapParams params;
  const auto builder = std::make_unique<CostmapBuilder>();
  RequireUsable(builder->BeginCells(window, params), "costmap");
  FillCells(*builder, window, blocks);
  while (builder->StepCells(CostmapBuilder::kUnits) == Progress::kBusy) {
  }
  return picture::DrawCostPanels(builder->result(), params, {-9.0, 9.0}, {-9.0, 9.0},
                                 "The costmap, step by step");
}

}  // namespace hardpack::command
