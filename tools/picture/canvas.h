// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cairo.h>

#include <memory>
#include <string>

#include "port_linux/files/read_outcome.h"

// A picture in memory, drawn with cairo and written as PNG. Lengths are pixels, y points down.

namespace hardpack::picture {

struct Colour {
  double red = 0.0;
  double green = 0.0;
  double blue = 0.0;
  double alpha = 1.0;
};

// Linear interpolation between two colours; 0 gives `from`, 1 gives `to`.
Colour Mix(const Colour& from, const Colour& to, double share);

enum class Align { kLeft, kCenter, kRight };

struct TextStyle {
  double size_px = 15.0;
  Align align = Align::kLeft;
  Colour colour = {0.10, 0.10, 0.10};
  bool bold = false;
  double angle_rad = 0.0;  // clockwise, as y points down
};

struct Rectangle {
  double left_px = 0.0;
  double top_px = 0.0;
  double width_px = 0.0;
  double height_px = 0.0;

  double right_px() const { return left_px + width_px; }
  double bottom_px() const { return top_px + height_px; }
};

class Canvas {
 public:
  // White.
  Canvas(int width_px, int height_px);

  int width_px() const;
  int height_px() const;
  cairo_t* context() { return context_.get(); }

  void Fill(const Rectangle& area, const Colour& colour);
  void Outline(const Rectangle& area, const Colour& colour, double line_px);
  void Line(double x0_px, double y0_px, double x1_px, double y1_px, const Colour& colour,
            double line_px);
  // A filled circle with a thin dark rim.
  void Disc(double x_px, double y_px, double radius_px, const Colour& colour);
  // (x, y) is the left, middle or right end of the base line.
  void Text(double x_px, double y_px, const std::string& text, const TextStyle& style);
  double TextWidth(const std::string& text, const TextStyle& style);

  // kInvalidArgument, and a line that names the path, if it cannot be written.
  ReadOutcome WritePng(const std::string& path);

 private:
  struct Destroy {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
    void operator()(cairo_t* context) const { cairo_destroy(context); }
  };
  void Select(const TextStyle& style);

  std::unique_ptr<cairo_surface_t, Destroy> surface_;
  std::unique_ptr<cairo_t, Destroy> context_;
};

void SetColour(cairo_t* context, const Colour& colour);

// Frees the caches of the font libraries, so that a leak checker finds nothing. For the end of a
// program, when no Canvas is left.
void ReleaseFonts();

}  // namespace hardpack::picture
