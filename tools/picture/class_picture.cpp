// SPDX-License-Identifier: Apache-2.0
#include "tools/picture/class_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/math.h"
#include "core/scan/scan.h"
#include "tools/picture/axes.h"
#include "tools/picture/cell_image.h"
#include "tools/picture/palette.h"
#include "tools/picture/plan_picture.h"

namespace hardpack::picture {
namespace {

constexpr int kWidth_px = 1480;
constexpr double kMargin_px = 1132.0;  // left edge of the column beside the view from above
constexpr double kStripTop_px = 1216.0;
constexpr double kStripHeight_px = 256.0;
constexpr double kStripWidth_px = 1370.0;

// How returns are drawn, from those that may be hidden to those that must not.
enum Kind : uint8_t { kNothing, kSelf, kIgnored, kGround, kSoftKind, kHardKind, kPersonKind };
constexpr int kKinds = kPersonKind + 1;

struct KindStyle {
  const char* name;
  Colour colour;
  double dot_px;  // seen from above
};
constexpr std::array<KindStyle, kKinds> kStyles = {
    KindStyle{"no return", kNoReturn, 0.0},
    {"the vehicle itself, out of range", kSelfReturn, 3.0},
    {"ignored (rain, dust, void)", kIgnoredReturn, 3.0},
    {"ground", kFree, 3.0},
    {"soft", kSoft, 4.0},
    {"hard", kHard, 4.0},
    {"person (hard)", kPerson, 6.0}};

// A person stays one even inside the self filter's box.
Kind KindOf(const SeenReturn& seen) {
  if (seen.return_class == ReturnClass::kPerson) return kPersonKind;
  if (seen.self) return kSelf;
  switch (seen.return_class) {
    case ReturnClass::kGround:
      return kGround;
    case ReturnClass::kSoft:
      return kSoftKind;
    case ReturnClass::kHard:
      return kHardKind;
    case ReturnClass::kIgnored:
    case ReturnClass::kPerson:
      break;
  }
  return kIgnored;
}

// The visible range of one coordinate from above.
Range Shown(float middle_m) {
  const double middle = double{middle_m};
  return Range{middle, middle}.WidenedBy(kClassesReach_m);
}

bool IsShown(const ClassPicture& picture, Vec2 place) {
  return std::abs(double{place.x_m} - double{picture.pose.x_m}) <= kClassesReach_m &&
         std::abs(double{place.y_m} - double{picture.pose.y_m}) <= kClassesReach_m;
}

struct Counts {
  std::array<int, kKinds> of_kind = {};
  int beyond = 0;  // not shown from above
};

Counts CountsOf(const ClassPicture& picture) {
  Counts counts;
  for (const SeenReturn& seen : picture.returns) {
    ++counts.of_kind[KindOf(seen)];
    counts.beyond += IsShown(picture, seen.place_odom) ? 0 : 1;
  }
  return counts;
}

void DrawFromAbove(Canvas& canvas, const ClassPicture& picture) {
  const Costmap& map = *picture.map;
  Axes axes(canvas, kClassesFromAbove, Shown(picture.pose.x_m), Shown(picture.pose.y_m));
  canvas.Fill(axes.area(), kOffMap);
  DrawCells(canvas, axes, map.window, [&map](int index) {
    return (map.flags[index] & Costmap::kObserved) != 0 ? kObservedGround : kNotObserved;
  });
  axes.Grid({0.45, 0.45, 0.55, 0.22});
  axes.ClipBegin();
  for (int kind = kSelf; kind < kKinds; ++kind) {
    const KindStyle& style = kStyles[static_cast<size_t>(kind)];
    for (const SeenReturn& seen : picture.returns) {
      if (KindOf(seen) != kind) continue;
      // On whole pixels, so that the colour is the legend's.
      const double left_px = std::round(axes.X(double{seen.place_odom.x_m}) - style.dot_px / 2.0);
      const double top_px = std::round(axes.Y(double{seen.place_odom.y_m}) - style.dot_px / 2.0);
      canvas.Fill({left_px, top_px, style.dot_px, style.dot_px}, style.colour);
    }
  }
  DrawVehicle(canvas, axes, picture.vehicle, picture.pose, {1.0, 1.0, 1.0, 0.45}, kVehicle);
  axes.ClipEnd();
  DrawScaleBar(canvas, axes);
  axes.Frame("Returns from above", "x [m]", "y [m]");
}

// Several directions share a pixel, or one direction has several: the gravest kind is shown.
std::vector<Kind> RangeImage(const ClassPicture& picture, int width_px) {
  std::vector<Kind> image(static_cast<size_t>(picture.beams * width_px), kNothing);
  const double direction_px = kStripWidth_px / picture.columns;
  for (const SeenReturn& seen : picture.returns) {
    // To the right of straight ahead is right of the middle.
    const double turn = 0.5 - double{seen.azimuth_rad} / (2.0 * std::numbers::pi);
    const double left_px = turn * width_px - direction_px / 2.0;
    const int first = std::max(static_cast<int>(std::floor(left_px)), 0);
    const int last = std::min(static_cast<int>(std::ceil(left_px + direction_px)), width_px);
    for (int x = first; x < last; ++x) {
      Kind& pixel = image[static_cast<size_t>(seen.beam * width_px + x)];
      pixel = std::max(pixel, KindOf(seen));
    }
  }
  return image;
}

void DrawRangeImage(Canvas& canvas, const ClassPicture& picture) {
  const Rectangle area = RangeImageArea(picture.beams);
  const int width_px = static_cast<int>(area.width_px);
  const double beam_px = area.height_px / picture.beams;
  const std::vector<Kind> image = RangeImage(picture, width_px);
  canvas.Fill(area, kNoReturn);
  for (int beam = 0; beam < picture.beams; ++beam) {
    const double top_px = area.bottom_px() - (beam + 1) * beam_px;
    for (int x = 0; x < width_px; ++x) {
      const Kind kind = image[static_cast<size_t>(beam * width_px + x)];
      if (kind == kNothing) continue;
      canvas.Fill({area.left_px + x, top_px, 1.0, beam_px}, kStyles[kind].colour);
    }
  }
  Axes axes(canvas, area, {-180.0, 180.0}, {0.0, double(picture.beams)});
  axes.Frame("Range image", "azimuth from straight ahead [°], to the right positive",
             "beam, lowest is 0");
  const std::pair<double, const char*> sides[] = {{-90.0, "left"}, {0.0, "ahead"}, {90.0, "right"}};
  for (const auto& [azimuth_deg, name] : sides) {
    canvas.Line(axes.X(azimuth_deg), area.top_px - 6.0, axes.X(azimuth_deg), area.top_px, kInk,
                1.2);
    canvas.Text(axes.X(azimuth_deg), area.top_px - 10.0, name,
                {.size_px = 14.0, .align = Align::kCenter});
  }
}

void DrawLegend(Canvas& canvas, const ClassPicture& picture, const Counts& counts) {
  double y_px = kClassesFromAbove.top_px + 10.0;
  const auto entry = [&canvas, &y_px](const Colour& colour, const std::string& text,
                                      const std::string& value) {
    const Rectangle box = {kMargin_px, y_px - 8.0, 30.0, 16.0};
    canvas.Fill(box, colour);
    canvas.Outline(box, kFaintInk, 0.8);
    canvas.Text(kMargin_px + 42.0, y_px + 5.0, text, {.size_px = 14.5});
    canvas.Text(kWidth_px - 30.0, y_px + 5.0, value, {.size_px = 14.5, .align = Align::kRight});
    y_px += 25.0;
  };
  const auto heading = [&canvas, &y_px](const char* text) {
    canvas.Text(kMargin_px, y_px + 5.0, text, {.size_px = 15.0, .bold = true});
    y_px += 25.0;
  };
  heading("Returns, and how many");
  for (const Kind kind : {kGround, kSoftKind, kHardKind, kPersonKind, kIgnored, kSelf}) {
    entry(kStyles[kind].colour, kStyles[kind].name, std::to_string(counts.of_kind[kind]));
  }
  canvas.Text(kMargin_px + 42.0, y_px + 5.0, "of all, beyond the view", {.size_px = 14.5});
  canvas.Text(kWidth_px - 30.0, y_px + 5.0, std::to_string(counts.beyond),
              {.size_px = 14.5, .align = Align::kRight});
  y_px += 25.0;
  entry(kNoReturn, "nothing came back (range image)", "");
  y_px += 18.0;
  heading("Cells of the whole map");
  const auto observed =
      std::count_if(picture.map->flags, picture.map->flags + kMapCells,
                    [](uint8_t flags) { return (flags & Costmap::kObserved) != 0; });
  const auto share = [](auto cells) {
    return TickText(100.0 * static_cast<double>(cells) / kMapCells, 0.1) + " %";
  };
  entry(kObservedGround, "ground observed", share(observed));
  entry(kNotObserved, "not observed", share(kMapCells - observed));
  y_px += 18.0;
  canvas.Outline({kMargin_px + 4.0, y_px - 8.0, 22.0, 16.0}, kVehicle, 2.0);
  canvas.Line(kMargin_px + 15.0, y_px, kMargin_px + 26.0, y_px, kVehicle, 2.0);
  canvas.Text(kMargin_px + 42.0, y_px + 5.0, "the vehicle: outline and front", {.size_px = 14.5});
}

}  // namespace

std::vector<SeenReturn> ReturnsOf(const Mapper& mapper, const Pose2& pose) {
  std::vector<SeenReturn> returns;
  const ScanRing& ring = mapper.ring();
  for (int slot = 0; slot < ring.slots(); ++slot) {
    const ScanColumn& column = ring.column(slot);
    if (column.state == ColumnState::kAbsent) continue;
    const SinCosPair encoder =
        EncoderSinCos(mapper.model(), column.measurement_id, column.azimuth_offset_rad);
    const Vec3 sensor = column.odom_from_sensor.Apply({});
    for (int beam = 0; beam < ring.beams(); ++beam) {
      const int row = mapper.model().by_altitude[beam];
      const PackedReturn packed = ring.at(slot, row);
      if (packed.range_mm() == 0) continue;
      const Vec3 point = column.odom_from_sensor.Apply(
          PointInSensor(mapper.model(), encoder, row, packed.range_mm()));
      const float bearing_rad = Atan2(point.y_m - sensor.y_m, point.x_m - sensor.x_m);
      returns.push_back({.place_odom = {point.x_m, point.y_m},
                         .azimuth_rad = WrapAngle(bearing_rad - pose.theta_rad),
                         .beam = beam,
                         .return_class = packed.return_class(),
                         .self = packed.self()});
    }
  }
  return returns;
}

Rectangle RangeImageArea(int beams) {
  const double beam_px = std::max(std::floor(kStripHeight_px / beams), 1.0);
  return {kClassesFromAbove.left_px, kStripTop_px, kStripWidth_px, beam_px * beams};
}

Canvas DrawClasses(const ClassPicture& picture) {
  const Rectangle strip = RangeImageArea(picture.beams);
  Canvas canvas(kWidth_px, static_cast<int>(strip.bottom_px()) + 56);
  const Counts counts = CountsOf(picture);
  canvas.Text(kClassesFromAbove.left_px, 40.0,
              picture.title + ": " + std::to_string(picture.returns.size()) + " returns",
              {.size_px = 21.0, .bold = true});
  DrawFromAbove(canvas, picture);
  DrawLegend(canvas, picture, counts);
  DrawRangeImage(canvas, picture);
  return canvas;
}

}  // namespace hardpack::picture
