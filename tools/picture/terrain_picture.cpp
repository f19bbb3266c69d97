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

constexpr std::array<Patch, 3> kPatches = {Patch{"too steep: an obstacle", kHard},
                                           {"no plane: too few heights", kNotObserved},
                                           {"off the map", kOffMap}};

}  // namespace

Rectangle TerrainPanel(int panel) {
  return {kLeft_px[panel], kTop_px, kPanel_px, kPanel_px};
}

Canvas DrawTerrain(const Terrain& terrain, const GridWindow& window, Range x, Range y,
                   const std::string& title) {
  Canvas canvas(kWidth_px, kHeight_px);
  canvas.Text(kLeft_px[0], 38.0, title, {.size_px = 20.0, .bold = true});
  DrawPatches(canvas, kLeft_px[0], 56.0, kPatches);
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
  DrawCostScale(canvas, TerrainPanel(0), TickText(kDarkestGrade, 0.1), "grade");
  DrawCostScale(canvas, TerrainPanel(1), TickText(kDarkestRoughness_m, 0.1), "[m]");
  return canvas;
}

}  // namespace hardpack::picture
