// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/costmap/height_grid.h"

// The height grid once more, slow and obvious: a map of cells in true heights, doubles, and every
// cell of the plane asked whether a line crosses it. Written from height_grid.h. What single
// precision could decide either way it does not do: the calls then return false and change nothing,
// and the test does not ask the grid either.

namespace hardpack {

class ReferenceGrid {
 public:
  explicit ReferenceGrid(Vec2 center) { Reset(center); }

  void Reset(Vec2 center) {
    cells_.clear();
    window_ = GridWindow::CenteredAt(center);
    shift_cm_ = 0;
  }

  void Recenter(Vec2 center) {
    window_ = GridWindow::CenteredAt(center);
    std::erase_if(cells_, [&](const auto& entry) {
      return !window_.Contains({entry.first.first, entry.first.second});
    });
  }

  bool ShiftHeights(double dz_m) {
    if (std::abs(std::abs(std::fmod(dz_m * 100.0, 1.0)) - 0.5) < 0.01) return false;
    const int64_t dz_cm = std::llround(dz_m * 100.0);
    shift_cm_ += dz_cm;
    for (auto& [key, cell] : cells_) {
      for (std::optional<int64_t>* height :
           {&cell.lowest, &cell.lowest_hard, &cell.highest_hard, &cell.highest_soft}) {
        if (*height) **height += dz_cm;
      }
    }
    return true;
  }

  bool Insert(const Vec3& point, ReturnClass what, uint32_t revolution) {
    const auto height = InCentimeters(static_cast<double>(point.z_m));
    const auto key = KeyAt(static_cast<double>(point.x_m), static_cast<double>(point.y_m));
    if (!height || !key) return false;
    if (what == ReturnClass::kIgnored || !Inside(*key)) return true;
    Cell& cell = cells_[*key];
    const bool odd = revolution % 2 == 1;
    const int64_t h = *height;
    if (what == ReturnClass::kGround) {
      const bool empty = !cell.HasObstacle();
      const bool person = cell.memory > 0;
      if (empty || person) {
        const bool first = cell.filed_odd != odd;
        cell.filed_odd = odd;
        if (first && person) --cell.memory;
        if (first && empty && cell.lowest && *cell.lowest < h) ++*cell.lowest;
      }
      if (empty && cell.ground && cell.beside) cell.lowest = h;
      cell.ground = true;
      cell.beside = false;
    }
    if (!cell.lowest || h < *cell.lowest) cell.lowest = h;
    if (what == ReturnClass::kSoft) {
      if (!cell.highest_soft || h > *cell.highest_soft) cell.highest_soft = h;
      if (!cell.highest_hard && 2 * h >= *cell.lowest + *cell.highest_soft) cell.MakeYoung(odd);
    }
    if (what == ReturnClass::kHard || what == ReturnClass::kPerson) {
      const bool first = cell.filed_odd != odd;
      cell.filed_odd = odd;
      if (what == ReturnClass::kPerson) cell.memory = HeightGrid::kPersonMemory;
      if (what == ReturnClass::kHard && first && cell.memory > 0) --cell.memory;
      if (!cell.lowest_hard || h < *cell.lowest_hard) cell.lowest_hard = h;
      if (!cell.highest_hard || h > *cell.highest_hard) cell.highest_hard = h;
      if (2 * h >= *cell.lowest_hard + *cell.highest_hard) cell.MakeYoung(odd);
    }
    return true;
  }

  bool BridgeGround(const Vec3& from_odom, const Vec3& to_odom) {
    const Point from = Exactly(from_odom);
    const Point to = Exactly(to_odom);
    const double dx = to.x - from.x;
    const double dy = to.y - from.y;
    const double length = std::hypot(dx, dy);
    const auto first = KeyAt(from.x, from.y);
    const auto last = KeyAt(to.x, to.y);
    if (!first || !last || (length < 0.01 && *first != *last)) return false;
    std::vector<std::pair<Key, int64_t>> grounds;
    for (int32_t y = std::min(first->second, last->second);
         y <= std::max(first->second, last->second); ++y) {
      for (int32_t x = std::min(first->first, last->first);
           x <= std::max(first->first, last->first); ++x) {
        const Key key = {x, y};
        if (key != *first && key != *last) {
          const std::optional<bool> crossed = LineCrosses(key, from, dx / length, dy / length);
          if (!crossed) return false;
          if (!*crossed) continue;  // and what it crosses in the box lies between the ends
        }
        double part = 0.0;
        if (length > 0.0) {
          part = ((Middle(x) - from.x) * dx + (Middle(y) - from.y) * dy) / (length * length);
        }
        part = std::min(1.0, std::max(0.0, part));
        const auto height = InCentimeters(from.z + (to.z - from.z) * part);
        if (!height) return false;
        grounds.push_back({key, *height});
      }
    }
    for (const auto& [key, height] : grounds) TakeAsGround(key, height);
    return true;
  }

  bool AssumeGround(const Vec3& center_odom, double radius_m) {
    const Point center = Exactly(center_odom);
    const auto height = InCentimeters(center.z);
    if (!height) return false;
    std::vector<Key> near;
    const auto lowest = [&](double middle) { return std::lround((middle - radius_m) * 5.0) - 2; };
    const auto highest = [&](double middle) { return std::lround((middle + radius_m) * 5.0) + 2; };
    for (int32_t y = static_cast<int32_t>(lowest(center.y)); y <= highest(center.y); ++y) {
      for (int32_t x = static_cast<int32_t>(lowest(center.x)); x <= highest(center.x); ++x) {
        const double far = std::hypot(Middle(x) - center.x, Middle(y) - center.y);
        if (std::abs(far - radius_m) < 1.0e-4) return false;
        if (far < radius_m) near.push_back({x, y});
      }
    }
    for (const Key& key : near) TakeAsGround(key, *height);
    return true;
  }

  bool Age(const SightFan& fan, uint32_t revolution, int ageing_revolutions) {
    double furthest = 0.0;
    for (int beam = 0; beam < fan.beams; ++beam) {
      furthest = std::max(furthest, static_cast<double>(fan.level_m[beam]));
    }
    std::vector<std::pair<Key, Outcome>> outcomes;
    for (const auto& [key, cell] : cells_) {
      if (!cell.HasObstacle()) continue;
      const std::optional<bool> crossed = RayCrosses(key, fan, furthest);
      if (!crossed) return false;
      if (!*crossed) continue;
      const Outcome loose = Judge(key, cell, fan, 1.0);
      const Outcome tight = Judge(key, cell, fan, -1.0);
      if (!(loose == tight)) return false;
      outcomes.push_back({key, loose});
    }
    const bool odd = revolution % 2 == 1;
    for (const auto& [key, outcome] : outcomes) {
      Cell& cell = cells_[key];
      if (outcome.hit) {
        cell.MakeYoung(odd);
      } else if (outcome.seen_through && cell.sight_odd != odd) {
        cell.sight_odd = odd;
        if (++cell.misses >= ageing_revolutions) Cut(cell, outcome);
      }
    }
    return true;
  }

  HeightGrid::CellHeights At(hardpack::Cell place) const {
    const auto found = cells_.find({place.x, place.y});
    if (found == cells_.end()) return {};
    const Cell& cell = found->second;
    const auto told = [](const std::optional<int64_t>& height) {
      return height ? static_cast<int16_t>(*height) : HeightGrid::kNone;
    };
    return {told(cell.lowest),
            told(cell.lowest_hard),
            told(cell.highest_hard),
            told(cell.highest_soft),
            cell.ground,
            cell.memory > 0 && cell.highest_hard,
            cell.ground,
            cell.ground && cell.beside};
  }

  const GridWindow& window() const { return window_; }

  int obstacles() const {
    int count = 0;
    for (const auto& [key, cell] : cells_) count += cell.HasObstacle() ? 1 : 0;
    return count;
  }

 private:
  using Key = std::pair<int32_t, int32_t>;

  struct Cell {
    std::optional<int64_t> lowest;
    std::optional<int64_t> lowest_hard;
    std::optional<int64_t> highest_hard;
    std::optional<int64_t> highest_soft;
    bool ground = false;
    bool beside = false;  // the ground's height is a guess from beside
    int memory = 0;
    int misses = 0;
    bool sight_odd = false;
    bool filed_odd = false;

    bool HasObstacle() const { return highest_hard || highest_soft; }
    void MakeYoung(bool odd) {
      misses = 0;
      sight_odd = odd;
    }
  };

  struct Outcome {
    bool hit = false;
    bool seen_through = false;
    std::optional<int64_t> cut_cm;  // none: all of it goes
    bool operator==(const Outcome&) const = default;
  };

  struct Point {
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;
  };
  static Point Exactly(const Vec3& point) {
    return {static_cast<double>(point.x_m), static_cast<double>(point.y_m),
            static_cast<double>(point.z_m)};
  }
  static Point UnitDirection(const SightFan& fan) {
    const Point along = Exactly({fan.direction_odom.x_m, fan.direction_odom.y_m, 0.0f});
    const double length = std::hypot(along.x, along.y);
    return {along.x / length, along.y / length, 0.0};
  }

  bool Inside(const Key& key) const { return window_.Contains({key.first, key.second}); }

  static double Middle(int32_t cell) { return (cell + 0.5) * 0.2; }

  static std::optional<int32_t> CellOf(double coordinate_m) {
    const double cells = coordinate_m / 0.2;
    if (std::abs(cells - std::round(cells)) < 1.0e-3) return std::nullopt;
    return static_cast<int32_t>(std::floor(cells));
  }

  static std::optional<Key> KeyAt(double x_m, double y_m) {
    const auto x = CellOf(x_m);
    const auto y = CellOf(y_m);
    if (!x || !y) return std::nullopt;
    return Key{*x, *y};
  }

  std::optional<int64_t> InCentimeters(double height_m) const {
    const double cm = height_m * 100.0;
    if (std::abs(cm - std::floor(cm) - 0.5) < 0.01) return std::nullopt;
    const int64_t rounded = static_cast<int64_t>(std::round(cm));
    return std::clamp<int64_t>(rounded, shift_cm_ - HeightGrid::kMaxHeight_cm,
                               shift_cm_ + HeightGrid::kMaxHeight_cm);
  }

  void TakeAsGround(const Key& key, int64_t height) {
    if (!Inside(key)) return;
    Cell& cell = cells_[key];
    if (cell.ground) return;
    cell.ground = true;
    cell.beside = true;
    if (!cell.lowest || height < *cell.lowest) cell.lowest = height;
  }

  // Corners on both sides of the line through a point.
  static std::optional<bool> LineCrosses(const Key& key, const Point& from, double ux, double uy) {
    double least = 1.0e9;
    double most = -1.0e9;
    for (int corner = 0; corner < 4; ++corner) {
      const double x = (key.first + corner % 2) * 0.2 - from.x;
      const double y = (key.second + corner / 2) * 0.2 - from.y;
      least = std::min(least, ux * y - uy * x);
      most = std::max(most, ux * y - uy * x);
    }
    if (std::abs(least) < 3.0e-4 || std::abs(most) < 3.0e-4) return std::nullopt;
    return least < 0.0 && most > 0.0;
  }

  // As far as some beam came, and then some: what lies further away has no evidence at all.
  static std::optional<bool> RayCrosses(const Key& key, const SightFan& fan, double furthest) {
    const Point sensor = Exactly(fan.sensor_odom);
    const Point unit = UnitDirection(fan);
    const double ux = unit.x;
    const double uy = unit.y;
    const double x = Middle(key.first) - sensor.x;
    const double y = Middle(key.second) - sensor.y;
    const double d = ux * x + uy * y;
    if (furthest <= 0.0 || d > furthest + 1.0 || d < -0.2) return false;
    const std::optional<bool> crossed = LineCrosses(key, sensor, ux, uy);
    if (!crossed || !*crossed) return crossed;
    // It leaves the cell ahead of the sensor where it crosses the far side of either axis.
    double leaves = 1.0e9;
    if (ux != 0.0) leaves = std::min(leaves, (x + (ux > 0.0 ? 0.1 : -0.1)) / ux);
    if (uy != 0.0) leaves = std::min(leaves, (y + (uy > 0.0 ? 0.1 : -0.1)) / uy);
    if (std::abs(leaves) < 1.0e-3) return std::nullopt;
    return leaves > 0.0;
  }

  // sign 1: everything that is nearly so is so; -1: what is only just so is not.
  static Outcome Judge(const Key& key, const Cell& cell, const SightFan& fan, double sign) {
    const double eps_m = sign * 3.0e-4;
    const double eps_cm = sign * 0.03;
    const Point sensor = Exactly(fan.sensor_odom);
    const Point unit = UnitDirection(fan);
    const double d =
        (Middle(key.first) - sensor.x) * unit.x + (Middle(key.second) - sensor.y) * unit.y;
    const double low = static_cast<double>(cell.highest_hard ? *cell.lowest_hard : *cell.lowest);
    const double high =
        static_cast<double>(cell.highest_hard ? *cell.highest_hard : *cell.highest_soft);
    const double middle = (low + high) / 2.0;
    double spacing = 0.0;
    if (fan.beams > 1) {
      spacing = std::max(0.0, static_cast<double>(fan.highest_slope) -
                                  static_cast<double>(fan.lowest_slope)) /
                (fan.beams - 1);
    }
    const double margin = 3.0 + 100.0 * spacing * std::max(d, 0.0);

    Outcome outcome;
    bool ended = false;
    bool below = false;
    bool above = false;
    std::optional<double> lowest_inside;
    double highest_end = low;
    for (int beam = 0; beam < fan.beams; ++beam) {
      const double level = static_cast<double>(fan.level_m[beam]);
      if (level <= 0.0) continue;
      const double slope = static_cast<double>(fan.slope[beam]);
      const double height = 100.0 * (sensor.z + slope * std::min(level, d));
      const bool in_reach = height >= low - margin - eps_cm && height <= high + margin + eps_cm;
      if (level > d - 0.15 - eps_m && level <= d + 0.3 + eps_m && in_reach) {
        ended = true;
        highest_end = std::max(highest_end, height);
        if (height >= middle - 3.0 - eps_cm) outcome.hit = true;
      }
      if (level > d + 0.3 - eps_m) {
        const double half = 100.0 * 0.2 / std::sqrt(2.0) * std::abs(slope);
        const double top = height + half;
        const double bottom = height - half;
        if (bottom >= low - eps_cm && top <= high - 3.0 + eps_cm) {
          lowest_inside = std::min(lowest_inside.value_or(1.0e9), top);
        }
        if (top <= middle + eps_cm && top >= low - margin - eps_cm) below = true;
        if (bottom >= middle - eps_cm && bottom <= high + margin + eps_cm) above = true;
      }
    }
    if (outcome.hit) return outcome;
    if (lowest_inside) {
      outcome.seen_through = true;
      // Both ways of rounding are tried, so that a half is nobody's.
      outcome.cut_cm =
          static_cast<int64_t>(std::round(std::max(*lowest_inside, highest_end) + eps_cm));
      return outcome;
    }
    // That no beam ended here is the one condition that gets rarer when all are loosened.
    outcome.seen_through = below && above && !ended;
    return outcome;
  }

  static void Cut(Cell& cell, const Outcome& outcome) {
    cell.misses = 0;
    std::optional<int64_t>& highest = cell.highest_hard ? cell.highest_hard : cell.highest_soft;
    const bool hard = cell.highest_hard.has_value();
    const int64_t lowest = hard ? *cell.lowest_hard : *cell.lowest;
    highest = outcome.cut_cm;
    if (highest && *highest <= lowest + HeightGrid::kRest_cm) highest.reset();
    if (hard) cell.memory = 0;
    if (hard && !highest) cell.lowest_hard.reset();
    if (!cell.HasObstacle() && !cell.ground) cell.lowest.reset();
  }

  std::map<Key, Cell> cells_;
  GridWindow window_;
  int64_t shift_cm_ = 0;
};

}  // namespace hardpack
