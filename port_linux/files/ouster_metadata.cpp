// SPDX-License-Identifier: Apache-2.0
#include "port_linux/files/ouster_metadata.h"

#include <array>
#include <charconv>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <tuple>
#include <vector>

#include "core/scan/scan.h"
#include "port_linux/files/read_file.h"

namespace hardpack::ouster {
namespace {

using Json = nlohmann::json;

// The sections that may contain a field besides the top level; the flat form has only data_format.
constexpr std::array kSections = {"beam_intrinsics",   "lidar_intrinsics", "data_format",
                                  "lidar_data_format", "sensor_info",      "config_params"};

struct NamedProfile {
  std::string_view name;
  Profile profile;
};
constexpr std::array kProfiles = {
    NamedProfile{"LEGACY", Profile::kLegacy},
    NamedProfile{"RNG19_RFL8_SIG16_NIR16", Profile::kRng19Rfl8Sig16Nir16},
    NamedProfile{"RNG15_RFL8_NIR8", Profile::kRng15Rfl8Nir8},
    NamedProfile{"RNG19_RFL8_SIG16_NIR16_DUAL", Profile::kRng19Rfl8Sig16Nir16Dual},
};

// Distance of the beams' origin from the lidar's, by product line, for files that do not state it.
struct NamedOrigin {
  std::string_view prefix;
  double origin_mm;
};
constexpr std::array kOrigins = {NamedOrigin{"OS-0-", 27.67}, NamedOrigin{"OS-1-", 15.806},
                                 NamedOrigin{"OS-2-", 13.762}};
constexpr double kFirstGenerationOrigin_mm = 12.163;

constexpr double kMaxAltitude_deg = 90.0;
constexpr double kMaxAzimuth_deg = 360.0;
constexpr double kMaxLength_mm = 10000.0;
constexpr double kMillimetersPerMeter = 1000.0;
constexpr int64_t kMaxColumnsPerFrame = 4096;
constexpr int64_t kMaxColumnsPerPacket = 64;
constexpr int64_t kMaxInitId = 0xffffff;
constexpr uint64_t kMaxSerialNumber = 0xffffffffffu;
constexpr FirmwareVersion kFirstWithCrc = {3, 2, 0};

// A text of the file for a message: short and printable.
std::string Quoted(std::string_view text) {
  constexpr size_t kShown = 40;
  std::string shown = "\"";
  for (const char c : text.substr(0, kShown)) shown += c >= ' ' && c <= '~' ? c : '?';
  return shown + (text.size() > kShown ? "...\"" : "\"");
}

std::string Number(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

// Reads fields one after the other; the first error is kept as the outcome, and every later field
// is reported as absent.
class FieldReader {
 public:
  FieldReader(const Json& root, std::string_view name) : root_(root), name_(name) {}

  bool ok() const { return outcome_.ok(); }
  ReadOutcome outcome() const { return outcome_; }

  void Fail(std::string_view field, const std::string& what,
            Status status = Status::kInvalidArgument) {
    if (!ok()) return;
    outcome_ = {status, std::string(name_) + ": " + std::string(field) + ": " + what};
  }

  // The field, at the top or in a section; nullptr if it is missing or null.
  const Json* Find(const char* field) {
    if (!ok()) return nullptr;
    if (const Json* value = FindIn(root_, field); value != nullptr) return value;
    for (const char* section : kSections) {
      const Json* part = FindIn(root_, section);
      if (part == nullptr) continue;
      if (!part->is_object()) {
        Fail(section, "expected an object");
        return nullptr;
      }
      if (const Json* value = FindIn(*part, field); value != nullptr) return value;
    }
    return nullptr;
  }

  int64_t Integer(const char* field, int64_t low, int64_t high, int64_t absent) {
    const Json* value = Find(field);
    return value == nullptr ? absent : IntegerOf(field, *value, low, high);
  }

  int64_t IntegerOf(const char* field, const Json& value, int64_t low, int64_t high) {
    if (!value.is_number_integer()) {
      Fail(field, "expected an integer");
      return low;
    }
    const bool fits = !value.is_number_unsigned() ||
                      value.get<uint64_t>() <= uint64_t{std::numeric_limits<int64_t>::max()};
    const int64_t number = fits ? value.get<int64_t>() : std::numeric_limits<int64_t>::max();
    if (number < low || number > high) {
      Fail(field, "must be in " + std::to_string(low) + " .. " + std::to_string(high));
      return low;
    }
    return number;
  }

  // Empty when absent.
  std::string Text(const char* field) {
    const Json* value = Find(field);
    if (value == nullptr) return {};
    if (!value->is_string()) {
      Fail(field, "expected a text");
      return {};
    }
    return value->get<std::string>();
  }

  double NumberOf(const char* field, const Json& value, double max_magnitude) {
    if (!value.is_number()) {
      Fail(field, "expected a number");
      return 0.0;
    }
    const double number = value.get<double>();
    if (!std::isfinite(number)) Fail(field, "a number is not finite", Status::kNotFinite);
    if (!(std::abs(number) <= max_magnitude)) {
      Fail(field, Number(number) + " is beyond +-" + Number(max_magnitude));
    }
    return number;
  }

  // An array of numbers; empty when absent.
  std::vector<double> Numbers(const char* field, double max_magnitude) {
    const Json* value = Find(field);
    if (value == nullptr) return {};
    if (!value->is_array()) {
      Fail(field, "expected an array of numbers");
      return {};
    }
    std::vector<double> numbers;
    for (const Json& element : *value) {
      numbers.push_back(NumberOf(field, element, max_magnitude));
      if (!ok()) return {};
    }
    return numbers;
  }

  // A 4 x 4 transform, row-major, lengths in millimetres; 16 zeros when it is wrong.
  std::vector<double> Matrix(const char* field) {
    std::vector<double> matrix = Numbers(field, kMaxLength_mm);
    if (ok() && matrix.size() != 16) {
      Fail(field, std::to_string(matrix.size()) + " numbers, expected 16");
    }
    matrix.resize(16);
    if (ok() && !IsRigid(matrix)) Fail(field, "not a rotation and a translation");
    return matrix;
  }

 private:
  static const Json* FindIn(const Json& object, const char* field) {
    const auto found = object.find(field);
    return found == object.end() || found->is_null() ? nullptr : &*found;
  }

  static bool IsRigid(const std::vector<double>& m) {
    constexpr double kTolerance = 1e-3;
    bool rigid = m[12] == 0.0 && m[13] == 0.0 && m[14] == 0.0 && m[15] == 1.0;
    for (size_t a = 0; a < 3; ++a) {
      for (size_t b = 0; b < 3; ++b) {
        const double product =
            m[4 * a] * m[4 * b] + m[4 * a + 1] * m[4 * b + 1] + m[4 * a + 2] * m[4 * b + 2];
        rigid = rigid && std::abs(product - (a == b ? 1.0 : 0.0)) < kTolerance;
      }
    }
    const double determinant = m[0] * (m[5] * m[10] - m[6] * m[9]) -
                               m[1] * (m[4] * m[10] - m[6] * m[8]) +
                               m[2] * (m[4] * m[9] - m[5] * m[8]);
    return rigid && determinant > 0.0;
  }

  const Json& root_;
  std::string_view name_;
  ReadOutcome outcome_;
};

void ReadBeams(FieldReader& reader, Metadata& metadata) {
  const std::vector<double> altitudes = reader.Numbers("beam_altitude_angles", kMaxAltitude_deg);
  const std::vector<double> azimuths = reader.Numbers("beam_azimuth_angles", kMaxAzimuth_deg);
  if (altitudes.empty()) reader.Fail("beam_altitude_angles", "missing or empty");
  if (azimuths.empty()) reader.Fail("beam_azimuth_angles", "missing or empty");
  const int64_t beams = reader.Integer("pixels_per_column", 1, std::numeric_limits<int32_t>::max(),
                                       static_cast<int64_t>(altitudes.size()));
  if (beams > kMaxBeams) {
    reader.Fail(
        reader.Find("pixels_per_column") == nullptr ? "beam_altitude_angles" : "pixels_per_column",
        std::to_string(beams) + " beams, at most " + std::to_string(kMaxBeams) + " are handled",
        Status::kCapacityExceeded);
  }
  const std::string expected = " numbers, expected " + std::to_string(beams);
  if (static_cast<int64_t>(altitudes.size()) != beams) {
    reader.Fail("beam_altitude_angles", std::to_string(altitudes.size()) + expected);
  }
  if (static_cast<int64_t>(azimuths.size()) != beams) {
    reader.Fail("beam_azimuth_angles", std::to_string(azimuths.size()) + expected);
  }
  if (beams != 16 && beams != 32 && beams != 64 && beams != 128) {
    reader.Fail("beam_altitude_angles",
                std::to_string(beams) + " beams, expected 16, 32, 64 or 128");
  }
  if (!reader.ok()) return;
  metadata.beams = static_cast<int32_t>(beams);
  for (size_t row = 0; row < altitudes.size(); ++row) {
    metadata.beam_altitude_deg[row] = static_cast<float>(altitudes[row]);
    metadata.beam_azimuth_deg[row] = static_cast<float>(azimuths[row]);
  }
}

// Columns of a revolution by the mode's name ("1024x10"); 0 without a mode.
int64_t ColumnsOfMode(FieldReader& reader) {
  const std::string mode = reader.Text("lidar_mode");
  if (!reader.ok() || mode.empty()) return 0;
  for (const int64_t columns : {512, 1024, 2048, 4096}) {
    if (mode.starts_with(std::to_string(columns) + "x")) return columns;
  }
  reader.Fail("lidar_mode", Quoted(mode) + " is not a known mode");
  return 0;
}

void ReadDataFormat(FieldReader& reader, Metadata& metadata) {
  const int64_t mode_columns = ColumnsOfMode(reader);
  const int64_t columns = reader.Integer("columns_per_frame", 1, kMaxColumnsPerFrame, mode_columns);
  if (columns == 0) reader.Fail("lidar_mode", "missing, and no columns_per_frame");
  if (mode_columns != 0 && columns != mode_columns) {
    reader.Fail("columns_per_frame",
                std::to_string(columns) + ", but lidar_mode says " + std::to_string(mode_columns));
  }
  metadata.columns_per_frame = static_cast<int32_t>(columns);
  metadata.columns_per_packet =
      static_cast<int32_t>(reader.Integer("columns_per_packet", 1, kMaxColumnsPerPacket, 16));
  metadata.column_window_first = 0;
  metadata.column_window_last = static_cast<int32_t>(columns - 1);
  if (const Json* window = reader.Find("column_window"); window != nullptr) {
    if (!window->is_array() || window->size() != 2) {
      reader.Fail("column_window", "expected two integers");
      return;
    }
    metadata.column_window_first =
        static_cast<int32_t>(reader.IntegerOf("column_window", (*window)[0], 0, columns - 1));
    metadata.column_window_last =
        static_cast<int32_t>(reader.IntegerOf("column_window", (*window)[1], 0, columns - 1));
  }
}

void ReadProfile(FieldReader& reader, Metadata& metadata) {
  const std::string name = reader.Text("udp_profile_lidar");
  if (!reader.ok() || name.empty()) return;
  for (const NamedProfile& known : kProfiles) {
    if (name == known.name) {
      metadata.profile = known.profile;
      return;
    }
  }
  reader.Fail("udp_profile_lidar", Quoted(name) + " is not a known profile", Status::kUnsupported);
}

// Parses "3.2.0" at the start of the text; the third number may be missing. False if it does not
// begin with a version, or one of its numbers is implausible.
bool ParseVersion(std::string_view text, FirmwareVersion& version) {
  constexpr int32_t kLargest = 9999;
  int32_t* const numbers[] = {&version.first, &version.second, &version.third};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (int32_t* const number : numbers) {
    if (number != numbers[0]) {
      if (at == end || *at != '.') return number == numbers[2];
      ++at;
    }
    // from_chars would accept a sign.
    if (at == end || *at < '0' || *at > '9') return false;
    const auto [stop, error] = std::from_chars(at, end, *number);
    if (error != std::errc() || *number > kLargest) return false;
    at = stop;
  }
  return true;
}

// image_rev is "ousteros-image-prod-aries-v2.3.0+20220415163956", build_rev "v2.3.0", or a commit
// in the manufacturer's own builds: the version follows the first v that has one after it.
FirmwareVersion VersionIn(std::string_view text) {
  for (size_t at = text.find('v'); at != std::string_view::npos; at = text.find('v', at + 1)) {
    FirmwareVersion version;
    const bool begins_word = at == 0 || text[at - 1] == '-';
    if (begins_word && ParseVersion(text.substr(at + 1), version)) return version;
  }
  return {};
}

bool IsBefore(const FirmwareVersion& a, const FirmwareVersion& b) {
  return std::tie(a.first, a.second, a.third) < std::tie(b.first, b.second, b.third);
}

void ReadFirmware(FieldReader& reader, Metadata& metadata) {
  const std::string header_type = reader.Text("header_type");
  if (!header_type.empty() && header_type != "STANDARD") {
    reader.Fail("header_type", Quoted(header_type) + " is not handled", Status::kUnsupported);
    return;
  }
  constexpr FirmwareVersion kUnknown;
  metadata.firmware = VersionIn(reader.Text("image_rev"));
  if (!IsBefore(kUnknown, metadata.firmware)) {
    metadata.firmware = VersionIn(reader.Text("build_rev"));
  }
  metadata.crc_in_footer = !IsBefore(metadata.firmware, kFirstWithCrc);
}

void ReadIdentity(FieldReader& reader, Metadata& metadata) {
  metadata.init_id = static_cast<uint32_t>(reader.Integer("initialization_id", 0, kMaxInitId, 0));
  const std::string serial = reader.Text("prod_sn");
  if (!serial.empty()) {
    uint64_t number = 0;
    const char* const end = serial.data() + serial.size();
    const auto [stop, error] = std::from_chars(serial.data(), end, number);
    if (error != std::errc() || stop != end || number > kMaxSerialNumber) {
      reader.Fail("prod_sn", Quoted(serial) + " is not a serial number");
    }
    metadata.serial_number = number;
  }
  const std::string line = reader.Text("prod_line");
  if (line.size() >= sizeof(metadata.product_line)) {
    reader.Fail("prod_line",
                "longer than " + std::to_string(sizeof(metadata.product_line) - 1) + " characters",
                Status::kCapacityExceeded);
    return;
  }
  line.copy(metadata.product_line, line.size());
}

double OriginOfProductLine(std::string_view line) {
  for (const NamedOrigin& known : kOrigins) {
    if (line.starts_with(known.prefix)) return known.origin_mm;
  }
  return kFirstGenerationOrigin_mm;
}

void ReadGeometry(FieldReader& reader, Metadata& metadata) {
  double origin_mm = OriginOfProductLine(metadata.product_line);
  if (reader.Find("beam_to_lidar_transform") != nullptr) {
    const std::vector<double> m = reader.Matrix("beam_to_lidar_transform");
    if (m[0] != 1.0 || m[5] != 1.0 || m[10] != 1.0 || m[7] != 0.0 || m[11] != 0.0) {
      reader.Fail("beam_to_lidar_transform", "only a shift along x is handled",
                  Status::kUnsupported);
    }
    origin_mm = m[3];
  }
  if (const Json* stated = reader.Find("lidar_origin_to_beam_origin_mm"); stated != nullptr) {
    origin_mm = reader.NumberOf("lidar_origin_to_beam_origin_mm", *stated, kMaxLength_mm);
  }
  metadata.lidar_origin_to_beam_origin_m = static_cast<float>(origin_mm / kMillimetersPerMeter);

  metadata.sensor_from_lidar = {{-1, 0, 0, 0, -1, 0, 0, 0, 1}, {0.0f, 0.0f, 0.03618f}};
  if (reader.Find("lidar_to_sensor_transform") == nullptr) return;
  const std::vector<double> m = reader.Matrix("lidar_to_sensor_transform");
  for (size_t row = 0; row < 3; ++row) {
    for (size_t column = 0; column < 3; ++column) {
      metadata.sensor_from_lidar.rotation[3 * row + column] =
          static_cast<float>(m[4 * row + column]);
    }
  }
  metadata.sensor_from_lidar.translation = {static_cast<float>(m[3] / kMillimetersPerMeter),
                                            static_cast<float>(m[7] / kMillimetersPerMeter),
                                            static_cast<float>(m[11] / kMillimetersPerMeter)};
}

// A direction is complete when all beams have measured it (core/scan).
void CheckSpread(FieldReader& reader, const Metadata& metadata) {
  if (!reader.ok() || metadata.columns_per_frame > kMaxColumnsPerRevolution) return;
  const auto beams = static_cast<size_t>(metadata.beams);
  const auto model = std::make_unique<BeamModel>();
  const Status status =
      MakeBeamModel({metadata.beam_altitude_deg, beams}, {metadata.beam_azimuth_deg, beams},
                    metadata.columns_per_frame, metadata.lidar_origin_to_beam_origin_m,
                    metadata.sensor_from_lidar, *model);
  if (IsUsable(status)) return;
  reader.Fail("beam_azimuth_angles", "spread over more than " + std::to_string(kMaxColumnShift) +
                                         " of " + std::to_string(metadata.columns_per_frame) +
                                         " columns");
}

ReadOutcome ReadFields(const Json& root, std::string_view name, Metadata& metadata) {
  FieldReader reader(root, name);
  Metadata read;
  ReadBeams(reader, read);
  ReadDataFormat(reader, read);
  ReadProfile(reader, read);
  ReadFirmware(reader, read);
  ReadIdentity(reader, read);
  ReadGeometry(reader, read);
  CheckSpread(reader, read);
  if (reader.ok()) metadata = read;
  return reader.outcome();
}

}  // namespace

ReadOutcome ParseMetadata(std::string_view json, std::string_view name, Metadata& metadata) {
  metadata = Metadata{};
  const std::string file(name);
  if (json.size() > kMaxMetadataBytes) {
    return {Status::kOversized, file + ": larger than " + std::to_string(kMaxMetadataBytes) +
                                    " bytes; not a lidar's metadata"};
  }
  try {
    const Json root = Json::parse(json);
    if (!root.is_object()) return {Status::kInvalidArgument, file + ": expected a JSON object"};
    return ReadFields(root, name, metadata);
  } catch (const Json::parse_error& error) {
    return {Status::kInvalidArgument,
            file + ": not JSON (at byte " + std::to_string(error.byte) + ")"};
  } catch (const Json::out_of_range&) {
    return {Status::kNotFinite, file + ": a number is too large to represent"};
  } catch (const std::exception& error) {
    return {Status::kInvalidArgument, file + ": " + error.what()};
  }
}

ReadOutcome ReadMetadata(const std::string& path, Metadata& metadata) {
  metadata = Metadata{};
  std::string text;
  if (ReadOutcome outcome = ReadFile(path, kMaxMetadataBytes, text); !outcome.ok()) return outcome;
  return ParseMetadata(text, path, metadata);
}

}  // namespace hardpack::ouster
