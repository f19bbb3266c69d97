// SPDX-License-Identifier: Apache-2.0
#include "tools/picture/plan_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/footprint.h"
#include "tools/picture/axes.h"
#include "tools/picture/cell_image.h"
#include "tools/picture/palette.h"

namespace hardpack::picture {
namespace {

constexpr int kWidth_px = 1480;
constexpr int kHeight_px = 1060;
constexpr Rectangle kMapArea = {78.0, 62.0, 1000.0, 930.0};
constexpr double kMargin_px = 1112.0;  // left edge of the column beside the map
constexpr double kAround_m = 4.0;      // shown around everything of interest
constexpr double kSmallestView_m = 16.0;

std::vector<DataPoint> PointsOf(const WorldPath& path) {
  std::vector<DataPoint> points;
  for (const Pose2& pose : path) points.push_back({double{pose.x_m}, double{pose.y_m}});
  return points;
}

std::array<DataPoint, 4> Footprint(const VehicleParams& vehicle, const Pose2& pose) {
  const double front_m = double{FrontOf(vehicle)};
  const double rear_m = double{RearOf(vehicle)};
  const double half_width_m = double{vehicle.width_m} / 2.0;
  const double cosine = std::cos(double{pose.theta_rad});
  const double sine = std::sin(double{pose.theta_rad});
  std::array<DataPoint, 4> corners = {DataPoint{front_m, half_width_m},
                                      {rear_m, half_width_m},
                                      {rear_m, -half_width_m},
                                      {front_m, -half_width_m}};
  for (DataPoint& corner : corners) {
    corner = {double{pose.x_m} + cosine * corner.x - sine * corner.y,
              double{pose.y_m} + sine * corner.x + cosine * corner.y};
  }
  return corners;
}

void DrawPathsAndMarks(Canvas& canvas, Axes& axes, const PlanPicture& picture) {
  const Plan& plan = *picture.plan;
  axes.ClipBegin();
  // The vehicle's outline every 3 m or so, faintly, so that tight places can be judged.
  constexpr double kFootprintEvery_m = 3.0;
  double since_m = 0.0;
  for (int i = 1; i < plan.path.size(); ++i) {
    since_m += double{std::abs(plan.actuator.steps[i - 1].dr_m)};
    if (since_m < kFootprintEvery_m && i + 1 < plan.path.size()) continue;
    since_m = 0.0;
    axes.Polygon(Footprint(picture.params->vehicle, plan.path[i]), {0.05, 0.20, 0.90, 0.06},
                 {0.05, 0.20, 0.90, 0.30});
  }
  axes.Line(PointsOf(plan.base), {.colour = kBasePath, .line_px = 2.6});
  axes.Line(PointsOf(plan.path), {.colour = kOptimizedPath, .line_px = 3.2});
  canvas.Disc(axes.X(double{picture.request.goal_odom.x_m}),
              axes.Y(double{picture.request.goal_odom.y_m}), 9.0, kGoal);
  DrawVehicle(canvas, axes, picture.params->vehicle, picture.request.start.pose,
              {1.0, 1.0, 1.0, 0.75}, kVehicle);
  axes.ClipEnd();
}

double DrawLegend(Canvas& canvas, double top_px) {
  struct Patch {
    const char* text;
    Colour colour;
  };
  static constexpr std::array<Patch, 8> kPatches = {Patch{"free ground", kFree},
                                                    {"not observed", kNotObserved},
                                                    {"rough: cost near obstacles", kRough},
                                                    {"closed: too near a hard obstacle", kClosed},
                                                    {"hard obstacle", kHard},
                                                    {"soft obstacle", kSoft},
                                                    {"person", kPerson},
                                                    {"off the map", kOffMap}};
  static constexpr std::array<Patch, 2> kLines = {
      Patch{"base path (A*)", kBasePath},
      {"optimized path, outline of the vehicle", kOptimizedPath}};
  double y_px = top_px;
  const auto label = [&canvas, &y_px](const char* text) {
    canvas.Text(kMargin_px + 42.0, y_px + 5.0, text, {.size_px = 14.5});
    y_px += 25.0;
  };
  for (const Patch& patch : kPatches) {
    const Rectangle box = {kMargin_px, y_px - 8.0, 30.0, 16.0};
    canvas.Fill(box, patch.colour);
    canvas.Outline(box, kFaintInk, 0.8);
    label(patch.text);
  }
  for (const Patch& line : kLines) {
    canvas.Line(kMargin_px + 2.0, y_px, kMargin_px + 28.0, y_px, line.colour, 3.2);
    label(line.text);
  }
  canvas.Disc(kMargin_px + 15.0, y_px, 8.0, kGoal);
  label("goal");
  canvas.Outline({kMargin_px + 4.0, y_px - 8.0, 22.0, 16.0}, kVehicle, 2.0);
  canvas.Line(kMargin_px + 15.0, y_px, kMargin_px + 26.0, y_px, kVehicle, 2.0);
  label("start: outline and front of the vehicle");
  return y_px;
}

double DrawFigures(Canvas& canvas, const PlanPicture& picture, double top_px) {
  double y_px = top_px;
  for (const auto& [what, value] : picture.figures) {
    canvas.Text(kMargin_px, y_px, what, {.size_px = 14.0, .colour = kFaintInk});
    canvas.Text(kWidth_px - 22.0, y_px, value, {.size_px = 14.0, .align = Align::kRight});
    y_px += 22.0;
  }
  return y_px;
}

void DrawSpeed(Canvas& canvas, const PlanPicture& picture, double top_px) {
  const Plan& plan = *picture.plan;
  if (plan.speed.size() < 2 || plan.speed.size() != plan.path.size()) return;
  std::vector<DataPoint> speed;
  double along_m = 0.0;
  for (int i = 0; i < plan.speed.size(); ++i) {
    if (i > 0) along_m += double{std::abs(plan.actuator.steps[i - 1].dr_m)};
    speed.push_back({along_m, double{plan.speed[i]}});
  }
  const Rectangle area = {kMargin_px + 42.0, top_px, kWidth_px - kMargin_px - 70.0,
                          kMapArea.bottom_px() - top_px};
  Axes axes(canvas, area, {0.0, along_m}, {0.0, double{picture.params->speed.max_speed_mps} * 1.1});
  axes.Grid(kGridLine);
  axes.Line(speed, {.colour = kOptimizedPath});
  axes.Frame("Planned speed", "distance along the path [m]", "speed [m/s]");
}

}  // namespace

void DrawVehicle(Canvas& canvas, Axes& axes, const VehicleParams& vehicle, const Pose2& pose,
                 const Colour& fill, const Colour& rim) {
  axes.Polygon(Footprint(vehicle, pose), fill, rim);
  const double front_m = double{FrontOf(vehicle)};
  canvas.Line(axes.X(double{pose.x_m}), axes.Y(double{pose.y_m}),
              axes.X(double{pose.x_m} + front_m * std::cos(double{pose.theta_rad})),
              axes.Y(double{pose.y_m} + front_m * std::sin(double{pose.theta_rad})), rim, 2.0);
}

void FindView(const PlanPicture& picture, Range& x, Range& y) {
  const Pose2& start = picture.request.start.pose;
  x = {double{start.x_m}, double{start.x_m}};
  y = {double{start.y_m}, double{start.y_m}};
  const auto include = [&x, &y](float x_m, float y_m) {
    x.Include(double{x_m});
    y.Include(double{y_m});
  };
  // A goal far off the map would shrink everything else to nothing, so the view leaves it out.
  const GridWindow& window = picture.map->window;
  if (window.Contains(CellAt(picture.request.goal_odom))) {
    include(picture.request.goal_odom.x_m, picture.request.goal_odom.y_m);
  }
  for (const Pose2& pose : picture.plan->base) include(pose.x_m, pose.y_m);
  for (const Pose2& pose : picture.plan->path) include(pose.x_m, pose.y_m);
  const auto grown = [](Range range) {
    return range.WidenedBy(kAround_m + std::max(kSmallestView_m - range.span(), 0.0) / 2.0);
  };
  x = grown(x);
  y = grown(y);
}

Canvas DrawPlan(const PlanPicture& picture) {
  Canvas canvas(kWidth_px, kHeight_px);
  Range x;
  Range y;
  FindView(picture, x, y);
  Axes axes = Axes::OfMap(canvas, kMapArea, x, y);
  DrawCostmap(canvas, axes, *picture.map);
  DrawPathsAndMarks(canvas, axes, picture);
  DrawScaleBar(canvas, axes);
  axes.Frame("", "x [m]", "y [m]");
  canvas.Text(kMapArea.left_px, 36.0, picture.title, {.size_px = 21.0, .bold = true});
  const double legend_end_px = DrawLegend(canvas, kMapArea.top_px + 10.0);
  const double figures_end_px = DrawFigures(canvas, picture, legend_end_px + 18.0);
  DrawSpeed(canvas, picture, std::min(figures_end_px + 36.0, kMapArea.bottom_px() - 120.0));
  return canvas;
}

}  // namespace hardpack::picture
