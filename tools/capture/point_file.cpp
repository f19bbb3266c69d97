// SPDX-License-Identifier: Apache-2.0
#include "tools/capture/point_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>

#include "port_linux/files/read_file.h"

namespace hardpack::capture {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr size_t kMaxFile_bytes = size_t{1} << 31;

ReadOutcome Failure(const std::string& file, const std::string& what,
                    Status status = Status::kInvalidArgument) {
  return {status, file + ": " + what};
}

// The words of a line, separated by `separator` and trimmed. Between two commas is an empty word.
std::vector<std::string_view> WordsOf(std::string_view line, char separator) {
  std::vector<std::string_view> words;
  while (!line.empty()) {
    const size_t end = line.find(separator);
    std::string_view word = line.substr(0, end);
    while (!word.empty() && std::isspace(static_cast<unsigned char>(word.back()))) {
      word.remove_suffix(1);
    }
    while (!word.empty() && std::isspace(static_cast<unsigned char>(word.front()))) {
      word.remove_prefix(1);
    }
    if (!word.empty() || separator == ',') words.push_back(word);
    line = end == std::string_view::npos ? std::string_view{} : line.substr(end + 1);
  }
  return words;
}

// Takes the next line from `text`, without its end.
std::string_view TakeLine(std::string_view& text) {
  const size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

// "nan" counts as a number.
std::optional<double> NumberOf(std::string_view word) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return number;
}

std::optional<int64_t> CountOf(std::string_view word) {
  int64_t count = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
  if (error != std::errc() || end != word.data() + word.size() || count < 0) return std::nullopt;
  return count;
}

std::string LowerCase(std::string_view word) {
  std::string lower(word);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char letter) { return std::tolower(letter); });
  return lower;
}

// The indices of the required fields in the file; -1: it has no field of that name.
struct Columns {
  std::array<int, 3> position = {-1, -1, -1};
  int ring = -1;

  bool complete() const {
    return std::ranges::all_of(position, [](int i) { return i >= 0; });
  }
  void Name(int index, std::string_view name) {
    const std::string lower = LowerCase(name);
    for (int axis = 0; axis < 3; ++axis) {
      if (lower == std::string_view("xyz").substr(static_cast<size_t>(axis), 1)) {
        position[static_cast<size_t>(axis)] = index;
      }
    }
    if (lower == "ring" || lower == "laser_id" || lower == "channel") ring = index;
  }
};

// Adds a point, with a ring if the file has them; false: not a valid ring number.
bool Add(const std::array<double, 3>& position_m, bool has_ring, double ring, PointCloud& cloud) {
  CloudPoint point;
  if (has_ring) {
    if (!(ring >= 0.0 && ring <= 65535.0) || ring != std::floor(ring)) return false;
    point.ring = static_cast<int32_t>(ring);
  }
  const auto [x_m, y_m, z_m] = position_m;
  point.position = {static_cast<float>(x_m), static_cast<float>(y_m), static_cast<float>(z_m)};
  if (IsFinite(point.position)) {
    cloud.points.push_back(point);
  } else {
    ++cloud.without_position;
  }
  return true;
}

// --- lines of numbers
// -----------------------------------------------------------------------------

// One point from the words of a line.
ReadOutcome AddLine(const std::string& place, const std::vector<std::string_view>& words,
                    const Columns& columns, PointCloud& cloud) {
  const auto number = [&words](int index) -> std::optional<double> {
    if (index < 0 || static_cast<size_t>(index) >= words.size()) return std::nullopt;
    return NumberOf(words[static_cast<size_t>(index)]);
  };
  std::array<double, 3> position = {};
  for (size_t axis = 0; axis < position.size(); ++axis) {
    const std::optional<double> value = number(columns.position[axis]);
    if (!value) return Failure(place, std::string(1, "xyz"[axis]) + ": not a number");
    position[axis] = *value;
  }
  const std::optional<double> ring = number(columns.ring);
  if (columns.ring >= 0 && !ring) return Failure(place, "ring: not a number");
  if (!Add(position, ring.has_value(), ring.value_or(0.0), cloud)) {
    return Failure(place, "ring: not a whole number from 0 to 65535");
  }
  return {};
}

ReadOutcome ReadLines(const std::string& path, std::string_view text, int line_number,
                      char separator, const Columns& columns, PointCloud& cloud) {
  for (; !text.empty(); ++line_number) {
    const std::string_view line = TakeLine(text);
    if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
    const std::string place = path + ":" + std::to_string(line_number);
    ReadOutcome outcome = AddLine(place, WordsOf(line, separator), columns, cloud);
    if (!outcome.ok()) return outcome;
    if (static_cast<int64_t>(cloud.points.size()) > kMaxCloudPoints) {
      return Failure(path, "more than 16 million points", Status::kCapacityExceeded);
    }
  }
  return {};
}

ReadOutcome PointsOfCsv(const std::string& path, std::string_view text, PointCloud& cloud) {
  std::string_view rest = text;
  const std::vector<std::string_view> words = WordsOf(TakeLine(rest), ',');
  Columns columns;
  if (words.size() >= 3 &&
      std::ranges::all_of(words, [](auto word) { return NumberOf(word).has_value(); })) {
    columns.position = {0, 1, 2};
    return ReadLines(path, text, 1, ',', columns, cloud);
  }
  for (size_t i = 0; i < words.size(); ++i) columns.Name(static_cast<int>(i), words[i]);
  if (!columns.complete()) {
    return Failure(path + ":1", "neither the names x, y and z nor three numbers");
  }
  return ReadLines(path, rest, 2, ',', columns, cloud);
}

// --- PCD
// ------------------------------------------------------------------------------------------

struct PcdField {
  std::string name;
  int64_t size_bytes = 4;
  char type = 'F';  // I, U or F
  int64_t count = 1;
};

struct PcdHeader {
  std::vector<PcdField> fields;
  int64_t points = -1;
  int64_t width = -1;
  int64_t height = -1;
  std::string data;  // ascii, binary or binary_compressed
  int lines = 0;
};

// Parses a line into the header. Empty, or the error.
std::string TakeEntry(const std::vector<std::string_view>& words, PcdHeader& header) {
  const std::string_view key = words[0];
  const size_t values = words.size() - 1;
  if (key == "FIELDS") {
    header.fields.resize(values);
    for (size_t i = 0; i < values; ++i) header.fields[i].name = words[i + 1];
    return {};
  }
  if (key == "SIZE" || key == "COUNT" || key == "TYPE") {
    if (values != header.fields.size())
      return std::string(key) + ": needs one value for each of FIELDS";
    for (size_t i = 0; i < values; ++i) {
      const std::string_view word = words[i + 1];
      if (key == "TYPE") {
        header.fields[i].type = word[0];
        continue;
      }
      const std::optional<int64_t> number = CountOf(word);
      if (!number || *number > 65536) return std::string(key) + ": not a size";
      (key == "SIZE" ? header.fields[i].size_bytes : header.fields[i].count) = *number;
    }
    return {};
  }
  if (key == "DATA" && values == 1) {
    header.data = words[1];
    return {};
  }
  if (key == "POINTS" || key == "WIDTH" || key == "HEIGHT") {
    const std::optional<int64_t> number = values == 1 ? CountOf(words[1]) : std::nullopt;
    if (!number) return std::string(key) + ": not a number";
    (key == "POINTS" ? header.points : key == "WIDTH" ? header.width : header.height) = *number;
    return {};
  }
  return key == "VERSION" || key == "VIEWPOINT"
             ? std::string{}
             : std::string(key) + ": not an entry of a PCD header";
}

ReadOutcome ReadHeader(const std::string& path, std::string_view& text, PcdHeader& header) {
  while (header.data.empty()) {
    if (text.empty()) return Failure(path, "no DATA: not a PCD file, or cut off");
    const std::string_view line = TakeLine(text);
    ++header.lines;
    if (line.empty() || line[0] == '#') continue;
    const std::vector<std::string_view> words = WordsOf(line, ' ');
    if (words.empty()) continue;
    const std::string wrong = TakeEntry(words, header);
    if (!wrong.empty()) return Failure(path + ":" + std::to_string(header.lines), wrong);
  }
  if (header.points < 0 && header.width >= 0 && header.height >= 0 &&
      header.width <= kMaxCloudPoints && header.height <= kMaxCloudPoints) {
    header.points = header.width * header.height;
  }
  if (header.points < 0) return Failure(path, "POINTS: missing");
  if (header.points > kMaxCloudPoints) {
    return Failure(path, "POINTS: more than 16 million", Status::kCapacityExceeded);
  }
  return {};
}

template <typename T>
double As(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(value));
  return static_cast<double>(value);
}

// The reader for a field of that type and size; nullptr: not in the format.
using ReadNumber = double (*)(const char*);
ReadNumber ReaderOf(const PcdField& field) {
  const int64_t size = field.size_bytes;
  if (field.type == 'F') return size == 4 ? As<float> : size == 8 ? As<double> : nullptr;
  if (field.type == 'U') {
    return size == 1 ? As<uint8_t> : size == 2 ? As<uint16_t> : size == 4 ? As<uint32_t> : nullptr;
  }
  if (field.type != 'I') return nullptr;
  return size == 1 ? As<int8_t> : size == 2 ? As<int16_t> : size == 4 ? As<int32_t> : nullptr;
}

struct BinaryField {
  size_t offset_bytes = 0;
  ReadNumber read = nullptr;
};

ReadOutcome ReadBinary(const std::string& path, std::string_view bytes, const PcdHeader& header,
                       PointCloud& cloud) {
  std::array<BinaryField, 4> wanted;  // x, y, z, ring
  size_t point_bytes = 0;
  for (size_t i = 0; i < header.fields.size(); ++i) {
    const PcdField& field = header.fields[i];
    Columns named;
    named.Name(0, field.name);
    for (size_t k = 0; k < 4; ++k) {
      if ((k < 3 ? named.position[k] : named.ring) < 0) continue;
      if (field.count != 1 || ReaderOf(field) == nullptr) {
        return Failure(path, field.name + ": not one number of a known type");
      }
      wanted[k] = {point_bytes, ReaderOf(field)};
    }
    point_bytes += static_cast<size_t>(field.size_bytes * field.count);
  }
  const auto points = static_cast<size_t>(header.points);
  if (point_bytes == 0 || bytes.size() / point_bytes < points) {
    return Failure(path,
                   "cut off: " + std::to_string(bytes.size()) + " bytes for " +
                       std::to_string(points) + " points of " + std::to_string(point_bytes),
                   Status::kTruncated);
  }
  cloud.points.reserve(points);
  for (size_t i = 0; i < points; ++i) {
    const char* const point = bytes.data() + i * point_bytes;
    const auto read = [point](const BinaryField& field) {
      return field.read(point + field.offset_bytes);
    };
    const bool has_ring = wanted[3].read != nullptr;
    const std::array<double, 3> position_m = {read(wanted[0]), read(wanted[1]), read(wanted[2])};
    if (!Add(position_m, has_ring, has_ring ? read(wanted[3]) : 0.0, cloud)) {
      return Failure(path, "point " + std::to_string(i) + ": ring: not from 0 to 65535");
    }
  }
  return {};
}

// In lines a field of several numbers takes as many words.
Columns WordsOfFields(const PcdHeader& header) {
  Columns columns;
  int64_t word = 0;
  for (const PcdField& field : header.fields) {
    columns.Name(static_cast<int>(word), field.name);
    word += field.count;
  }
  return columns;
}

ReadOutcome PointsOfPcd(const std::string& path, std::string_view text, PointCloud& cloud) {
  PcdHeader header;
  if (ReadOutcome outcome = ReadHeader(path, text, header); !outcome.ok()) return outcome;
  const Columns columns = WordsOfFields(header);
  if (!columns.complete()) return Failure(path, "FIELDS: x, y and z are needed");
  if (header.data == "binary") return ReadBinary(path, text, header, cloud);
  if (header.data != "ascii") {
    return Failure(path,
                   "DATA " + header.data +
                       ": only ascii and binary are read; pcl_convert_pcd_ascii_binary "
                       "IN OUT 1 converts",
                   Status::kUnsupported);
  }
  ReadOutcome outcome = ReadLines(path, text, header.lines + 1, ' ', columns, cloud);
  if (!outcome.ok()) return outcome;
  const int64_t read = static_cast<int64_t>(cloud.points.size()) + cloud.without_position;
  if (read != header.points) {
    return Failure(
        path,
        "POINTS says " + std::to_string(header.points) + ", there are " + std::to_string(read),
        Status::kTruncated);
  }
  return {};
}

// All points or none.
ReadOutcome Whole(const std::string& name, ReadOutcome outcome, PointCloud& cloud) {
  if (outcome.ok() && cloud.points.empty()) outcome = Failure(name, "no points", Status::kEmpty);
  if (!outcome.ok()) cloud = {};
  return outcome;
}

}  // namespace

ReadOutcome ParsePcd(const std::string& name, std::string_view content, PointCloud& cloud) {
  cloud = {};
  return Whole(name, PointsOfPcd(name, content, cloud), cloud);
}

ReadOutcome ParseCsv(const std::string& name, std::string_view content, PointCloud& cloud) {
  cloud = {};
  return Whole(name, PointsOfCsv(name, content, cloud), cloud);
}

ReadOutcome ReadPoints(const std::string& path, PointCloud& cloud) {
  cloud = {};
  const std::string name = LowerCase(path);
  const bool is_pcd = name.ends_with(".pcd");
  if (!is_pcd && !name.ends_with(".csv")) {
    return Failure(path, "its name ends neither with .pcd nor with .csv", Status::kUnsupported);
  }
  std::string content;
  if (ReadOutcome outcome = ReadFile(path, kMaxFile_bytes, content); !outcome.ok()) return outcome;
  return is_pcd ? ParsePcd(path, content, cloud) : ParseCsv(path, content, cloud);
}

}  // namespace hardpack::capture
