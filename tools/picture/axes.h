// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/picture/canvas.h"

// A plot's frame: maps numbers to the canvas, with ticks, labels, lines and marks.

namespace hardpack::picture {

struct Range {
  double low = 0.0;
  double high = 1.0;

  double span() const { return high - low; }
  void Include(double value) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  Range WidenedBy(double margin) const { return {low - margin, high + margin}; }
};

struct DataPoint {
  double x = 0.0;
  double y = 0.0;
};

struct LineStyle {
  Colour colour;
  double line_px = 2.5;
  bool dashed = false;
  double dots_px = 0.0;  // radius of a dot at every point; 0: none
};

class Axes {
 public:
  // `area` contains only the data; ticks and labels lie outside it.
  Axes(Canvas& canvas, const Rectangle& area, Range x, Range y);

  // The same scale on both axes, as for a map: the ranges are widened to the area's shape.
  static Axes OfMap(Canvas& canvas, const Rectangle& area, Range x, Range y);

  const Rectangle& area() const { return area_; }
  Range x() const { return x_; }
  Range y() const { return y_; }
  double X(double value) const;
  double Y(double value) const;
  double PixelsPerUnit() const { return area_.width_px / x_.span(); }

  void Grid(const Colour& colour);
  // Frame, ticks with their numbers, and the labels with their units.
  void Frame(const std::string& title, const std::string& x_label, const std::string& y_label);
  void Line(std::span<const DataPoint> points, const LineStyle& style);
  void Polygon(std::span<const DataPoint> points, const Colour& fill, const Colour& rim);
  void HorizontalLine(double y, const LineStyle& style);
  // Clips to the area, until ClipEnd.
  void ClipBegin();
  void ClipEnd();

 private:
  Canvas* canvas_;
  Rectangle area_;
  Range x_;
  Range y_;
};

// Round values within the range, about `wanted` of them: 1, 2 or 5 times a power of ten apart.
std::vector<double> Ticks(Range range, int wanted);

// The fewest digits that show the step between two ticks.
std::string TickText(double value, double step);

}  // namespace hardpack::picture
