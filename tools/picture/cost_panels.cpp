// SPDX-License-Identifier: Apache-2.0
#include "tools/picture/cost_panels.h"

#include <algorithm>
#include <array>
#include <functional>
#include <memory>

#include "tools/picture/cell_image.h"
#include "tools/picture/palette.h"

namespace hardpack::picture {
namespace {

constexpr int kWidth_px = 1500;
constexpr int kHeight_px = 1100;
constexpr double kPanel_px = 376.0;

Rectangle PanelArea(int index) {
  const double left_px = 80.0 + 482.0 * (index % 3);
  const double top_px = 118.0 + 484.0 * (index / 3);
  return {left_px, top_px, kPanel_px, kPanel_px};
}

// The map of only the cells that have one of `flags`.
std::unique_ptr<CostmapBuilder> BuildLayer(const Costmap& map, const CostmapParams& params,
                                           uint8_t flags) {
  auto builder = std::make_unique<CostmapBuilder>();
  if (!IsUsable(builder->BeginCells(map.window, params))) return builder;
  for (int i = 0; i < kMapCells; ++i) {
    if ((map.flags[i] & flags) != 0) builder->SetCell(i, map.flags[i] & (flags | Costmap::kPerson));
  }
  while (builder->StepCells(CostmapBuilder::kUnits) == Progress::kBusy) {
  }
  return builder;
}

double LargestCost(const Costmap& map) {
  return static_cast<double>(*std::max_element(map.cost_q8, map.cost_q8 + kMapCells)) / kCostOne_q8;
}

class Panels {
 public:
  Panels(Canvas& canvas, const Costmap& map, Range x, Range y)
      : canvas_(canvas), map_(map), x_(x), y_(y) {}

  void Draw(int index, const std::string& caption, const std::function<Colour(int)>& colour_of) {
    Axes axes = Axes::OfMap(canvas_, PanelArea(index), x_, y_);
    canvas_.Fill(axes.area(), kOffMap);
    DrawCells(canvas_, axes, map_.window, colour_of);
    axes.Frame(caption, "x [m]", "y [m]");
  }

  // The layer's costs; each panel has its own scale, drawn as a bar beside it.
  void DrawCosts(int index, const std::string& caption, const Costmap& layer) {
    const double largest = std::max(LargestCost(layer), 1.0);
    Draw(index, caption, [&layer, largest](int cell) {
      return CostColour(static_cast<double>(layer.cost_q8[cell]) / kCostOne_q8 / largest);
    });
    DrawCostScale(canvas_, PanelArea(index), TickText(largest, 0.1), "cost");
  }

 private:
  Canvas& canvas_;
  const Costmap& map_;
  Range x_;
  Range y_;
};

constexpr std::array<Patch, 6> kPatches = {
    Patch{"hard obstacle", kHard}, {"person (hard)", kPerson},     {"soft obstacle", kSoft},
    {"free ground", kFree},        {"not observed", kNotObserved}, {"off the map", kOffMap}};

}  // namespace

Canvas DrawCostPanels(const Costmap& map, const CostmapParams& params, Range x, Range y,
                      const std::string& title) {
  const auto hard = BuildLayer(map, params, Costmap::kHard);
  const auto soft = BuildLayer(map, params, Costmap::kSoft);
  Canvas canvas(kWidth_px, kHeight_px);
  canvas.Text(80.0, 38.0, title, {.size_px = 20.0, .bold = true});
  DrawPatches(canvas, 80.0, 56.0, kPatches);
  Panels panels(canvas, map, x, y);
  constexpr uint8_t kShown =
      Costmap::kHard | Costmap::kSoft | Costmap::kPerson | Costmap::kObserved;
  panels.Draw(0, "(a) input: hard, soft, free",
              [&map](int i) { return CellColour(map.flags[i] & kShown, 0); });
  const auto grown = [&map](uint8_t obstacle, uint8_t region, Colour seed, Colour edge) {
    return [&map, obstacle, region, seed, edge](int i) {
      if ((map.flags[i] & obstacle) != 0) return seed;
      return (map.flags[i] & region) != 0 ? edge : kFree;
    };
  };
  panels.Draw(1, "(b) hard, expanded by the planning radius",
              grown(Costmap::kHard, Costmap::kLethal, kHard, Mix(kHard, kFree, 0.45)));
  panels.Draw(2, "(c) soft, expanded by the planning radius",
              grown(Costmap::kSoft, Costmap::kSoftRegion, kSoft, Mix(kSoft, kFree, 0.45)));
  panels.DrawCosts(3, "(d) gradient cost of hard", hard->result());
  panels.DrawCosts(4, "(e) gradient cost of soft", soft->result());
  panels.DrawCosts(5, "(f) sum: the map that is planned on", map);
  return canvas;
}

}  // namespace hardpack::picture
