// SPDX-License-Identifier: Apache-2.0
#include "tools/map_server/map_server.h"

#include <yaml-cpp/yaml.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tools/map_server/grey_image.h"

namespace hardpack::map_server {
namespace {

constexpr double kMinResolution_m = 0.001;
constexpr double kMaxResolution_m = 100.0;
constexpr double kMaxOrigin_m = 1.0e5;
constexpr float kUnknownGrey = 205.0f;  // of 255

// The contents of the YAML file, checked.
struct MapKeys {
  std::string image;
  double resolution_m = 0.0;
  std::array<double, 3> origin = {};  // x [m], y [m], yaw [rad]
  bool negate = false;
  double occupied_thresh = 0.0;
  double free_thresh = 0.0;
  bool scale = false;
};

// A key that is not as it must be; carries the line for the operator. Does not leave this file.
struct KeyError {
  std::string message;
};

std::string Text(double value) {
  std::ostringstream stream;
  stream << value;
  return stream.str();
}

YAML::Node Required(const YAML::Node& root, const std::string& key) {
  const YAML::Node node = root[key];
  if (!node) throw KeyError{key + ": is missing"};
  return node;
}

double Number(const YAML::Node& node, const std::string& key, double low, double high) {
  double value = 0.0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value)) {
    throw KeyError{key + ": is not a number"};
  }
  if (!(value >= low && value <= high)) {
    throw KeyError{key + ": " + Text(value) + " is not within " + Text(low) + " .. " + Text(high)};
  }
  return value;
}

std::string Word(const YAML::Node& node, const std::string& key) {
  if (!node.IsScalar() || node.Scalar().empty()) throw KeyError{key + ": is not a word"};
  return node.Scalar();
}

std::array<double, 3> Origin(const YAML::Node& node) {
  if (!node.IsSequence() || node.size() != 3) throw KeyError{"origin: is not [x, y, yaw]"};
  const std::array<double, 3> origin = {Number(node[0], "origin: x", -kMaxOrigin_m, kMaxOrigin_m),
                                        Number(node[1], "origin: y", -kMaxOrigin_m, kMaxOrigin_m),
                                        Number(node[2], "origin: yaw", -7.0, 7.0)};
  if (origin[2] != 0.0) {
    throw KeyError{"origin: yaw is " + Text(origin[2]) + ", only 0 is supported (turn the image)"};
  }
  return origin;
}

MapKeys Keys(const YAML::Node& root) {
  if (!root.IsMap()) throw KeyError{"is not a map description (key: value lines)"};
  MapKeys keys;
  keys.image = Word(Required(root, "image"), "image");
  keys.resolution_m =
      Number(Required(root, "resolution"), "resolution", kMinResolution_m, kMaxResolution_m);
  keys.origin = Origin(Required(root, "origin"));
  keys.negate = Number(Required(root, "negate"), "negate", 0.0, 1.0) > 0.5;
  keys.occupied_thresh = Number(Required(root, "occupied_thresh"), "occupied_thresh", 0.0, 1.0);
  keys.free_thresh = Number(Required(root, "free_thresh"), "free_thresh", 0.0, 1.0);
  if (keys.free_thresh >= keys.occupied_thresh) {
    throw KeyError{"free_thresh: is not below occupied_thresh"};
  }
  const std::string mode = root["mode"] ? Word(root["mode"], "mode") : "trinary";
  if (mode != "trinary" && mode != "scale") {
    throw KeyError{"mode: '" + mode + "' is not supported (trinary or scale)"};
  }
  keys.scale = mode == "scale";
  return keys;
}

ReadOutcome ReadKeys(const std::string& yaml_path, MapKeys& keys) {
  std::error_code ignored;
  if (std::filesystem::is_directory(yaml_path, ignored)) {
    return {Status::kInvalidArgument, yaml_path + ": is a folder, not a map's YAML file"};
  }
  std::ifstream file(yaml_path, std::ios::binary);
  if (!file) return {Status::kInvalidArgument, yaml_path + ": cannot be opened"};
  try {
    keys = Keys(YAML::Load(file));
  } catch (const KeyError& error) {
    return {Status::kInvalidArgument, yaml_path + ": " + error.message};
  } catch (const YAML::Exception& error) {
    return {Status::kInvalidArgument,
            yaml_path + ": line " + std::to_string(error.mark.line + 1) + ": is not YAML"};
  }
  return {};
}

Occupancy Classify(const MapKeys& keys, float white, bool transparent) {
  if (keys.scale && transparent) return Occupancy::kUnknown;
  // Half a grey level of tolerance: a 16-bit 205/255 is still 205.
  if (!keys.scale && std::abs(white * 255.0f - kUnknownGrey) < 0.5f) return Occupancy::kUnknown;
  const double occupied = keys.negate ? double{white} : 1.0 - double{white};
  if (occupied > keys.occupied_thresh) return Occupancy::kHard;
  return occupied < keys.free_thresh ? Occupancy::kFree : Occupancy::kSoft;
}

}  // namespace

ReadOutcome ReadOccupancyMap(const std::string& yaml_path, OccupancyMap& map) {
  map = {};
  MapKeys keys;
  if (ReadOutcome outcome = ReadKeys(yaml_path, keys); !outcome.ok()) return outcome;
  const std::filesystem::path folder = std::filesystem::path(yaml_path).parent_path();
  GreyImage image;
  if (ReadOutcome outcome = ReadGreyImage((folder / keys.image).string(), image); !outcome.ok()) {
    outcome.message += " (image of " + yaml_path + ")";
    return outcome;
  }
  map.width_px = image.width_px;
  map.height_px = image.height_px;
  map.resolution_m = keys.resolution_m;
  map.origin_x_m = keys.origin[0];
  map.origin_y_m = keys.origin[1];
  map.pixels.resize(image.white.size());
  const size_t width = static_cast<size_t>(image.width_px);
  for (size_t i = 0; i < image.white.size(); ++i) {
    const bool transparent = !image.transparent.empty() && image.transparent[i] != 0;
    const size_t row_up = static_cast<size_t>(image.height_px) - 1 - i / width;
    map.pixels[row_up * width + i % width] = Classify(keys, image.white[i], transparent);
  }
  return {};
}

}  // namespace hardpack::map_server
