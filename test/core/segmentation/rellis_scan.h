// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "config/parameters.h"
#include "core/scan/scan.h"
#include "core/segmentation/segmentation.h"

// A labelled scan of a real OS1-64 on the vehicle of the paper (RELLIS-3D), as the range image that
// the segmenter is given: direction by direction, its lowest beam first.

namespace hardpack {

struct LabelledReturn {
  bool seen = false;
  float x_m = 0.0f;
  float y_m = 0.0f;
  float height_m = 0.0f;
  float range_m = 0.0f;
  int label = 0;
};

class RellisScan {
 public:
  static constexpr int kBeams = 64;
  static constexpr int kDirections = 2048;

  // False when the recording is not there.
  bool Load() {
    const char* folder = std::getenv("HARDPACK_DATA");
    if (folder == nullptr) return false;
    const std::string stem = std::string(folder) + "/rellis/rellis_000104";
    std::ifstream metadata(stem + "_os1-64_2048x10_legacy_reencoded.json");
    std::ifstream points(stem + "_labelled.csv");
    if (!metadata || !points) return false;
    const std::string json((std::istreambuf_iterator<char>(metadata)), {});
    const std::vector<float> altitude_deg = ReadAngles(json, "beam_altitude_angles");
    const std::vector<float> azimuth_deg = ReadAngles(json, "beam_azimuth_angles");
    if (altitude_deg.size() != kBeams) return false;
    const Status made = MakeBeamModel(altitude_deg, azimuth_deg, kDirections, 0.0f, {}, *model_);
    if (made != Status::kOk) return false;
    for (int beam = 0; beam < kBeams; ++beam) {
      const int row = model_->by_altitude[beam];
      slope_[beam] = model_->sin_altitude[row] / model_->cos_altitude[row];
      beam_of_[row] = beam;
    }
    returns_.assign(static_cast<size_t>(kBeams) * kDirections, {});
    std::string line;
    std::getline(points, line);  // the header
    while (std::getline(points, line)) Add(line);
    return true;
  }

  const LabelledReturn& at(int direction, int beam) const {
    return returns_[static_cast<size_t>(direction) * kBeams + static_cast<size_t>(beam)];
  }

  void View(int direction, DirectionView& view) const {
    view.beams = kBeams;
    view.sensor_height_m = kSensorHeight_m;
    for (int beam = 0; beam < kBeams; ++beam) {
      const LabelledReturn& item = at(direction, beam);
      view.seen[beam] = item.seen;
      view.level_m[beam] = std::hypot(item.x_m, item.y_m);
      view.height_m[beam] = item.height_m;
      view.range_m[beam] = item.range_m;
      view.slope[beam] = slope_[beam];
    }
  }

 private:
  // Where the beams leave the sensor, above the ground; its frame begins 36 mm lower.
  static constexpr float kFrameHeight_m = LidarMountParams{}.z_m;
  static constexpr float kSensorHeight_m = kFrameHeight_m + 0.03618f;

  static std::vector<float> ReadAngles(const std::string& json, const char* name) {
    std::vector<float> angles;
    const size_t key = json.find(name);
    if (key == std::string::npos) return angles;
    const size_t open = json.find('[', key);
    const size_t close = json.find(']', open);
    std::string list = json.substr(open + 1, close - open - 1);
    std::replace(list.begin(), list.end(), ',', ' ');
    const char* rest = list.c_str();
    char* end = nullptr;
    for (double value = std::strtod(rest, &end); end != rest; value = std::strtod(rest, &end)) {
      angles.push_back(static_cast<float>(value));
      rest = end;
    }
    return angles;
  }

  // x, y, z, row, measurement id, range, reflectivity, signal, near infrared, label
  void Add(std::string line) {
    std::replace(line.begin(), line.end(), ',', ' ');
    double field[10] = {};
    const char* rest = line.c_str();
    for (double& value : field) {
      char* end = nullptr;
      value = std::strtod(rest, &end);
      rest = end;
    }
    const int row = static_cast<int>(field[3]);
    if (row < 0 || row >= kBeams) return;
    LabelledReturn item;
    item.seen = true;
    item.x_m = static_cast<float>(field[0]);
    item.y_m = static_cast<float>(field[1]);
    item.height_m = static_cast<float>(field[2]) + kFrameHeight_m;
    item.range_m = static_cast<float>(field[5] * 1e-3);
    item.label = static_cast<int>(field[9]);
    LidarMountParams mount;
    mount.self_min_x_m = -2.7f;  // what the recorded vehicle carries reaches so far behind it
    const bool self = item.x_m >= mount.self_min_x_m && item.x_m <= mount.self_max_x_m &&
                      std::abs(item.y_m) <= mount.self_max_abs_y_m &&
                      item.height_m <= mount.self_max_z_m;
    if (self || item.range_m < mount.min_range_m) return;
    const int direction = static_cast<int>(field[4]) - model_->column_shift[row] + kDirections;
    const int place = (direction % kDirections) * kBeams + beam_of_[row];
    returns_[static_cast<size_t>(place)] = item;
  }

  std::unique_ptr<BeamModel> model_ = std::make_unique<BeamModel>();
  int beam_of_[kBeams] = {};  // [row]
  float slope_[kBeams] = {};  // [beam]
  std::vector<LabelledReturn> returns_;
};

// Classes every direction of a revolution, with its neighbours across the seam:
// take(direction, classes).
template <typename Take>
void ClassRevolution(const RellisScan& scan, Segmenter& segmenter, Take take) {
  DirectionView view;
  for (int i = -Segmenter::kLag; i < RellisScan::kDirections + Segmenter::kLag; ++i) {
    scan.View((i + RellisScan::kDirections) % RellisScan::kDirections, view);
    (void)segmenter.Push(view);
    if (i >= Segmenter::kLag) take(i - Segmenter::kLag, segmenter.result());
  }
}

}  // namespace hardpack
