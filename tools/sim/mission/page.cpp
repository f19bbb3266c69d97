// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/mission/page.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace hardpack::mission {

// The files of tools/sim/mission/page, embedded by the build.
extern const std::string_view kPageHtml;
extern const std::string_view kPageStyle;
extern const std::string_view kPageScript;

namespace {

using Json = nlohmann::ordered_json;

constexpr double kAround_m = 12.0;  // of the way, on the map
// Shapes of a map's frame: width over height on a wide screen, height over width on a phone.
constexpr double kWidest = 1.6;
constexpr double kHighest = 1.2;
constexpr double kHeightStep_m = 0.5;

double Rounded(double value, double per_unit) {
  return std::isfinite(value) ? std::round(value * per_unit) / per_unit : 0.0;
}
double Centimetres(double value_m) {
  return Rounded(value_m, 100.0);
}
double Thousandths(double value) {
  return Rounded(value, 1000.0);
}

Json PointOf(world::Point2 point) {
  return {Centimetres(point.x_m), Centimetres(point.y_m)};
}

struct Extent {
  double left_m = INFINITY;
  double right_m = -INFINITY;
  double low_m = INFINITY;
  double high_m = -INFINITY;

  void Include(double x_m, double y_m) {
    left_m = std::min(left_m, x_m);
    right_m = std::max(right_m, x_m);
    low_m = std::min(low_m, y_m);
    high_m = std::max(high_m, y_m);
  }
};

// The initial view: the driven way, start and goal, and their surroundings.
Extent FocusOf(const MissionSettings& settings, const MissionTrace& trace) {
  Extent focus;
  focus.Include(settings.scenario.start.position.x_m, settings.scenario.start.position.y_m);
  focus.Include(settings.scenario.goal.x_m, settings.scenario.goal.y_m);
  for (const MissionTrace::Sample& sample : trace.samples) focus.Include(sample.x_m, sample.y_m);
  return {focus.left_m - kAround_m, focus.right_m + kAround_m, focus.low_m - kAround_m,
          focus.high_m + kAround_m};
}

// The ground included in the page: enough for a frame of any shape around the focus.
Extent ExtentOf(const world::World& world, const Extent& focus) {
  const double wide_m = focus.right_m - focus.left_m;
  const double high_m = focus.high_m - focus.low_m;
  const double beside_m = std::max(0.0, kWidest * high_m - wide_m) / 2.0;
  const double above_m = std::max(0.0, kHighest * wide_m - high_m) / 2.0;
  const world::Bounds& bounds = world.bounds();
  return {std::max(focus.left_m - beside_m, bounds.low_x_m),
          std::min(focus.right_m + beside_m, bounds.high_x_m),
          std::max(focus.low_m - above_m, bounds.low_y_m),
          std::min(focus.high_m + above_m, bounds.high_y_m)};
}

// [rows x columns] of centimetres from the lower left corner on.
Json HeightsOf(const world::World& world, const Extent& extent) {
  const int columns = static_cast<int>((extent.right_m - extent.left_m) / kHeightStep_m) + 1;
  const int rows = static_cast<int>((extent.high_m - extent.low_m) / kHeightStep_m) + 1;
  Json centimetres = Json::array();
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double height_m = world.GroundHeight_m(extent.left_m + column * kHeightStep_m,
                                                   extent.low_m + row * kHeightStep_m);
      centimetres.push_back(std::lround(height_m * 100.0));
    }
  }
  return {{"step_m", kHeightStep_m}, {"columns", columns}, {"rows", rows}, {"cm", centimetres}};
}

const char* KindOf(const world::Material& material) {
  if (material.matter == world::Matter::kFoliage) return "leaves";
  if (material.matter == world::Matter::kMesh) return "mesh";
  return material.label == world::Label::kTree ? "trunk" : "solid";
}

Json BodiesOf(const world::World& world, const Extent& extent) {
  Json bodies = Json::array();
  for (const world::Body& body : world.bodies()) {
    if (body.x_m + body.radius_m < extent.left_m || body.x_m - body.radius_m > extent.right_m ||
        body.y_m + body.radius_m < extent.low_m || body.y_m - body.radius_m > extent.high_m) {
      continue;
    }
    Json one = {{"kind", KindOf(body.material)}};
    if (body.shape == world::Shape::kPrism) {
      for (const world::Side& side : world.SidesOf(body)) {
        one["corners"].push_back(PointOf(side.corner));
      }
    } else {
      one["at"] = PointOf({body.x_m, body.y_m});
      one["radius_m"] = Centimetres(body.radius_m);
    }
    bodies.push_back(std::move(one));
  }
  return bodies;
}

Json SceneOf(const MissionSettings& settings, const MissionTrace& trace) {
  const world::Scenario& scenario = settings.scenario;
  const Extent focus = FocusOf(settings, trace);
  const Extent extent = ExtentOf(scenario.world, focus);
  Json ditches = Json::array();
  for (const world::Ditch& ditch : scenario.world.ditches()) {
    ditches.push_back({{"from", PointOf(ditch.from)},
                       {"to", PointOf(ditch.to)},
                       {"half_width_m", ditch.half_width_m}});
  }
  return {{"description", scenario.description},
          {"start", PointOf({scenario.start.position.x_m, scenario.start.position.y_m})},
          {"goal", PointOf(scenario.goal)},
          {"focus", {focus.left_m, focus.low_m, focus.right_m, focus.high_m}},
          {"extent", {extent.left_m, extent.low_m, extent.right_m, extent.high_m}},
          {"heights", HeightsOf(scenario.world, extent)},
          {"ditches", ditches},
          {"bodies", BodiesOf(scenario.world, extent)}};
}

// One column per number, so that each name appears once.
Json SamplesOf(const MissionTrace& trace) {
  Json columns = Json::object();
  const auto add = [&](const char* name, const auto& value) {
    Json column = Json::array();
    for (const MissionTrace::Sample& sample : trace.samples) column.push_back(value(sample));
    columns[name] = std::move(column);
  };
  using Sample = MissionTrace::Sample;
  add("t_s", [](const Sample& one) { return Centimetres(one.t_s); });
  add("x_m", [](const Sample& one) { return Centimetres(one.x_m); });
  add("y_m", [](const Sample& one) { return Centimetres(one.y_m); });
  add("yaw_rad", [](const Sample& one) { return Thousandths(one.yaw_rad); });
  add("speed_mps", [](const Sample& one) { return Thousandths(one.speed_mps); });
  add("commanded_mps", [](const Sample& one) { return Thousandths(one.commanded_mps); });
  add("planned_mps", [](const Sample& one) { return Thousandths(one.planned_mps); });
  add("yaw_rate_radps", [](const Sample& one) { return Thousandths(one.yaw_rate_radps); });
  add("commanded_yaw_radps",
      [](const Sample& one) { return Thousandths(one.commanded_yaw_radps); });
  add("commanded_curvature_per_m",
      [](const Sample& one) { return Thousandths(one.commanded_curvature_per_m); });
  add("cross_track_m", [](const Sample& one) { return Thousandths(one.cross_track_m); });
  add("clearance_m", [](const Sample& one) { return Thousandths(one.clearance_m); });
  add("reaction_median_m", [](const Sample& one) { return Thousandths(one.reaction_median_m); });
  add("reaction_p99_m", [](const Sample& one) { return Thousandths(one.reaction_p99_m); });
  add("people", [](const Sample& one) {
    Json people = Json::array();
    for (const world::Point2& place : one.people) people.push_back(PointOf(place));
    return people;
  });
  return columns;
}

// For each run of equal cells, a letter for its kind and its length.
std::string CellsText(const std::vector<MapCell>& cells) {
  std::string text;
  for (size_t first = 0; first < cells.size();) {
    size_t end = first;
    while (end < cells.size() && cells[end] == cells[first]) ++end;
    text += static_cast<char>('a' + static_cast<int>(cells[first]));
    text += std::to_string(end - first);
    first = end;
  }
  return text;
}

Json MapsOf(const MissionTrace& trace) {
  Json maps = Json::array();
  for (const MapRecord& map : trace.maps) {
    maps.push_back({{"t_s", Centimetres(map.t_s)},
                    {"at", PointOf({map.x_m, map.y_m})},
                    {"yaw_rad", Rounded(map.yaw_rad, 1.0e5)},
                    {"columns", map.columns},
                    {"rows", map.rows},
                    {"cells", CellsText(map.cells)}});
  }
  return maps;
}

void Replace(std::string& text, std::string_view mark, std::string_view by) {
  const size_t at = text.find(mark);
  if (at != std::string::npos) text.replace(at, mark.size(), by);
}

}  // namespace

nlohmann::ordered_json PageData(const MissionSettings& settings,
                                const experiment::RunResult& result, const MissionTrace& trace) {
  Json plans = Json::array();
  for (const MissionTrace::Plan& plan : trace.plans) {
    Json path = Json::array();
    for (const world::Point2& point : plan.path) path.push_back(PointOf(point));
    plans.push_back({{"t_s", Centimetres(plan.t_s)}, {"path", std::move(path)}});
  }
  Json events = Json::array();
  for (const MissionTrace::Event& event : trace.events) {
    events.push_back({{"t_s", Centimetres(event.t_s)}, {"text", event.text}});
  }
  const world::Footprint& footprint = trace.footprint;
  return {
      {"run", experiment::ToJson(result)},
      {"wanted", experiment::Name(WantedOutcome(result.world))},
      {"has_log", !settings.log.empty()},
      {"max_speed_mps", Thousandths(double{settings.configuration.planner.speed.max_speed_mps})},
      {"vehicle",
       {{"length_m", footprint.length_m},
        {"width_m", footprint.width_m},
        {"middle_m", footprint.middle_m}}},
      {"cell_m", 0.2},
      {"scene", SceneOf(settings, trace)},
      {"samples", SamplesOf(trace)},
      {"plans", plans},
      {"events", events},
      {"maps", MapsOf(trace)}};
}

std::string PageOf(const nlohmann::ordered_json& data) {
  // Only ASCII, and no '<': it occurs only in strings, where the escape means the same.
  std::string text = data.dump(-1, ' ', true, Json::error_handler_t::replace);
  for (size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at)) {
    text.replace(at, 1, "\\u003c");
  }
  std::string page(kPageHtml);
  Replace(page, "/* STYLE */", kPageStyle);
  Replace(page, "/* SCRIPT */", kPageScript);
  Replace(page, "{\"mission\": null}", text);
  return page;
}

}  // namespace hardpack::mission
