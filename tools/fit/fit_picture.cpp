// SPDX-License-Identifier: Apache-2.0
#include "tools/fit/fit_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>

#include "tools/picture/axes.h"
#include "tools/picture/palette.h"

namespace hardpack::fit {
namespace {

using picture::Axes;
using picture::Canvas;
using picture::DataPoint;
using picture::LineStyle;

constexpr int kWidth_px = 1700;
constexpr int kHeight_px = 1020;
constexpr double kLeft_px = 76.0;
constexpr double kPlotWidth_px = 226.0;
constexpr double kPitch_px = 270.0;
constexpr double kPlotHeight_px = 390.0;
constexpr std::array<double, 2> kTops_px = {96.0, 556.0};
constexpr double kStockTrack_m = 1.6875;

constexpr LineStyle kRecorded = {.colour = picture::kInk, .line_px = 0.8, .dots_px = 3.4};
constexpr LineStyle kModel = {.colour = picture::kOptimizedPath, .line_px = 2.6};
constexpr LineStyle kPublished = {.colour = picture::kBasePath, .line_px = 1.8, .dashed = true};

// Of a window, at its middle.
struct Motion {
  std::vector<DataPoint> yaw_rate_radps;
  std::vector<DataPoint> speed_mps;
};

Motion RecordedMotion(const DriveSegment& segment) {
  Motion motion;
  for (const PoseWindow& window : WindowsOf(segment)) {
    const DriveSample& from = segment.samples[window.from];
    const DriveSample& to = segment.samples[window.to];
    const Displacement moved = DisplacementOf(PoseOf(from), PoseOf(to));
    const double middle_s = 0.5 * (from.t_s + to.t_s);
    motion.yaw_rate_radps.push_back({middle_s, YawRate_radps(segment, window)});
    motion.speed_mps.push_back({middle_s, moved.forward_m / (to.t_s - from.t_s)});
  }
  return motion;
}

Motion PredictedMotion(const DriveSegment& segment, const Track& track, double pose_age_s) {
  Motion motion;
  for (const PoseWindow& window : WindowsOf(segment)) {
    const DriveSample& from = segment.samples[window.from];
    const DriveSample& to = segment.samples[window.to];
    const Displacement moved =
        DisplacementOf(track.At(from.t_s - pose_age_s).pose, track.At(to.t_s - pose_age_s).pose);
    const double middle_s = 0.5 * (from.t_s + to.t_s);
    motion.yaw_rate_radps.push_back({middle_s, YawRate_radps(track, segment, window, pose_age_s)});
    motion.speed_mps.push_back({middle_s, moved.forward_m / (to.t_s - from.t_s)});
  }
  return motion;
}

void DrawLegend(Canvas& canvas) {
  double x_px = kLeft_px;
  const auto item = [&](const LineStyle& style, const std::string& text) {
    canvas.Line(x_px, 30.0, x_px + 36.0, 30.0, style.colour, style.line_px + 1.0);
    if (style.dots_px > 0.0) canvas.Disc(x_px + 18.0, 30.0, style.dots_px, style.colour);
    canvas.Text(x_px + 46.0, 35.0, text, {.size_px = 15.0});
    x_px += 400.0;
  };
  item(kRecorded, "recorded (lidar), windows of 0.5 s");
  item(kModel, "this model, from the setpoints alone");
  item(kPublished, "published first order, separation 1.6875 m");
}

void DrawPlot(Canvas& canvas, const picture::Rectangle& area, picture::Range y,
              const std::array<const std::vector<DataPoint>*, 3>& curves, const std::string& title,
              const std::string& y_label) {
  Axes axes(canvas, area, {0.0, 2.0}, y);
  axes.Grid(picture::kGridLine);
  axes.ClipBegin();
  axes.HorizontalLine(0.0, {.colour = picture::kFaintInk, .line_px = 0.8});
  axes.Line(*curves[2], kPublished);
  axes.Line(*curves[1], kModel);
  axes.Line(*curves[0], kRecorded);
  axes.ClipEnd();
  axes.Frame(title, "t [s]", y_label);
}

std::string SpeedsText(const sim::WheelSpeeds& speeds) {
  const auto text = [](double value) {
    const std::string digits = std::to_string(value);
    return digits.substr(0, digits.find('.') + 2);
  };
  return text(speeds.left_radps) + ", " + text(speeds.right_radps);
}

bool IsToChange(const DriveSegment& segment) {
  constexpr double kChange_radps = 4.0;
  const DriveSample& begin = segment.samples.front();
  return std::abs(begin.command.left_radps - begin.measured.left_radps) > kChange_radps ||
         std::abs(begin.command.right_radps - begin.measured.right_radps) > kChange_radps;
}

}  // namespace

Canvas DrawFit(const std::vector<DriveSegment>& segments, const VehicleFit& fit) {
  Canvas canvas(kWidth_px, kHeight_px);
  DrawLegend(canvas);
  Track track;
  for (size_t i = 0; i < std::min(segments.size(), kDrawnSegments); ++i) {
    const DriveSegment& segment = segments[i];
    const Motion recorded = RecordedMotion(segment);
    ModelPredictor(fit.params, sim::VehicleModel::kStep_s)(segment, track);
    const Motion model = PredictedMotion(segment, track, fit.pose_age_s);
    PredictFirstOrder({}, kStockTrack_m, segment, sim::VehicleModel::kStep_s, track);
    const Motion published = PredictedMotion(segment, track, fit.pose_age_s);
    const double left_px = kLeft_px + kPitch_px * static_cast<double>(i);
    const bool is_first = i == 0;
    DrawPlot(canvas, {left_px, kTops_px[0], kPlotWidth_px, kPlotHeight_px}, {-3.0, 3.0},
             {&recorded.yaw_rate_radps, &model.yaw_rate_radps, &published.yaw_rate_radps},
             std::string("segment ").append(std::to_string(segment.number)),
             is_first ? "yaw rate [rad/s]" : "");
    DrawPlot(canvas, {left_px, kTops_px[1], kPlotWidth_px, kPlotHeight_px}, {-4.5, 4.5},
             {&recorded.speed_mps, &model.speed_mps, &published.speed_mps}, "",
             is_first ? "forward speed [m/s]" : "");
    canvas.Text(left_px + kPlotWidth_px / 2.0, kHeight_px - 12.0,
                std::string("setpoints ")
                    .append(SpeedsText(segment.samples.back().command))
                    .append(" rad/s"),
                {.size_px = 13.0, .align = picture::Align::kCenter, .colour = picture::kFaintInk});
  }
  return canvas;
}

std::vector<DriveSegment> FromWorstToBest(const std::vector<DriveSegment>& segments,
                                          const VehicleFit& fit) {
  std::vector<std::pair<double, size_t>> order;
  ModelPredictor predict(fit.params, sim::VehicleModel::kStep_s);
  for (size_t i = 0; i < segments.size(); ++i) {
    const Predictor again = [&predict](const DriveSegment& segment, Track& track) {
      predict(segment, track);
    };
    const Errors errors = Evaluate({segments[i]}, again, fit.pose_age_s);
    order.emplace_back(-errors.yaw_rate_rms_radps, i);
  }
  const auto is_left_out = [&segments](const std::pair<double, size_t>& item) {
    return !IsToChange(segments[item.second]);
  };
  const auto changing = std::count_if(order.begin(), order.end(), std::not_fn(is_left_out));
  if (changing >= static_cast<std::ptrdiff_t>(kDrawnSegments)) std::erase_if(order, is_left_out);
  std::sort(order.begin(), order.end());
  std::vector<DriveSegment> chosen;
  const size_t count = std::min(kDrawnSegments, order.size());
  for (size_t i = 0; i < count; ++i) {
    const size_t place = count > 1 ? i * (order.size() - 1) / (count - 1) : 0;
    chosen.push_back(segments[order[place].second]);
  }
  return chosen;
}

}  // namespace hardpack::fit
