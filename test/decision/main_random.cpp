// SPDX-License-Identifier: Apache-2.0
#include "test/decision/random_scenes.h"

int main() {
  hardpack::decision::Report report;
  hardpack::decision::RunRandomPlans(report);
  hardpack::decision::RunRandomMaps(report);
  hardpack::decision::RunRandomReplans(report);
  hardpack::decision::RunRandomMotion(report);
  hardpack::decision::RunRandomSafety(report);
  report.PrintTotal();
}
