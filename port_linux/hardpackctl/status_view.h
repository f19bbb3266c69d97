// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>
#include "hal/onboard/control/status_report.h"

// A status report for people and for programs, both from hal/onboard/control/status_table.h.

namespace hardpack::ctl {

struct StatusTextOptions {
  int width = 100;     // characters per line, at least one column of fields
  bool all = false;    // including counters that are 0
  bool color = false;  // terminal escape sequences for marked fields
};

// Groups, each with its fields in columns. A field is marked with ! if something is wrong now, with
// * if something has been lost or refused since the start. With an earlier report (or null), loss
// counters show how much they have grown since.
std::string ToText(const control::StatusReport& report, const control::StatusReport* before,
                   const StatusTextOptions& options);

// {"vehicle": {"mode": "driving", "x_m": 1.5, ...}, ...}: names and units of the table; codes by
// name; an age as <name>_ns, null if never, and <name>_limit_ns, null if none; null for numbers
// that are not finite; hexadecimal fields as text.
nlohmann::ordered_json ToJson(const control::StatusReport& report);

}  // namespace hardpack::ctl
