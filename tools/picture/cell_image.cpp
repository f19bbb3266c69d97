// SPDX-License-Identifier: Apache-2.0
#include "tools/picture/cell_image.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "tools/picture/palette.h"

namespace hardpack::picture {
namespace {

struct CellSpan {
  int first = 0;
  int count = 0;
};

CellSpan SpanOf(Range range, int origin_cell) {
  const double cells_per_meter = double{kCellsPerMeter};
  const auto clamped = [origin_cell](double cell) {
    return static_cast<int>(std::clamp(cell - origin_cell, 0.0, double{kMapSize_cells}));
  };
  const int first = clamped(std::floor(range.low * cells_per_meter));
  const int end = clamped(std::ceil(range.high * cells_per_meter));
  return {first, std::max(end - first, 0)};
}

uint32_t Packed(const Colour& colour) {
  const auto byte = [](double share) {
    return static_cast<uint32_t>(std::lround(std::clamp(share, 0.0, 1.0) * 255.0));
  };
  return (byte(colour.red) << 16) | (byte(colour.green) << 8) | byte(colour.blue);
}

}  // namespace

void DrawCells(Canvas& canvas, const Axes& axes, const GridWindow& window,
               const std::function<Colour(int)>& colour_of) {
  const CellSpan columns = SpanOf(axes.x(), window.origin.x);
  const CellSpan rows = SpanOf(axes.y(), window.origin.y);
  if (columns.count == 0 || rows.count == 0) return;
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, columns.count, rows.count),
      &cairo_surface_destroy);
  const int stride = cairo_image_surface_get_stride(surface.get()) / 4;
  auto* pixels = reinterpret_cast<uint32_t*>(cairo_image_surface_get_data(surface.get()));
  for (int row = 0; row < rows.count; ++row) {
    for (int column = 0; column < columns.count; ++column) {
      const int index = (rows.first + row) * kMapSize_cells + columns.first + column;
      // Pictures count rows downward, the grid upward.
      pixels[(rows.count - 1 - row) * stride + column] = Packed(colour_of(index));
    }
  }
  cairo_surface_mark_dirty(surface.get());

  const double cell_m = 1.0 / double{kCellsPerMeter};
  const double left_px = axes.X((window.origin.x + columns.first) * cell_m);
  const double top_px = axes.Y((window.origin.y + rows.first + rows.count) * cell_m);
  cairo_t* context = canvas.context();
  cairo_save(context);
  cairo_rectangle(context, axes.area().left_px, axes.area().top_px, axes.area().width_px,
                  axes.area().height_px);
  cairo_clip(context);
  cairo_translate(context, left_px, top_px);
  cairo_scale(context, axes.PixelsPerUnit() * cell_m, axes.PixelsPerUnit() * cell_m);
  cairo_set_source_surface(context, surface.get(), 0.0, 0.0);
  cairo_pattern_set_filter(cairo_get_source(context), CAIRO_FILTER_NEAREST);
  cairo_paint(context);
  cairo_restore(context);
}

void DrawPatches(Canvas& canvas, double left_px, double top_px, std::span<const Patch> patches) {
  const TextStyle style = {.size_px = 14.5};
  for (const Patch& patch : patches) {
    const Rectangle box = {left_px, top_px, 26.0, 15.0};
    canvas.Fill(box, patch.colour);
    canvas.Outline(box, kFaintInk, 0.8);
    canvas.Text(left_px + 34.0, top_px + 13.0, patch.text, style);
    left_px += 64.0 + canvas.TextWidth(patch.text, style);
  }
}

void DrawCostScale(Canvas& canvas, const Rectangle& panel, const std::string& most,
                   const std::string& what) {
  const Rectangle bar = {panel.right_px() + 10.0, panel.top_px + 22.0, 12.0, 150.0};
  for (double row = 0.0; row < bar.height_px; row += 1.0) {
    canvas.Fill({bar.left_px, bar.bottom_px() - row - 1.0, bar.width_px, 1.5},
                CostColour(row / bar.height_px));
  }
  canvas.Outline(bar, kFaintInk, 0.8);
  const TextStyle style = {.size_px = 12.0};
  canvas.Text(bar.right_px() + 4.0, bar.bottom_px() + 4.0, "0", style);
  canvas.Text(bar.right_px() + 4.0, bar.top_px + 6.0, most, style);
  canvas.Text(bar.left_px, bar.top_px - 10.0, what, style);
}

void DrawCostmap(Canvas& canvas, const Axes& axes, const Costmap& map) {
  canvas.Fill(axes.area(), kOffMap);
  DrawCells(canvas, axes, map.window,
            [&map](int index) { return CellColour(map.flags[index], map.cost_q8[index]); });
}

void DrawScaleBar(Canvas& canvas, const Axes& axes) {
  // The largest of 1, 2, 5, 10 ... that fits into a fifth of the width.
  const double fifth_m = axes.x().span() / 5.0;
  const double power = std::pow(10.0, std::floor(std::log10(fifth_m)));
  const double factor = fifth_m >= 5.0 * power ? 5.0 : fifth_m >= 2.0 * power ? 2.0 : 1.0;
  const double length_m = factor * power;
  const double length_px = length_m * axes.PixelsPerUnit();
  const double left_px = axes.area().left_px + 16.0;
  const double y_px = axes.area().bottom_px() - 18.0;
  canvas.Fill({left_px - 9.0, y_px - 26.0, length_px + 18.0, 36.0}, {1.0, 1.0, 1.0, 0.85});
  canvas.Fill({left_px, y_px - 2.5, length_px, 5.0}, kInk);
  canvas.Text(left_px + length_px / 2.0, y_px - 8.0, TickText(length_m, length_m) + " m",
              {.size_px = 14.0, .align = Align::kCenter, .bold = true});
}

}  // namespace hardpack::picture
