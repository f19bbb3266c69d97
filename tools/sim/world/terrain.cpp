// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/terrain.h"

#include <algorithm>

namespace hardpack::world {

Terrain::Terrain(const Bounds& bounds, const std::function<double(double, double)>& height_m)
    : low_x_m_(bounds.low_x_m),
      low_y_m_(bounds.low_y_m),
      columns_(static_cast<int>((bounds.high_x_m - bounds.low_x_m) / kStep_m) + 2),
      rows_(static_cast<int>((bounds.high_y_m - bounds.low_y_m) / kStep_m) + 2) {
  heights_m_.reserve(static_cast<size_t>(columns_) * static_cast<size_t>(rows_));
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      heights_m_.push_back(
          static_cast<float>(height_m(low_x_m_ + column * kStep_m, low_y_m_ + row * kStep_m)));
    }
  }
}

Terrain::Place Terrain::PlaceOf(double x_m, double y_m) const {
  // In this order NaN becomes 0.
  const double across = std::max(0.0, std::min((x_m - low_x_m_) / kStep_m, columns_ - 1.001));
  const double up = std::max(0.0, std::min((y_m - low_y_m_) / kStep_m, rows_ - 1.001));
  const int column = static_cast<int>(across);
  const int row = static_cast<int>(up);
  return {static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column),
          across - column, up - row};
}

double Terrain::Height_m(double x_m, double y_m) const {
  if (flat()) return 0.0;
  const Place place = PlaceOf(x_m, y_m);
  const float* near = heights_m_.data() + place.corner;
  const float* far = near + columns_;
  const double low_m = double{near[0]} + place.across * (double{near[1]} - double{near[0]});
  const double high_m = double{far[0]} + place.across * (double{far[1]} - double{far[0]});
  return low_m + place.up * (high_m - low_m);
}

Ground Terrain::At(double x_m, double y_m) const {
  if (flat()) return {};
  const Place place = PlaceOf(x_m, y_m);
  const float* near = heights_m_.data() + place.corner;
  const float* far = near + columns_;
  const double along_x_m = (1.0 - place.up) * (double{near[1]} - double{near[0]}) +
                           place.up * (double{far[1]} - double{far[0]});
  const double along_y_m = (1.0 - place.across) * (double{far[0]} - double{near[0]}) +
                           place.across * (double{far[1]} - double{near[1]});
  const double slope_x = along_x_m / kStep_m;
  const double slope_y = along_y_m / kStep_m;
  const double length = std::sqrt(1.0 + slope_x * slope_x + slope_y * slope_y);
  return {Height_m(x_m, y_m), {-slope_x / length, -slope_y / length, 1.0 / length}};
}

void Terrain::Extremes_m(double low_x_m, double low_y_m, double high_x_m, double high_y_m,
                         double& low_m, double& high_m) const {
  low_m = 0.0;
  high_m = 0.0;
  if (flat()) return;
  const Place first = PlaceOf(low_x_m, low_y_m);
  const auto columns = static_cast<size_t>(columns_);
  const size_t first_row = first.corner / columns;
  const size_t first_column = first.corner % columns;
  const Place last = PlaceOf(high_x_m, high_y_m);
  const size_t last_row = last.corner / columns + 1;
  const size_t last_column = last.corner % columns + 1;
  low_m = high_m = double{heights_m_[first.corner]};
  for (size_t row = first_row; row <= last_row; ++row) {
    for (size_t column = first_column; column <= last_column; ++column) {
      const double height_m = double{heights_m_[row * columns + column]};
      low_m = std::min(low_m, height_m);
      high_m = std::max(high_m, height_m);
    }
  }
}

}  // namespace hardpack::world
