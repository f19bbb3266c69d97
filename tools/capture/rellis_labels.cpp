// SPDX-License-Identifier: Apache-2.0
#include "tools/capture/rellis_labels.h"

#include <array>
#include <charconv>
#include <cstdint>
#include <string_view>
#include <system_error>

#include "port_linux/files/read_file.h"

namespace hardpack::capture {
namespace {

constexpr size_t kMaxFileBytes = 64 * 1024 * 1024;
constexpr std::array<std::string_view, 3> kColumnNames = {"ring", "meas_id", "label"};

// Takes the first line off `rest`, without its end.
std::string_view NextLine(std::string_view& rest) {
  const size_t end = rest.find('\n');
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::vector<std::string_view> Split(std::string_view line) {
  std::vector<std::string_view> fields;
  while (true) {
    const size_t comma = line.find(',');
    fields.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

// One file's state while its lines are read.
class LabelReader {
 public:
  LabelReader(const std::string& path, ScanLabels& labels) : path_(path), labels_(labels) {}

  ReadOutcome Header(std::string_view line) {
    const std::vector<std::string_view> names = Split(line);
    for (size_t wanted = 0; wanted < kColumnNames.size(); ++wanted) {
      size_t found = 0;
      while (found < names.size() && names[found] != kColumnNames[wanted]) ++found;
      if (found == names.size()) return Failure(kColumnNames[wanted], "no such column");
      field_[wanted] = found;
    }
    return {};
  }

  ReadOutcome Line(std::string_view line) {
    ++line_number_;
    if (line.empty()) return {};
    const std::vector<std::string_view> fields = Split(line);
    std::array<int, kColumnNames.size()> values{};
    for (size_t wanted = 0; wanted < values.size(); ++wanted) {
      if (field_[wanted] >= fields.size()) return Failure(kColumnNames[wanted], "missing");
      const std::string_view text = fields[field_[wanted]];
      const char* const end = text.data() + text.size();
      const auto [stop, error] = std::from_chars(text.data(), end, values[wanted]);
      if (error != std::errc() || stop != end) {
        return Failure(kColumnNames[wanted], "not an integer");
      }
    }
    return File(values[0], values[1], values[2]);
  }

 private:
  ReadOutcome File(int ring, int measurement_id, int label) {
    if (ring < 0 || ring >= labels_.beams) return Failure("ring", "the sensor has no such beam");
    if (measurement_id < 0 || measurement_id >= labels_.columns) {
      return Failure("meas_id", "the sensor has no such column");
    }
    if (label < 0 || label > UINT8_MAX) {
      return Failure("label", std::to_string(label) + " is not a code from 0 to 255");
    }
    std::optional<uint8_t>& slot =
        labels_.codes[static_cast<size_t>(measurement_id) * static_cast<size_t>(labels_.beams) +
                      static_cast<size_t>(ring)];
    if (slot) return Failure("meas_id", "this return is listed twice");
    slot = static_cast<uint8_t>(label);
    return {};
  }

  ReadOutcome Failure(std::string_view column, const std::string& what) const {
    return {Status::kInvalidArgument, path_ + ": line " + std::to_string(line_number_) + ": " +
                                          std::string(column) + ": " + what};
  }

  const std::string& path_;
  ScanLabels& labels_;
  int64_t line_number_ = 1;
  std::array<size_t, kColumnNames.size()> field_{};
};

}  // namespace

ReadOutcome ReadLabels(const std::string& path, int beams, int columns, ScanLabels& labels) {
  labels.beams = beams;
  labels.columns = columns;
  labels.codes.assign(static_cast<size_t>(beams) * static_cast<size_t>(columns), std::nullopt);

  std::string text;
  if (ReadOutcome outcome = ReadFile(path, kMaxFileBytes, text); !outcome.ok()) return outcome;
  LabelReader reader(path, labels);
  std::string_view rest = text;
  ReadOutcome outcome = reader.Header(NextLine(rest));
  while (outcome.ok() && !rest.empty()) outcome = reader.Line(NextLine(rest));
  return outcome;
}

}  // namespace hardpack::capture
