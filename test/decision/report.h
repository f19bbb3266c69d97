// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/decision_hash.h"
#include "core/base/status.h"

// The decision program: a fixed set of seeded scenarios through core and hal, and a hash of what
// was decided in each. Equal lines on two builds mean equal decisions. The scenarios use no heap,
// no library and no operating system, so the same sources run on a desktop and on a bare Cortex-M7.

namespace hardpack::decision {

// What a platform gives the scenarios.
// PrintLine writes one zero-terminated line; the line end is the platform's.
void PrintLine(const char* line);
// What fresh memory of the big objects holds before they are constructed. Platforms differ on
// purpose: a decision that depends on memory nobody has written then differs too.
extern const uint8_t kFreshMemory;

// Prints a line for each scenario and folds all into the last line's total.
class Report {
 public:
  // name: at most 40 characters.
  void Add(const char* name, const DecisionHash& hash);
  void PrintTotal();

 private:
  DecisionHash total_;
};

// `prefix` and a value, as a line of its own, for people: not compared.
void PrintNumber(const char* prefix, uint32_t value);
void PrintStatus(const char* prefix, Status status);

// The scenarios, in the order in which they run.
void RunBase(Report& report);
void RunOdometry(Report& report);
void RunCells(Report& report);
void RunScenes(Report& report);
void RunReplan(Report& report);
void RunTracking(Report& report);

inline void RunAll() {
  Report report;
  RunBase(report);
  RunOdometry(report);
  RunCells(report);
  RunScenes(report);
  RunReplan(report);
  RunTracking(report);
  report.PrintTotal();
}

}  // namespace hardpack::decision
