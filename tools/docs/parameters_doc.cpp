// SPDX-License-Identifier: Apache-2.0
// Prints docs/parameters.md from the tables of config/, so that users read what the code checks.
#include <array>
#include <charconv>
#include <cstdio>
#include <string>
#include <system_error>

#include "core/base/validate.h"

namespace hardpack {
namespace {

constexpr const char* kIntroduction = R"(# Parameters

<!-- Printed by parameters_doc (tools/docs/parameters_doc.cpp); do not edit. -->

Every parameter with its default (for the Clearpath Warthog) and its valid range, both ends
included. The name ends in the unit; a name without a unit is a plain number. *(ours)* marks choices that the paper
([OS] in `REFERENCES.md`) leaves open. `hardpack plan --param costmap.halo_m=1.5` sets a parameter of perception or
planning; the onboard program takes all of them from its configuration (`docs/configuration.md`).

The ranges are what the stages can compute with. Conditions on several parameters are
checked where they are used: the costs of both layers must fit a cell (`CheckCostmapParams` in
`core/costmap/costmap.h`), and the ground window must be odd.

The meaning of segmentation codes is a table of its own (`core/segmentation/label_table.h`), RELLIS-3D's by
default; `--param labels.19=hard` changes one code, to `ignored`, `ground`, `soft`, `hard` or `person`.
)";

// The shortest digits that give the same number again.
template <typename Value>
std::string Number(Value value) {
  std::array<char, 32> text;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} ? std::string(text.data(), end) : std::string("?");
}

template <typename Group, size_t kEntries>
std::string Range(const ParameterEntry<Group>& entry,
                  const std::array<ParameterEntry<Group>, kEntries>& table) {
  if (entry.number == nullptr) {
    return Number(RoundToInt(entry.low)) + " to " + Number(RoundToInt(entry.high)) + ", whole";
  }
  std::string range = Number(entry.low) + " to " + Number(entry.high);
  if (entry.not_above == nullptr) return range;
  for (const ParameterEntry<Group>& other : table) {
    if (other.number == entry.not_above) range += ", not above `" + std::string(other.name) + "`";
  }
  return range;
}

constexpr auto kPrintTable = []<typename Group, size_t kEntries>(
                                 const Group& defaults,
                                 const std::array<ParameterEntry<Group>, kEntries>& table) {
  const std::string full_name = table[0].full_name;
  std::printf("\n## %s\n\n", full_name.substr(0, full_name.find('.')).c_str());
  std::printf("| parameter | default | range | meaning |\n|---|---|---|---|\n");
  for (const ParameterEntry<Group>& entry : table) {
    const std::string value =
        entry.number != nullptr ? Number(defaults.*entry.number) : Number(entry.GetWhole(defaults));
    std::printf("| `%s` | %s | %s | %s |\n", entry.full_name, value.c_str(),
                Range(entry, table).c_str(), entry.description);
  }
};

}  // namespace
}  // namespace hardpack

int main() {
  constexpr hardpack::PlannerParams kPlanner;
  constexpr hardpack::PerceptionParams kPerception;
  constexpr hardpack::OnboardParams kOnboard;
  std::fputs(hardpack::kIntroduction, stdout);
  hardpack::VisitParameters(kPlanner, hardpack::kPrintTable);
  hardpack::VisitParameters(kPerception, hardpack::kPrintTable);
  hardpack::VisitParameters(kOnboard, hardpack::kPrintTable);
}
