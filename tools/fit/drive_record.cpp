// SPDX-License-Identifier: Apache-2.0
#include "tools/fit/drive_record.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <system_error>

#include "port_linux/files/read_file.h"

namespace hardpack::fit {
namespace {

constexpr size_t kColumns = 13;
constexpr size_t kMaxBytes = size_t{64} << 20;
constexpr size_t kLeastSamples = 4;
constexpr double kLargest = 1.0e6;

using Row = std::array<double, kColumns>;

bool ParseRow(std::string_view line, Row& row) {
  const char* at = line.data();
  const char* const end = line.data() + line.size();
  for (size_t column = 0; column < kColumns; ++column) {
    const auto [next, error] = std::from_chars(at, end, row[column]);
    if (error != std::errc{} || !std::isfinite(row[column])) return false;
    if (std::abs(row[column]) > kLargest) return false;
    at = next;
    if (column + 1 == kColumns) break;
    if (at == end || *at != ',') return false;
    ++at;
  }
  return at == end;
}

double Wrapped(double angle_rad) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  return angle_rad - kTurn * std::round(angle_rad / kTurn);
}

DriveSample SampleOf(const Row& row) {
  DriveSample sample;
  sample.t_s = row[2];
  sample.command = {row[3], row[4]};
  sample.measured = {row[5], row[6]};
  sample.x_m = row[7];
  sample.y_m = row[8];
  sample.yaw_rad = row[12];
  return sample;
}

void Append(DriveSegment& segment, DriveSample sample) {
  if (!segment.samples.empty()) {
    const DriveSample& before = segment.samples.back();
    sample.fresh_left = sample.measured.left_radps != before.measured.left_radps;
    sample.fresh_right = sample.measured.right_radps != before.measured.right_radps;
    sample.yaw_rad = before.yaw_rad + Wrapped(sample.yaw_rad - before.yaw_rad);
    sample.fresh_pose =
        sample.x_m != before.x_m || sample.y_m != before.y_m || sample.yaw_rad != before.yaw_rad;
  }
  segment.samples.push_back(sample);
}

// A break between segments shows in the wheels, which do not jump.
void FindHistory(std::vector<DriveSegment>& segments) {
  constexpr double kNoBreak_radps = 1.0;
  for (size_t i = 0; i < segments.size(); ++i) {
    DriveSegment& segment = segments[i];
    segment.history = segment.samples.front().measured;
    if (i == 0 || segments[i - 1].number + 1 != segment.number) continue;
    const DriveSample& before = segments[i - 1].samples.back();
    const sim::WheelSpeeds& now = segment.samples.front().measured;
    segment.has_history = std::abs(before.measured.left_radps - now.left_radps) < kNoBreak_radps &&
                          std::abs(before.measured.right_radps - now.right_radps) < kNoBreak_radps;
    if (segment.has_history) segment.history = before.command;
  }
}

ReadOutcome Fault(const std::string& name, size_t line, const std::string& text) {
  return {Status::kInvalidArgument, name + ":" + std::to_string(line) + ": " + text};
}

}  // namespace

ReadOutcome ParseDriveRecord(std::string_view text, const std::string& name,
                             std::vector<DriveSegment>& segments) {
  std::vector<DriveSegment> read;
  size_t number = 0;
  for (size_t from = 0; from < text.size();) {
    const size_t end = std::min(text.find('\n', from), text.size());
    std::string_view line = text.substr(from, end - from);
    from = end + 1;
    ++number;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (number == 1) {
      if (line != kDriveRecordHeader) return Fault(name, number, "is not a recording of a drive");
      continue;
    }
    Row row;
    if (!ParseRow(line, row)) {
      return Fault(name, number, "expected " + std::to_string(kColumns) + " finite numbers");
    }
    const int segment = row[0] >= 0.0 ? static_cast<int>(row[0]) : -1;  // kLargest fits
    if (segment < 0 || static_cast<double>(segment) != row[0]) {
      return Fault(name, number, "the segment is not a whole number from 0");
    }
    if (read.empty() || read.back().number != segment) {
      if (!read.empty() && read.back().number > segment) {
        return Fault(name, number, "the segments are not in order");
      }
      read.emplace_back().number = segment;
    }
    if (!read.back().samples.empty() && !(row[2] > read.back().samples.back().t_s)) {
      return Fault(name, number, "the time does not increase");
    }
    Append(read.back(), SampleOf(row));
  }
  if (read.empty()) return Fault(name, number, "has no samples");
  for (const DriveSegment& segment : read) {
    if (segment.samples.size() < kLeastSamples) {
      return Fault(name, number,
                   "segment " + std::to_string(segment.number) + " has fewer than " +
                       std::to_string(kLeastSamples) + " samples");
    }
  }
  FindHistory(read);
  segments = std::move(read);
  return {};
}

ReadOutcome ReadDriveRecord(const std::string& path, std::vector<DriveSegment>& segments) {
  std::string text;
  const ReadOutcome outcome = ReadFile(path, kMaxBytes, text);
  return outcome.ok() ? ParseDriveRecord(text, path, segments) : outcome;
}

}  // namespace hardpack::fit
