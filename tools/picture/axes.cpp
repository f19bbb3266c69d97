// SPDX-License-Identifier: Apache-2.0
#include "tools/picture/axes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace hardpack::picture {
namespace {

constexpr Colour kInk = {0.25, 0.25, 0.25};
constexpr double kTickText_px = 13.0;
constexpr double kPixelsPerTick = 70.0;

int WantedTicks(double length_px) {
  return std::clamp(static_cast<int>(length_px / kPixelsPerTick), 2, 12);
}

}  // namespace

std::vector<double> Ticks(Range range, int wanted) {
  const double rough = range.span() / std::max(wanted, 1);
  if (!(rough > 0.0) || !std::isfinite(rough)) return {};
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double factor = rough / power <= 1.0   ? 1.0
                        : rough / power <= 2.0 ? 2.0
                        : rough / power <= 5.0 ? 5.0
                                               : 10.0;
  const double step = factor * power;
  std::vector<double> ticks;
  const double first = std::ceil(range.low / step - 1.0e-9);
  const double last = std::floor(range.high / step + 1.0e-9);
  for (double i = first; i <= last; i += 1.0) ticks.push_back(i * step);
  return ticks;
}

std::string TickText(double value, double step) {
  const int digits = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1.0e-9)));
  std::array<char, 40> text = {};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value == 0.0 ? 0.0 : value);
  return text.data();
}

Axes::Axes(Canvas& canvas, const Rectangle& area, Range x, Range y)
    : canvas_(&canvas), area_(area), x_(x), y_(y) {
  if (!(x_.span() > 0.0)) x_ = x_.WidenedBy(0.5);
  if (!(y_.span() > 0.0)) y_ = y_.WidenedBy(0.5);
}

Axes Axes::OfMap(Canvas& canvas, const Rectangle& area, Range x, Range y) {
  const double units_per_px = std::max(x.span() / area.width_px, y.span() / area.height_px);
  const Range wide_x = x.WidenedBy((units_per_px * area.width_px - x.span()) / 2.0);
  const Range wide_y = y.WidenedBy((units_per_px * area.height_px - y.span()) / 2.0);
  return {canvas, area, wide_x, wide_y};
}

double Axes::X(double value) const {
  return area_.left_px + (value - x_.low) / x_.span() * area_.width_px;
}

double Axes::Y(double value) const {
  return area_.bottom_px() - (value - y_.low) / y_.span() * area_.height_px;
}

void Axes::Grid(const Colour& colour) {
  for (const double x : Ticks(x_, WantedTicks(area_.width_px))) {
    canvas_->Line(X(x), area_.top_px, X(x), area_.bottom_px(), colour, 1.0);
  }
  for (const double y : Ticks(y_, WantedTicks(area_.height_px))) {
    canvas_->Line(area_.left_px, Y(y), area_.right_px(), Y(y), colour, 1.0);
  }
}

void Axes::Frame(const std::string& title, const std::string& x_label, const std::string& y_label) {
  canvas_->Outline(area_, kInk, 1.2);
  const auto x_ticks = Ticks(x_, WantedTicks(area_.width_px));
  const auto y_ticks = Ticks(y_, WantedTicks(area_.height_px));
  const auto step = [](const std::vector<double>& ticks) {
    return ticks.size() > 1 ? ticks[1] - ticks[0] : 1.0;
  };
  for (const double x : x_ticks) {
    canvas_->Line(X(x), area_.bottom_px(), X(x), area_.bottom_px() + 5.0, kInk, 1.2);
    canvas_->Text(X(x), area_.bottom_px() + 19.0, TickText(x, step(x_ticks)),
                  {.size_px = kTickText_px, .align = Align::kCenter, .colour = kInk});
  }
  double widest_px = 0.0;
  for (const double y : y_ticks) {
    const TextStyle style = {.size_px = kTickText_px, .align = Align::kRight, .colour = kInk};
    const std::string text = TickText(y, step(y_ticks));
    canvas_->Line(area_.left_px - 5.0, Y(y), area_.left_px, Y(y), kInk, 1.2);
    canvas_->Text(area_.left_px - 8.0, Y(y) + 4.5, text, style);
    widest_px = std::max(widest_px, canvas_->TextWidth(text, style));
  }
  canvas_->Text(area_.left_px + area_.width_px / 2.0, area_.bottom_px() + 38.0, x_label,
                {.align = Align::kCenter});
  canvas_->Text(area_.left_px - widest_px - 17.0, area_.top_px + area_.height_px / 2.0, y_label,
                {.align = Align::kCenter, .angle_rad = -std::numbers::pi / 2.0});
  canvas_->Text(area_.left_px, area_.top_px - 9.0, title, {.size_px = 16.0, .bold = true});
}

void Axes::Line(std::span<const DataPoint> points, const LineStyle& style) {
  cairo_t* context = canvas_->context();
  cairo_new_path(context);
  for (const DataPoint& point : points) cairo_line_to(context, X(point.x), Y(point.y));
  SetColour(context, style.colour);
  cairo_set_line_width(context, style.line_px);
  const std::array<double, 2> dashes = {8.0, 6.0};
  if (style.dashed) cairo_set_dash(context, dashes.data(), 2, 0.0);
  cairo_stroke(context);
  cairo_set_dash(context, nullptr, 0, 0.0);
  if (style.dots_px <= 0.0) return;
  for (const DataPoint& point : points) {
    cairo_arc(context, X(point.x), Y(point.y), style.dots_px, 0.0, 2.0 * std::numbers::pi);
    cairo_fill(context);
  }
}

void Axes::Polygon(std::span<const DataPoint> points, const Colour& fill, const Colour& rim) {
  cairo_t* context = canvas_->context();
  cairo_new_path(context);
  for (const DataPoint& point : points) cairo_line_to(context, X(point.x), Y(point.y));
  cairo_close_path(context);
  SetColour(context, fill);
  cairo_fill_preserve(context);
  SetColour(context, rim);
  cairo_set_line_width(context, 2.0);
  cairo_stroke(context);
}

void Axes::HorizontalLine(double y, const LineStyle& style) {
  const std::array<DataPoint, 2> ends = {DataPoint{x_.low, y}, DataPoint{x_.high, y}};
  Line(ends, style);
}

void Axes::ClipBegin() {
  cairo_save(canvas_->context());
  cairo_rectangle(canvas_->context(), area_.left_px, area_.top_px, area_.width_px, area_.height_px);
  cairo_clip(canvas_->context());
}

void Axes::ClipEnd() {
  cairo_restore(canvas_->context());
}

}  // namespace hardpack::picture
