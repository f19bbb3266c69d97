// SPDX-License-Identifier: Apache-2.0
#include "tools/picture/quality_picture.h"

#include <algorithm>
#include <cmath>

#include "tools/picture/axes.h"
#include "tools/picture/cell_image.h"
#include "tools/picture/palette.h"
#include "tools/picture/plan_picture.h"

namespace hardpack::picture {
namespace {

constexpr int kWidth_px = 1640;
constexpr int kHeight_px = 1520;
constexpr Rectangle kMapArea = {78.0, 62.0, 900.0, 690.0};
// The three plots below the map: their tops, and their common layout.
constexpr std::array<double, 3> kPlotTops_px = {838.0, 1072.0, 1306.0};
constexpr Rectangle kPlotArea = {78.0, 0.0, 1530.0, 152.0};
constexpr double kMargin_px = 1016.0;  // left edge of the column beside the map
constexpr double kAround_m = 3.5;
constexpr double kShownLimits = 2.0;  // values beyond this many times their limit lie on the edge

// One for each curve, in their order: chosen to differ on grey, green and orange.
constexpr std::array<LineStyle, 6> kStyles = {{{.colour = kBasePath, .line_px = 1.8},
                                               {.colour = {0.80, 0.00, 0.70}, .line_px = 2.2},
                                               {.colour = {0.42, 0.05, 0.50}, .line_px = 2.2},
                                               {.colour = kOptimizedPath, .line_px = 4.4},
                                               {.colour = kInk, .line_px = 1.7},
                                               {.colour = {0.00, 0.62, 0.72}, .line_px = 1.7}}};
// The curves of the first plot; the others are the second one's.
constexpr size_t kInFirstPlot = 3;

constexpr std::array<const char*, 10> kFigureNames = {
    "F",      "of the map", "of the path",   "largest |κ| [1/m]",    "largest |κ′| [1/m²]",
    "limits", "length [m]", "clearance [m]", "angle/length [rad/m]", "time [ms]"};

size_t CurvesOf(const QualityPicture& picture) {
  return std::min(picture.curves.size(), kStyles.size());
}

std::vector<DataPoint> PointsOf(const WorldPath& path) {
  std::vector<DataPoint> points;
  for (const Pose2& pose : path) points.push_back({double{pose.x_m}, double{pose.y_m}});
  return points;
}

// The quantities of a path over the distance.
struct Courses {
  std::vector<DataPoint> curvature_per_m;
  std::vector<DataPoint> rate_per_m2;
};

Courses CoursesOf(const WorldPath& path, double start_curvature_per_m) {
  Courses courses;
  ActuatorPath actuator;
  if (!IsUsable(ToActuator<PlanarModel>(path, actuator))) return courses;
  double along_m = 0.0;
  double before_per_m = start_curvature_per_m;
  for (int i = 0; i + 1 < actuator.steps.size(); ++i) {
    const double here_m = std::abs(double{actuator.steps[i].dr_m});
    const double next_m = std::abs(double{actuator.steps[i + 1].dr_m});
    const double mean_m = (here_m + next_m) / 2.0;
    const double curvature_per_m = double{actuator.steps[i].phi_rad} / mean_m;
    along_m += here_m;
    courses.curvature_per_m.push_back({along_m, curvature_per_m});
    courses.rate_per_m2.push_back({along_m, (curvature_per_m - before_per_m) / mean_m});
    before_per_m = curvature_per_m;
  }
  return courses;
}

void DrawGoal(Canvas& canvas, const Axes& axes, const QualityPicture& picture) {
  const double x_px = axes.X(double{picture.goal_odom.x_m});
  const double y_px = axes.Y(double{picture.goal_odom.y_m});
  if (picture.goal_heading_rad) {
    constexpr double kArrow_px = 30.0;
    const double heading_rad = double{*picture.goal_heading_rad};
    canvas.Line(x_px, y_px, x_px + kArrow_px * std::cos(heading_rad),
                y_px - kArrow_px * std::sin(heading_rad), kGoal, 5.0);
  }
  canvas.Disc(x_px, y_px, 8.0, kGoal);
}

void DrawMap(Canvas& canvas, const QualityPicture& picture) {
  Range x = {double{picture.goal_odom.x_m}, double{picture.goal_odom.x_m}};
  Range y = {double{picture.goal_odom.y_m}, double{picture.goal_odom.y_m}};
  for (const QualityCurve& curve : picture.curves) {
    for (const Pose2& pose : curve.path) {
      x.Include(double{pose.x_m});
      y.Include(double{pose.y_m});
    }
  }
  Axes axes = Axes::OfMap(canvas, kMapArea, x.WidenedBy(kAround_m), y.WidenedBy(kAround_m));
  DrawCostmap(canvas, axes, *picture.map);
  axes.ClipBegin();
  for (size_t i = 0; i < CurvesOf(picture); ++i) {
    axes.Line(PointsOf(picture.curves[i].path), kStyles[i]);
  }
  DrawGoal(canvas, axes, picture);
  DrawVehicle(canvas, axes, picture.params->vehicle, picture.start.pose, {1.0, 1.0, 1.0, 0.6},
              kVehicle);
  axes.ClipEnd();
  DrawScaleBar(canvas, axes);
  axes.Frame("", "x [m]", "y [m]");
}

double DrawTable(Canvas& canvas, const QualityPicture& picture, double top_px) {
  constexpr double kFirst_px = 152.0;  // width of the names' column
  constexpr double kRow_px = 25.0;
  const double width_px =
      (kWidth_px - 22.0 - kMargin_px - kFirst_px) / static_cast<double>(kStyles.size());
  for (size_t row = 0; row < kFigureNames.size(); ++row) {
    canvas.Text(kMargin_px, top_px + kRow_px * static_cast<double>(row + 1), kFigureNames[row],
                {.size_px = 14.0, .colour = kFaintInk});
  }
  for (size_t i = 0; i < CurvesOf(picture); ++i) {
    const double right_px = kMargin_px + kFirst_px + width_px * static_cast<double>(i + 1);
    canvas.Line(right_px - 34.0, top_px - 4.0, right_px, top_px - 4.0, kStyles[i].colour,
                kStyles[i].line_px + 1.0);
    for (size_t row = 0; row < kFigureNames.size(); ++row) {
      const std::string& figure = picture.curves[i].figures[row];
      const bool is_bad = figure == "broken" || figure == "collides";
      canvas.Text(right_px, top_px + kRow_px * static_cast<double>(row + 1), figure,
                  {.size_px = 14.0, .align = Align::kRight, .colour = is_bad ? kBasePath : kInk});
    }
  }
  return top_px + kRow_px * static_cast<double>(kFigureNames.size() + 1);
}

void DrawLegend(Canvas& canvas, const QualityPicture& picture) {
  struct Patch {
    const char* text;
    Colour colour;
  };
  static constexpr std::array<Patch, 6> kPatches = {Patch{"free ground", kFree},
                                                    {"not observed", kNotObserved},
                                                    {"cost near obstacles (halo)", kRough},
                                                    {"lethal: too near a hard obstacle", kClosed},
                                                    {"hard obstacle", kHard},
                                                    {"soft obstacle", kSoft}};
  double y_px = kMapArea.top_px + 10.0;
  const auto label = [&canvas, &y_px](const std::string& text) {
    canvas.Text(kMargin_px + 46.0, y_px + 5.0, text, {.size_px = 15.0});
    y_px += 26.0;
  };
  for (size_t i = 0; i < CurvesOf(picture); ++i) {
    canvas.Line(kMargin_px, y_px, kMargin_px + 34.0, y_px, kStyles[i].colour,
                kStyles[i].line_px + 1.0);
    label(picture.curves[i].name);
  }
  for (const Patch& patch : kPatches) {
    const Rectangle box = {kMargin_px, y_px - 8.0, 34.0, 16.0};
    canvas.Fill(box, patch.colour);
    canvas.Outline(box, kFaintInk, 0.8);
    label(patch.text);
  }
  canvas.Disc(kMargin_px + 17.0, y_px, 8.0, kGoal);
  label("goal, with its heading where one is asked for");
  canvas.Outline({kMargin_px + 6.0, y_px - 8.0, 22.0, 16.0}, kVehicle, 2.0);
  canvas.Line(kMargin_px + 17.0, y_px, kMargin_px + 28.0, y_px, kVehicle, 2.0);
  label("start: outline and front of the vehicle");
  DrawTable(canvas, picture, y_px + 20.0);
}

struct Plot {
  double top_px;
  size_t first;  // curves first .. end - 1
  size_t end;
  std::vector<DataPoint> Courses::*course;
  double limit;
  std::string title;
  std::string y_label;
};

// The curves between lines at the limits.
void DrawPlot(Canvas& canvas, const QualityPicture& picture, const Plot& plot) {
  const double shown = kShownLimits * plot.limit;
  Range along = {0.0, 1.0};
  for (const QualityCurve& curve : picture.curves) along.Include(double{LengthOf(curve.path)});
  Rectangle area = kPlotArea;
  area.top_px = plot.top_px;
  Axes axes(canvas, area, along, {-shown, shown});
  axes.Grid(kGridLine);
  for (const double limit : {-plot.limit, plot.limit}) {
    axes.HorizontalLine(limit, {.colour = kBasePath, .line_px = 1.4, .dashed = true});
  }
  for (size_t i = plot.first; i < std::min(plot.end, CurvesOf(picture)); ++i) {
    const double start_per_m = double{picture.start.curvature_per_m};
    std::vector<DataPoint> points = CoursesOf(picture.curves[i].path, start_per_m).*plot.course;
    for (DataPoint& point : points) point.y = std::clamp(point.y, -shown, shown);
    axes.Line(points, kStyles[i]);
  }
  axes.Frame(plot.title, "distance along the path [m]", plot.y_label);
}

}  // namespace

Canvas DrawQuality(const QualityPicture& picture) {
  Canvas canvas(kWidth_px, kHeight_px);
  canvas.Text(kMapArea.left_px, 36.0, picture.title, {.size_px = 21.0, .bold = true});
  DrawMap(canvas, picture);
  DrawLegend(canvas, picture);
  const OptimizerParams& limits = picture.params->optimizer;
  const double curvature_per_m = double{limits.max_curvature_per_m};
  DrawPlot(canvas, picture,
           {kPlotTops_px[0], 0, kInFirstPlot, &Courses::curvature_per_m, curvature_per_m,
            "Curvature: A* alone and the paper's optimizer (limits dashed; what is beyond the "
            "frame lies on its edge)",
            "κ [1/m]"});
  DrawPlot(canvas, picture,
           {kPlotTops_px[1], kInFirstPlot, kStyles.size(), &Courses::curvature_per_m,
            curvature_per_m, "Curvature: hardpack and Ceres", "κ [1/m]"});
  DrawPlot(
      canvas, picture,
      {kPlotTops_px[2], kInFirstPlot - 1, kStyles.size() - 1, &Courses::rate_per_m2,
       double{limits.max_curvature_rate_per_m2},
       "Change of curvature: the paper's optimizer, converged, hardpack and Ceres", "κ′ [1/m²]"});
  return canvas;
}

}  // namespace hardpack::picture
