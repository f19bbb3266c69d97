// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

// Counts how often functions are called, and their loops are gone round, within one call of
// another: what config/timing.toml states in [[calls]] and [[rounds]]. Of functions that are
// compiled with -finstrument-functions, their loops with HP_COUNT_LOOPS (core/base/loop_bound.h).
// One thread.

namespace hardpack::timing {

enum class Counted : uint8_t { kCalls, kRounds };

// To be told before the first call of either. Both are known by their qualified names, without
// parameters. kRounds: of the loop of the largest bound that is in no other loop.
void Count(Counted what, const std::string& within, const std::string& of);

// A line `calls|rounds WITHIN OF most entered` for each: the most in one call of WITHIN, and how
// often that was called.
void PrintCounts();

}  // namespace hardpack::timing
