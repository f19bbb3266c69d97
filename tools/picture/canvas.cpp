// SPDX-License-Identifier: Apache-2.0
#include "tools/picture/canvas.h"

#include <fontconfig/fontconfig.h>

#include <numbers>
#include <stdexcept>

namespace hardpack::picture {

Colour Mix(const Colour& from, const Colour& to, double share) {
  const auto mixed = [share](double a, double b) { return a + (b - a) * share; };
  return {mixed(from.red, to.red), mixed(from.green, to.green), mixed(from.blue, to.blue),
          mixed(from.alpha, to.alpha)};
}

void SetColour(cairo_t* context, const Colour& colour) {
  cairo_set_source_rgba(context, colour.red, colour.green, colour.blue, colour.alpha);
}

void ReleaseFonts() {
  cairo_debug_reset_static_data();
  FcFini();
}

Canvas::Canvas(int width_px, int height_px)
    : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px)),
      context_(cairo_create(surface_.get())) {
  if (cairo_status(context_.get()) != CAIRO_STATUS_SUCCESS) {
    throw std::runtime_error("no memory for a picture");
  }
  SetColour(context(), {1.0, 1.0, 1.0});
  cairo_paint(context());
  cairo_set_line_join(context(), CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(context(), CAIRO_LINE_CAP_ROUND);
}

int Canvas::width_px() const {
  return cairo_image_surface_get_width(surface_.get());
}
int Canvas::height_px() const {
  return cairo_image_surface_get_height(surface_.get());
}

void Canvas::Fill(const Rectangle& area, const Colour& colour) {
  SetColour(context(), colour);
  cairo_rectangle(context(), area.left_px, area.top_px, area.width_px, area.height_px);
  cairo_fill(context());
}

void Canvas::Outline(const Rectangle& area, const Colour& colour, double line_px) {
  SetColour(context(), colour);
  cairo_set_line_width(context(), line_px);
  cairo_rectangle(context(), area.left_px, area.top_px, area.width_px, area.height_px);
  cairo_stroke(context());
}

void Canvas::Line(double x0_px, double y0_px, double x1_px, double y1_px, const Colour& colour,
                  double line_px) {
  SetColour(context(), colour);
  cairo_set_line_width(context(), line_px);
  cairo_move_to(context(), x0_px, y0_px);
  cairo_line_to(context(), x1_px, y1_px);
  cairo_stroke(context());
}

void Canvas::Disc(double x_px, double y_px, double radius_px, const Colour& colour) {
  cairo_new_path(context());
  cairo_arc(context(), x_px, y_px, radius_px, 0.0, 2.0 * std::numbers::pi);
  SetColour(context(), colour);
  cairo_fill_preserve(context());
  SetColour(context(), {0.1, 0.1, 0.1});
  cairo_set_line_width(context(), 1.0);
  cairo_stroke(context());
}

void Canvas::Select(const TextStyle& style) {
  cairo_select_font_face(context(), "sans", CAIRO_FONT_SLANT_NORMAL,
                         style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context(), style.size_px);
}

double Canvas::TextWidth(const std::string& text, const TextStyle& style) {
  Select(style);
  cairo_text_extents_t extents;
  cairo_text_extents(context(), text.c_str(), &extents);
  return extents.x_advance;
}

void Canvas::Text(double x_px, double y_px, const std::string& text, const TextStyle& style) {
  const double width = TextWidth(text, style);
  const double shift = style.align == Align::kLeft     ? 0.0
                       : style.align == Align::kCenter ? -width / 2.0
                                                       : -width;
  cairo_save(context());
  cairo_translate(context(), x_px, y_px);
  cairo_rotate(context(), style.angle_rad);
  SetColour(context(), style.colour);
  cairo_move_to(context(), shift, 0.0);
  cairo_show_text(context(), text.c_str());
  cairo_restore(context());
  cairo_new_path(context());
}

ReadOutcome Canvas::WritePng(const std::string& path) {
  cairo_surface_flush(surface_.get());
  const cairo_status_t status = cairo_surface_write_to_png(surface_.get(), path.c_str());
  if (status == CAIRO_STATUS_SUCCESS) return {};
  return {Status::kInvalidArgument,
          path + ": cannot be written (" + cairo_status_to_string(status) + ")"};
}

}  // namespace hardpack::picture
