// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "test/decision/report.h"

// decision_random: as `decision`, but hundreds of scenarios that nobody chose, with parameters that
// nobody chose. A change of any decision shows here first; nothing else is asked of them.

namespace hardpack::decision {

// In the order in which they run.
void RunRandomPlans(Report& report);
void RunRandomMaps(Report& report);
void RunRandomReplans(Report& report);
void RunRandomMotion(Report& report);
void RunRandomSafety(Report& report);

}  // namespace hardpack::decision
