// SPDX-License-Identifier: Apache-2.0
// Prints the configuration's documentation from the list of its keys:
//   configuration_doc page      docs/configuration.md
//   configuration_doc example   config/warthog.toml
#include <algorithm>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "port_linux/files/configuration.h"
#include "port_linux/files/configuration_keys.h"

namespace hardpack {
namespace {

constexpr const char* kPageIntroduction = R"(# Configuration

<!-- Printed by configuration_doc (tools/docs/configuration_doc.cpp); do not edit. -->

`hardpackd` reads all settings of its vehicle from one TOML file. Nothing is guessed: anything it does not understand is
an error, and the program does not start.

1. Copy `config/warthog.toml`. It has every key with its meaning, range and default (for the Clearpath Warthog).
2. Fill in the keys marked `"TO BE FILLED IN"`: no value is right for every vehicle (below).
3. Change what differs on your vehicle: remove the `#` before the key, so that your settings stand out.
4. `hardpackd --check-config FILE` reports every error, one per line:

```
warthog.toml:12: costmap.halo_m: 5 is not a number from 0 to 3 m
warthog.toml:13: costmap.halo: unknown key, did you mean costmap.halo_m?
warthog.toml:20: speed.min_speed_mps: 6.0 is above speed.max_speed_mps, which is 5.0
warthog.toml: drive.gear_ratio: must be set: the Warthog's is not public: measure it
```

`hardpackd --print-config FILE` prints every key with its effective value. Each flight log starts with the same text, and
a replay reads it from there: it is exact, and it does not depend on the defaults of another version.

## File format

Every key belongs to a table: `[costmap]`, then `halo_m = 2.0`. A name ends in its unit. Numbers must be finite. An integer
is accepted where a number is expected, but a fraction is not accepted for a count. A text must be on one line without
control characters; non-ASCII letters are allowed in texts and comments only. An address is IPv4
in quotes, `"10.0.0.5"`; `""` means none. Paths that do not begin with `/` are relative to the program's working directory.
The file may have at most 262144 bytes, a line at most 2000. A table or key that is unknown, duplicate, or in the
wrong table is an error.
)";

constexpr const char* kPageClasses = R"(
## Label classes

`[labels.classes]` maps the codes of the segmentation computer (`docs/label_datagram.md`) to classes: `ignored`,
`ground`, `soft`, `hard` or `person`. Codes that are not listed keep their RELLIS-3D class
(`core/segmentation/label_table.h`), or get the class of `default`:

```toml
[labels.classes]
default = "hard"
2 = "ground"
9 = "soft"
```
)";

constexpr const char* kPageAreas = R"(
## Areas

Each `[[area]]` is a keep-out area, the fence or a speed zone that is in force from the start and that no command removes
(`docs/areas.md`):

```toml
[[area]]
kind = "speed_zone"  # or "keep_out", "fence"
frame = "odom"       # x, y in metres; or "latlon": latitude, longitude in degrees
speed_mps = 1.5      # of a speed zone only
corners = [[25.0, -12.0], [32.0, -12.0], [32.0, 9.0]]
```
)";

constexpr const char* kPageKeys = R"(
## Keys of the program

For the parameters of perception, planning and driving, in the tables `[vehicle]` to `[tick]`, see `docs/parameters.md`.
)";

constexpr const char* kExampleIntroduction =
    R"(# Configuration of hardpackd for a Clearpath Warthog: every key with its meaning, valid values and
# default. Copy this file and fill in the keys marked "TO BE FILLED IN"; to change another key, remove
# the # before it. "hardpackd --check-config FILE" reports every error in a file.
# docs/configuration.md explains it.
#
# Printed by configuration_doc (tools/docs/configuration_doc.cpp); a test compares the two.
)";

constexpr const char* kExampleClasses = R"(
# Classes of the segmentation computer's codes: "ignored", "ground", "soft", "hard" or "person".
# "default" applies to every code that is not listed; without it they stay as they are here, which
# is RELLIS-3D's list.
)";

const RequiredKey* RequiredRow(const ConfigurationKey& key) {
  const auto rows = RequiredKeys();
  const auto row = std::find_if(rows.begin(), rows.end(), [&key](const RequiredKey& candidate) {
    return candidate.full_name == key.full_name;
  });
  return row == rows.end() ? nullptr : &*row;
}

// "A number from 0 to 3 m, not above costmap.x."
std::string Kind(const ConfigurationKey& key) {
  std::string kind = ExpectedOf(key);
  if (kind.front() >= 'a') kind.front() = static_cast<char>(kind.front() - 'a' + 'A');
  if (!key.not_above.empty()) kind += ", not above " + key.not_above;
  return kind + ".";
}

// The text as lines of a comment, at most 100 letters wide.
void PrintComment(std::string_view text) {
  constexpr size_t kWidth = 98;
  while (!text.empty()) {
    size_t end = std::min(kWidth, text.size());
    if (end < text.size()) end = text.rfind(' ', end);
    std::printf("# %.*s\n", static_cast<int>(end), text.data());
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

void PrintExample() {
  Configuration defaults;
  std::fputs(kExampleIntroduction, stdout);
  std::string group;
  for (const ConfigurationKey& key : KeysOf(defaults)) {
    if (key.group() != group) {
      group = key.group();
      std::printf("\n[%s]\n", group.c_str());
    }
    std::printf("\n");
    const RequiredKey* required = RequiredRow(key);
    PrintComment(key.description + " " + Kind(key));
    if (required != nullptr) PrintComment("Required: " + std::string(required->why) + ".");
    if (required != nullptr && required->is_needed(defaults)) {
      std::printf("%s = \"%s\"\n", key.name().c_str(), std::string(kPlaceholder).c_str());
    } else {
      std::printf("#%s = %s\n", key.name().c_str(), ValueText(key).c_str());
    }
  }
  std::fputs(kExampleClasses, stdout);
  const std::string all = ToToml(defaults);
  const std::string classes = all.substr(all.find("[labels.classes]\n"));
  bool is_header = true;
  for (size_t from = 0; from < classes.size(); is_header = false) {
    const size_t end = classes.find('\n', from);
    std::printf("%s%s\n", is_header ? "" : "#", classes.substr(from, end - from).c_str());
    from = end + 1;
  }
}

void PrintRequired(Configuration& defaults) {
  std::printf("\n## Required keys\n\n| key | what it is |\n|---|---|\n");
  for (const ConfigurationKey& key : KeysOf(defaults)) {
    const RequiredKey* required = RequiredRow(key);
    if (required == nullptr) continue;
    std::printf("| `%s` | %s |\n", key.full_name.c_str(), std::string(required->why).c_str());
  }
}

void PrintPage() {
  Configuration defaults;
  std::fputs(kPageIntroduction, stdout);
  PrintRequired(defaults);
  std::fputs(kPageClasses, stdout);
  std::fputs(kPageAreas, stdout);
  std::fputs(kPageKeys, stdout);
  std::string group;
  for (const ConfigurationKey& key : KeysOf(defaults)) {
    if (key.is_parameter) continue;
    if (key.group() != group) {
      group = key.group();
      std::printf("\n### %s\n\n| key | default | valid values | meaning |\n|---|---|---|---|\n",
                  group.c_str());
    }
    const RequiredKey* required = RequiredRow(key);
    const bool has_default = required == nullptr || !required->is_needed(defaults);
    const std::string value = has_default ? '`' + ValueText(key) + '`' : "required";
    std::printf("| `%s` | %s | %s | %s |\n", key.full_name.c_str(), value.c_str(),
                Kind(key).c_str(), key.description.c_str());
  }
}

}  // namespace
}  // namespace hardpack

int main(int argc, char** argv) {
  const std::string_view what = argc == 2 ? argv[1] : "";
  if (what == "page") {
    hardpack::PrintPage();
  } else if (what == "example") {
    hardpack::PrintExample();
  } else {
    std::fputs("usage: configuration_doc page|example\n", stderr);
    return 2;
  }
}
