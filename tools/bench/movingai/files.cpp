// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <string_view>

#include "tools/bench/movingai/movingai.h"

namespace hardpack {
namespace {

// No line of either format comes near this; a file of another kind may be one long line.
constexpr size_t kMaxLine = 4096;

// Lines of a text file, without their LF or CRLF, and messages about them.
class LineReader {
 public:
  explicit LineReader(const std::string& path) : path_(path), file_(path, std::ios::binary) {}

  // The next line; none at the end of the file.
  std::optional<std::string_view> Next() {
    if (!std::getline(file_, line_)) return std::nullopt;
    ++number_;
    if (line_.ends_with('\r')) line_.pop_back();
    return std::string_view(line_).substr(0, kMaxLine);
  }

  bool is_open() const { return file_.is_open(); }
  int number() const { return number_; }

  std::string Unreadable() const { return path_ + ": cannot be read"; }
  std::string Complaint(const std::string& what) const {
    return path_ + ":" + std::to_string(number_) + ": " + what;
  }
  std::string EndsEarly(const std::string& what) const {
    return path_ + ":" + std::to_string(number_) + ": the file ends where " + what + " should be";
  }

 private:
  std::string path_;
  std::ifstream file_;
  std::string line_;
  int number_ = 0;
};

std::vector<std::string_view> Words(std::string_view line) {
  constexpr std::string_view kBlank = " \t";
  std::vector<std::string_view> words;
  size_t begin = line.find_first_not_of(kBlank);
  while (begin != std::string_view::npos) {
    const size_t end = std::min(line.find_first_of(kBlank, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlank, end);
  }
  return words;
}

template <typename T>
bool ToNumber(std::string_view word, T& number) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  return error == std::errc() && end == word.data() + word.size();
}

// "height H" or "width W".
std::string ReadSize(LineReader& reader, std::string_view name, int& size) {
  const auto line = reader.Next();
  std::string expected = "\"";
  expected += name;
  expected += " N\", N from 1 to " + std::to_string(kMapSize_cells);
  if (!line) return reader.EndsEarly(expected);
  const auto words = Words(*line);
  const bool good = words.size() == 2 && words[0] == name && ToNumber(words[1], size) &&
                    size >= 1 && size <= kMapSize_cells;
  return good ? "" : reader.Complaint("expected " + expected);
}

std::string ReadRow(LineReader& reader, MovingaiMap& map) {
  const auto line = reader.Next();
  if (!line) return reader.EndsEarly("a row of the map");
  if (line->size() != static_cast<size_t>(map.width_cells)) {
    return reader.Complaint("expected a row of " + std::to_string(map.width_cells) +
                            " characters, found " + std::to_string(line->size()));
  }
  for (const char c : *line) {
    const bool free = c == '.' || c == 'G' || c == 'S';
    if (!free && c != '@' && c != 'O' && c != 'T' && c != 'W') {
      return reader.Complaint("a character other than . G S @ O T W");
    }
    map.free.push_back(free);
  }
  return "";
}

// Half a unit of the last decimal the length is written with; whole numbers are exact.
double RoundingOf(std::string_view length) {
  const size_t point = length.find('.');
  if (point == std::string_view::npos) return 0.0;
  double rounding = 0.5;
  for (size_t i = point + 1; i < length.size(); ++i) rounding /= 10.0;
  return rounding;
}

std::string ParseProblem(const LineReader& reader, std::string_view line,
                         MovingaiProblem& problem) {
  const auto words = Words(line);
  if (words.size() != 9) {
    return reader.Complaint("expected 9 columns, found " + std::to_string(words.size()));
  }
  int& width = problem.map_width_cells;
  int& height = problem.map_height_cells;
  const bool numbers = ToNumber(words[2], width) && ToNumber(words[3], height) &&
                       ToNumber(words[4], problem.start.x) && ToNumber(words[5], problem.start.y) &&
                       ToNumber(words[6], problem.goal.x) && ToNumber(words[7], problem.goal.y) &&
                       ToNumber(words[8], problem.optimum_cells);
  if (!numbers) return reader.Complaint("a column is not a number");
  if (width < 1 || height < 1 || width > kMapSize_cells || height > kMapSize_cells) {
    return reader.Complaint("a map size outside 1 to " + std::to_string(kMapSize_cells));
  }
  for (const Cell cell : {problem.start, problem.goal}) {
    if (cell.x < 0 || cell.x >= width || cell.y < 0 || cell.y >= height) {
      return reader.Complaint("a position off the map");
    }
  }
  // Also false for NaN; no path over 512 x 512 cells is longer.
  if (!(problem.optimum_cells >= 0.0 && problem.optimum_cells <= 2.0 * kMapCells)) {
    return reader.Complaint("an invalid length");
  }
  problem.rounding_cells = RoundingOf(words[8]);
  problem.line = reader.number();
  return "";
}

}  // namespace

MovingaiOr<MovingaiMap> ReadMovingaiMap(const std::string& path) {
  LineReader reader(path);
  if (!reader.is_open()) return reader.Unreadable();
  MovingaiMap map;
  const auto type = reader.Next();
  if (!type) return reader.EndsEarly("\"type octile\"");
  if (*type != "type octile") return reader.Complaint("expected \"type octile\"");
  std::string error = ReadSize(reader, "height", map.height_cells);
  if (error.empty()) error = ReadSize(reader, "width", map.width_cells);
  if (!error.empty()) return error;
  const auto header_end = reader.Next();
  if (!header_end) return reader.EndsEarly("\"map\"");
  if (*header_end != "map") return reader.Complaint("expected \"map\"");
  for (int row = 0; row < map.height_cells; ++row) {
    error = ReadRow(reader, map);
    if (!error.empty()) return error;
  }
  return map;
}

MovingaiOr<std::vector<MovingaiProblem>> ReadMovingaiScenarios(const std::string& path) {
  LineReader reader(path);
  if (!reader.is_open()) return reader.Unreadable();
  const auto version = reader.Next();
  if (!version) return reader.EndsEarly("\"version 1\"");
  if (*version != "version 1" && *version != "version 1.0") {
    return reader.Complaint("expected \"version 1\" or \"version 1.0\"");
  }
  std::vector<MovingaiProblem> problems;
  while (const auto line = reader.Next()) {
    if (Words(*line).empty()) continue;
    MovingaiProblem problem;
    const std::string error = ParseProblem(reader, *line, problem);
    if (!error.empty()) return error;
    problems.push_back(problem);
  }
  if (problems.empty()) return reader.EndsEarly("a problem");
  return problems;
}

}  // namespace hardpack
