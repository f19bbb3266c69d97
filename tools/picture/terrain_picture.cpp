// SPDX-License-Identifier: Apache-2.0
#include "tools/picture/terrain_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "tools/picture/cell_image.h"
#include "tools/picture/palette.h"

namespace hardpack::picture {
namespace {

constexpr int kWidth_px = 1560;
constexpr int kHeight_px = 840;
constexpr double kPanel_px = 640.0;
constexpr double kTop_px = 128.0;
constexpr double kLeft_px[] = {80.0, 840.0};

void DrawBar(Canvas& canvas, const Rectangle& panel, const std::string& most,
             const std::string& unit) {
  const Rectangle bar = {panel.right_px() + 10.0, panel.top_px + 22.0, 12.0, 150.0};
  for (double row = 0.0; row < bar.height_px; row += 1.0) {
    canvas.Fill({bar.left_px, bar.bottom_px() - row - 1.0, bar.width_px, 1.5},
                CostColour(row / bar.height_px));
  }
  canvas.Outline(bar, kFaintInk, 0.8);
  const TextStyle style = {.size_px = 12.0};
  canvas.Text(bar.right_px() + 4.0, bar.bottom_px() + 4.0, "0", style);
  canvas.Text(bar.right_px() + 4.0, bar.top_px + 6.0, most, style);
  canvas.Text(bar.left_px, bar.top_px - 10.0, unit, style);
}

void DrawLegend(Canvas& canvas) {
  struct Patch {
    const char* text;
    Colour colour;
  };
  static constexpr std::array<Patch, 3> kPatches = {Patch{"too steep: an obstacle", kHard},
                                                    {"no plane: too few heights", kNotObserved},
                                                    {"off the map", kOffMap}};
  double left_px = kLeft_px[0];
  for (const Patch& patch : kPatches) {
    const Rectangle box = {left_px, 56.0, 26.0, 15.0};
    canvas.Fill(box, patch.colour);
    canvas.Outline(box, kFaintInk, 0.8);
    canvas.Text(left_px + 34.0, 69.0, patch.text, {.size_px = 14.5});
    left_px += 64.0 + canvas.TextWidth(patch.text, {.size_px = 14.5});
  }
}

}  // namespace

Rectangle TerrainPanel(int panel) {
  return {kLeft_px[panel], kTop_px, kPanel_px, kPanel_px};
}

Canvas DrawTerrain(const Terrain& terrain, const GridWindow& window, Range x, Range y,
                   const std::string& title) {
  Canvas canvas(kWidth_px, kHeight_px);
  canvas.Text(kLeft_px[0], 38.0, title, {.size_px = 20.0, .bold = true});
  DrawLegend(canvas);
  const auto draw = [&](int panel, const std::string& caption,
                        const std::function<double(const Terrain::Ground&)>& share_of) {
    Axes axes = Axes::OfMap(canvas, TerrainPanel(panel), x, y);
    canvas.Fill(axes.area(), kOffMap);
    DrawCells(canvas, axes, window, [&](int index) {
      const Terrain::Ground ground = terrain.At(index);
      if (!ground.is_told) return kNotObserved;
      return ground.is_too_steep ? kHard : CostColour(std::min(share_of(ground), 1.0));
    });
    DrawScaleBar(canvas, axes);
    axes.Frame(caption, "x [m]", "y [m]");
  };
  draw(0, "Grade: rise per metre", [](const Terrain::Ground& ground) {
    return std::hypot(double{ground.grade_x}, double{ground.grade_y}) / kDarkestGrade;
  });
  draw(1, "Roughness: deviation from the plane of 1 m", [](const Terrain::Ground& ground) {
    return double{ground.roughness_m} / kDarkestRoughness_m;
  });
  DrawBar(canvas, TerrainPanel(0), TickText(kDarkestGrade, 0.1), "grade");
  DrawBar(canvas, TerrainPanel(1), TickText(kDarkestRoughness_m, 0.1), "[m]");
  return canvas;
}

}  // namespace hardpack::picture
