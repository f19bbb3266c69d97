// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>
#include "hal/onboard/control/status_report.h"

// A status report for people and for programs, both by hal/onboard/control/status_table.h.

namespace hardpack::ctl {

struct StatusTextOptions {
  int width = 100;     // characters of a line, at least one column of fields
  bool all = false;    // counters that are 0, too
  bool color = false;  // escape sequences of a terminal for what is marked
};

// Groups, each with its fields in columns. A field is marked with ! where something is wrong now,
// with * where something was lost or refused since the start. With a report of before (or null),
// counters of losses say by how much they have grown since.
std::string ToText(const control::StatusReport& report, const control::StatusReport* before,
                   const StatusTextOptions& options);

// {"vehicle": {"mode": "driving", "x_m": 1.5, ...}, ...}: names and units of the table; codes by
// name; an age as <name>_ns, null if it never was, and <name>_limit_ns, null where there is none;
// null for numbers that are not finite; hexadecimal fields as text.
nlohmann::ordered_json ToJson(const control::StatusReport& report);

}  // namespace hardpack::ctl
