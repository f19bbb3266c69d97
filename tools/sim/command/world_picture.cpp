// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/command/world_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <memory>

#include "core/scan/scan.h"
#include "core/segmentation/label_table.h"
#include "hal/ouster/ouster.h"
#include "port_linux/command_line/command.h"
#include "port_linux/files/ouster_metadata.h"
#include "tools/picture/axes.h"
#include "tools/picture/palette.h"
#include "tools/sim/sensors/sim_lidar.h"

namespace hardpack::command {
namespace {

using picture::Axes;
using picture::Canvas;
using picture::Colour;
using picture::DataPoint;
using world::Body;
using world::Matter;
using world::Point2;
using world::Scenario;

constexpr double kWidth_px = 1480.0;
constexpr picture::Rectangle kMap = {80.0, 74.0, 1080.0, 760.0};
constexpr double kLegend_px = 1190.0;
constexpr double kWaypoint_px = 5.0;
constexpr double kContour_m = 0.5;

constexpr Colour kLowGround = {0.62, 0.70, 0.62};
constexpr Colour kHighGround = {0.99, 0.97, 0.90};
constexpr Colour kContour = {0.55, 0.52, 0.42};
constexpr Colour kGroundReturn = {0.42, 0.30, 0.16};
constexpr Colour kSolidFill = {0.50, 0.50, 0.54};
constexpr Colour kTrunkFill = {0.45, 0.28, 0.12};
constexpr Colour kLeavesFill = {0.35, 0.62, 0.28, 0.45};
constexpr Colour kMeshFill = {0.30, 0.30, 0.75};
// By AreaKind.
constexpr std::array<Colour, kAreaKinds> kAreaFills = {
    {{0.90, 0.20, 0.10, 0.35}, {0.0, 0.0, 0.0, 0.0}, {0.95, 0.75, 0.10, 0.30}}};
constexpr std::array<Colour, kAreaKinds> kAreaRims = {
    {{0.80, 0.05, 0.05}, {0.45, 0.05, 0.60}, {0.75, 0.55, 0.0}}};
constexpr Colour kPlanLine = {0.05, 0.20, 0.90, 0.35};

class WorldPicture {
 public:
  WorldPicture(Canvas& canvas, const Scenario& scenario)
      : canvas_(&canvas), scenario_(&scenario), axes_(MakeAxes(canvas, scenario)) {}

  void DrawGround();
  void DrawBodies();
  void DrawPeople(double time_s);
  void DrawReturns(const std::vector<WorldReturn>& returns);
  void DrawAreas(const AreaList& areas);
  void DrawDriven(const DrivenWay& driven);
  void DrawEnds(const world::Footprint& footprint);
  void Frame() {
    axes_.ClipEnd();
    axes_.Frame("", "x [m]", "y [m]");
  }
  double low_m() const { return low_m_; }
  double high_m() const { return high_m_; }

 private:
  static Axes MakeAxes(Canvas& canvas, const Scenario& scenario) {
    picture::Range x = {scenario.start.position.x_m, scenario.start.position.x_m};
    picture::Range y = {scenario.start.position.y_m, scenario.start.position.y_m};
    x.Include(scenario.goal.x_m);
    y.Include(scenario.goal.y_m);
    constexpr double kAround_m = 12.0;
    constexpr double kBeside_m = 15.0;
    return Axes::OfMap(canvas, kMap, x.WidenedBy(kAround_m), y.WidenedBy(kBeside_m));
  }
  void Circle(double x_m, double y_m, double radius_m, const Colour& fill, const Colour& rim) {
    std::array<DataPoint, 28> points;
    for (size_t i = 0; i < points.size(); ++i) {
      const double angle_rad = 2.0 * world::kPi * static_cast<double>(i) / points.size();
      points[i] = {x_m + radius_m * std::cos(angle_rad), y_m + radius_m * std::sin(angle_rad)};
    }
    axes_.Polygon(points, fill, rim);
  }
  void DrawBody(const Body& body);

  Canvas* canvas_;
  const Scenario* scenario_;
  Axes axes_;
  double low_m_ = 0.0;
  double high_m_ = 0.0;
};

void WorldPicture::DrawGround() {
  constexpr double kBlock_px = 2.0;
  const int columns = static_cast<int>(kMap.width_px / kBlock_px);
  const int rows = static_cast<int>(kMap.height_px / kBlock_px);
  std::vector<double> heights_m;
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      const double x_m = axes_.x().low + column * kBlock_px / axes_.PixelsPerUnit();
      const double y_m = axes_.y().high - row * kBlock_px / axes_.PixelsPerUnit();
      heights_m.push_back(scenario_->world.GroundHeight_m(x_m, y_m));
    }
  }
  low_m_ = *std::min_element(heights_m.begin(), heights_m.end());
  high_m_ = *std::max_element(heights_m.begin(), heights_m.end());
  const double span_m = std::max(high_m_ - low_m_, 1.0);
  axes_.ClipBegin();
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const auto index = static_cast<size_t>(row * (columns + 1) + column);
      const double height_m = heights_m[index];
      const auto step = [&](size_t other) {
        // Between round heights, so that level ground has no contour lines.
        return std::floor(height_m / kContour_m + 0.5) !=
               std::floor(heights_m[other] / kContour_m + 0.5);
      };
      const bool contour = step(index + 1) || step(index + static_cast<size_t>(columns) + 1);
      // A light from the upper left.
      const double rise =
          heights_m[index + 1] - heights_m[index + static_cast<size_t>(columns) + 1];
      const double light = std::clamp(0.5 + 2.4 * rise, 0.0, 1.0);
      Colour colour = picture::Mix(kLowGround, kHighGround, (height_m - low_m_) / span_m);
      colour = picture::Mix(colour, light > 0.5 ? Colour{1.0, 1.0, 1.0} : Colour{0.1, 0.1, 0.1},
                            0.5 * std::abs(light - 0.5));
      if (contour) colour = picture::Mix(colour, kContour, 0.6);
      canvas_->Fill(
          {kMap.left_px + column * kBlock_px, kMap.top_px + row * kBlock_px, kBlock_px, kBlock_px},
          colour);
    }
  }
  axes_.Grid({0.45, 0.45, 0.55, 0.25});
}

void WorldPicture::DrawBody(const Body& body) {
  Colour fill = body.material.label == world::Label::kTree ? kTrunkFill : kSolidFill;
  if (body.material.matter == Matter::kFoliage) fill = kLeavesFill;
  if (body.material.matter == Matter::kMesh) fill = kMeshFill;
  const Colour rim = body.material.matter == Matter::kMesh
                         ? kMeshFill
                         : picture::Mix(fill, {0.0, 0.0, 0.0, fill.alpha}, 0.4);
  if (body.shape != world::Shape::kPrism) {
    Circle(body.x_m, body.y_m, body.radius_m, fill, rim);
    return;
  }
  std::vector<DataPoint> points;
  for (const world::Side& side : scenario_->world.SidesOf(body)) {
    points.push_back({side.corner.x_m, side.corner.y_m});
  }
  axes_.Polygon(points, fill, rim);
}

void WorldPicture::DrawBodies() {
  // Leaves are drawn over the things they hide.
  for (const bool leaves : {false, true}) {
    for (const Body& body : scenario_->world.bodies()) {
      if ((body.material.matter == Matter::kFoliage) == leaves) DrawBody(body);
    }
  }
}

void WorldPicture::DrawPeople(double time_s) {
  for (const world::Person& person : scenario_->world.people()) {
    std::vector<DataPoint> way;
    for (const world::Person::Place& place : person.places) way.push_back({place.x_m, place.y_m});
    axes_.Line(way, {.colour = picture::kPerson, .line_px = 1.5, .dashed = true});
    const Point2 now = person.At(time_s);
    Circle(now.x_m, now.y_m, 0.4, picture::kPerson, picture::kInk);
  }
}

Colour ReturnColour(world::Label label) {
  static constexpr LabelTable kTable = RellisLabelTable();
  switch (kTable.class_of[static_cast<size_t>(label)]) {
    case ReturnClass::kSoft:
      return picture::kSoft;
    case ReturnClass::kHard:
      return {0.85, 0.05, 0.05};
    case ReturnClass::kPerson:
      return picture::kPerson;
    default:
      return kGroundReturn;
  }
}

void WorldPicture::DrawReturns(const std::vector<WorldReturn>& returns) {
  for (const WorldReturn& one : returns) {
    constexpr double kDot_px = 2.0;
    canvas_->Fill(
        {std::round(axes_.X(one.x_m)) - 1.0, std::round(axes_.Y(one.y_m)) - 1.0, kDot_px, kDot_px},
        ReturnColour(one.label));
  }
}

std::vector<DataPoint> PointsOf(const std::vector<Point2>& way) {
  std::vector<DataPoint> points;
  for (const Point2& point : way) points.push_back({point.x_m, point.y_m});
  return points;
}

void WorldPicture::DrawAreas(const AreaList& areas) {
  for (const Area& area : areas) {
    if (area.frame != AreaFrame::kOdom) continue;
    std::vector<DataPoint> points;
    for (int i = 0; i < area.corners; ++i) {
      points.push_back({area.corner[i].x_mm / 1000.0, area.corner[i].y_mm / 1000.0});
    }
    const auto kind = static_cast<size_t>(area.kind);
    axes_.Polygon(points, kAreaFills[kind], kAreaRims[kind]);
    points.push_back(points.front());
    axes_.Line(points, {.colour = kAreaRims[kind], .line_px = 2.0});
  }
}

void WorldPicture::DrawDriven(const DrivenWay& driven) {
  for (const std::vector<Point2>& plan : driven.plans) {
    axes_.Line(PointsOf(plan), {.colour = kPlanLine, .line_px = 1.0});
  }
  // Yellow, as in the paper; with a rim, otherwise it is invisible on light ground.
  const std::vector<DataPoint> way = PointsOf(driven.way);
  axes_.Line(way, {.colour = {0.25, 0.20, 0.0}, .line_px = 6.0});
  axes_.Line(way, {.colour = picture::kDriven, .line_px = 4.0});
  for (const Point2& place : driven.waypoints) {
    canvas_->Disc(axes_.X(place.x_m), axes_.Y(place.y_m), kWaypoint_px, picture::kGoal);
  }
}

void WorldPicture::DrawEnds(const world::Footprint& footprint) {
  const world::BodyPose& start = scenario_->start;
  const auto at = [&](double along_m, double left_m) {
    const double c = std::cos(start.yaw_rad);
    const double s = std::sin(start.yaw_rad);
    return DataPoint{start.position.x_m + c * along_m - s * left_m,
                     start.position.y_m + s * along_m + c * left_m};
  };
  const double front_m = footprint.middle_m + footprint.length_m / 2.0;
  const double rear_m = footprint.middle_m - footprint.length_m / 2.0;
  const double half_width_m = footprint.width_m / 2.0;
  const std::array<DataPoint, 4> outline = {at(front_m, half_width_m), at(rear_m, half_width_m),
                                            at(rear_m, -half_width_m), at(front_m, -half_width_m)};
  axes_.Polygon(outline, {1.0, 1.0, 1.0, 0.7}, picture::kVehicle);
  const std::array<DataPoint, 2> nose = {at(0.0, 0.0), at(2.2, 0.0)};
  axes_.Line(nose, {.colour = picture::kVehicle, .line_px = 3.0});
  canvas_->Disc(axes_.X(scenario_->goal.x_m), axes_.Y(scenario_->goal.y_m), 8.0, picture::kGoal);
}

void DrawLegend(Canvas& canvas, const WorldPicture& picture,
                const std::vector<WorldReturn>& returns, const DrivenWay& driven) {
  double y_px = kMap.top_px + 10.0;
  const auto entry = [&](const Colour& colour, const std::string& text) {
    canvas.Fill({kLegend_px, y_px - 8.0, 26.0, 16.0}, colour);
    canvas.Outline({kLegend_px, y_px - 8.0, 26.0, 16.0}, picture::kFaintInk, 0.8);
    canvas.Text(kLegend_px + 38.0, y_px + 5.0, text, {.size_px = 14.5});
    y_px += 25.0;
  };
  const auto heading = [&](const std::string& text) {
    y_px += 8.0;
    canvas.Text(kLegend_px, y_px + 5.0, text, {.size_px = 15.0, .bold = true});
    y_px += 25.0;
  };
  const auto meters = [](double value) { return picture::TickText(value, 0.1) + " m"; };
  heading("Ground");
  entry(kLowGround, "lowest: " + meters(picture.low_m()));
  entry(kHighGround, "highest: " + meters(picture.high_m()));
  entry(kContour, "contour, each 0.5 m");
  heading("What stands on it");
  entry(kSolidFill, "solid");
  entry(kTrunkFill, "trunk");
  entry(kMeshFill, "wire mesh: a third of the rays");
  entry(kLeavesFill, "leaves: rays end within");
  entry(picture::kPerson, "person at " + picture::TickText(driven.end_s, 0.1) + " s, and the way");
  if (!returns.empty()) {
    heading("One revolution: " + std::to_string(returns.size()) + " returns");
    entry(kGroundReturn, "from the ground");
    entry(picture::kSoft, "soft (bush)");
    entry({0.85, 0.05, 0.05}, "hard, treetops too");
    entry(picture::kPerson, "person");
  }
  if (!driven.areas.empty()) {
    heading("Areas");
    entry(kAreaRims[0], "keep out");
    entry(kAreaRims[1], "fence");
    entry(kAreaRims[2], "speed zone");
  }
  heading("The way");
  if (!driven.way.empty()) {
    entry(picture::kDriven, "driven");
    entry(kPlanLine, "plans: " + std::to_string(driven.plans.size()));
  }
  canvas.Outline({kLegend_px + 4.0, y_px - 8.0, 18.0, 16.0}, picture::kVehicle, 2.0);
  canvas.Text(kLegend_px + 38.0, y_px + 5.0, "the vehicle at the start", {.size_px = 14.5});
  y_px += 25.0;
  canvas.Disc(kLegend_px + 13.0, y_px, 8.0, picture::kGoal);
  canvas.Text(kLegend_px + 38.0, y_px + 5.0, "goal", {.size_px = 14.5});
  if (driven.waypoints.empty()) return;
  y_px += 25.0;
  canvas.Disc(kLegend_px + 13.0, y_px, kWaypoint_px, picture::kGoal);
  canvas.Text(kLegend_px + 38.0, y_px + 5.0, "waypoint", {.size_px = 14.5});
}

// Its packets, read back.
struct Reader {
  ouster::Metadata metadata;
  ouster::PacketLayout layout;
  std::unique_ptr<BeamModel> model = std::make_unique<BeamModel>();

  explicit Reader(const sim::SimLidar& lidar) {
    Require(ouster::ParseMetadata(lidar.MetadataJson(), "simulated", metadata));
    constexpr size_t kBeams = sim::SimLidar::kBeams;
    if (!IsUsable(ouster::MakeLayout(metadata, layout)) ||
        !IsUsable(MakeBeamModel({metadata.beam_altitude_deg, kBeams},
                                {metadata.beam_azimuth_deg, kBeams}, metadata.columns_per_frame,
                                metadata.lidar_origin_to_beam_origin_m, metadata.sensor_from_lidar,
                                *model))) {
      throw CommandFailure(kWorkFailed, "the simulated lidar's metadata is invalid");
    }
  }
};

}  // namespace

WorldScan ScanFromStart(const Scenario& scenario, uint32_t seed) {
  sim::LidarSettings settings = sim::NoisyLidar();
  settings.seed = seed;
  sim::SimLidar lidar(settings, 0);
  const Reader reader(lidar);
  std::vector<std::vector<uint8_t>> packets;
  std::vector<sim::CastColumn> truth;
  WorldScan scan;
  const std::clock_t before = std::clock();
  lidar.Advance(99'999'999, scenario.start, scenario.world, packets, &truth);
  scan.cast_ms = 1000.0 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  const auto mount = [](double value) { return static_cast<float>(value); };
  const world::BodyPose& start = scenario.start;
  const Transform3 world_from_sensor =
      TransformFromRollPitchYaw(
          mount(start.roll_rad), mount(start.pitch_rad), mount(start.yaw_rad),
          {mount(start.position.x_m), mount(start.position.y_m), mount(start.position.z_m)}) *
      TransformFromRollPitchYaw(0.0f, 0.0f, mount(settings.yaw_rad),
                                {mount(settings.x_m), mount(settings.y_m), mount(settings.z_m)});
  size_t cast = 0;
  for (const std::vector<uint8_t>& packet : packets) {
    for (int i = 0; i < sim::SimLidar::kColumnsPerPacket; ++i, ++cast) {
      LidarColumn column;
      if (!IsUsable(ouster::DecodeColumn(reader.layout, packet, i, column))) continue;
      const SinCosPair encoder = EncoderSinCos(*reader.model, column.measurement_id);
      for (int row = 0; row < column.beams; ++row) {
        if (column.range_mm[row] == 0) continue;
        const Vec3 point = world_from_sensor.Apply(
            PointInSensor(*reader.model, encoder, row, column.range_mm[row]));
        scan.returns.push_back({double{point.x_m}, double{point.y_m},
                                world::Label{truth[cast].labels[static_cast<size_t>(row)]}});
      }
    }
  }
  return scan;
}

Canvas DrawWorld(const Scenario& scenario, uint64_t seed, const std::vector<WorldReturn>& returns,
                 const DrivenWay& driven) {
  Canvas canvas(static_cast<int>(kWidth_px), static_cast<int>(kMap.bottom_px() + 70.0));
  canvas.Text(kMap.left_px, 32.0, scenario.name + ", seed " + std::to_string(seed),
              {.size_px = 21.0, .bold = true});
  canvas.Text(kMap.left_px, 56.0, scenario.description, {.size_px = 15.0});
  WorldPicture picture(canvas, scenario);
  picture.DrawGround();
  picture.DrawBodies();
  picture.DrawReturns(returns);
  picture.DrawPeople(driven.end_s);
  picture.DrawAreas(driven.areas);
  picture.DrawDriven(driven);
  picture.DrawEnds(driven.footprint);
  picture.Frame();
  DrawLegend(canvas, picture, returns, driven);
  return canvas;
}

}  // namespace hardpack::command
