// SPDX-License-Identifier: Apache-2.0
// Replays a flight log as `hardpack replay` does, without its pictures: what a cross build has the
// libraries for. Prints the number of ticks and the decision hash; exit status 1: a tick was
// decided otherwise, 2: the log cannot be used.
#include <cinttypes>
#include <cstdio>
#include <memory>

#include "tools/replay/replay.h"

int main(int argc, char** argv) {
  using namespace hardpack;
  replay::Request request;
  request.files.assign(argv + 1, argv + argc);
  const auto vehicle = std::make_unique<ChosenVehicle>();
  const auto configuration = std::make_unique<Configuration>();
  replay::Report report;
  const ReadOutcome outcome = replay::ReplayLog(request, *vehicle, *configuration, report);
  if (!outcome.ok()) {
    std::fprintf(stderr, "%s\n", outcome.message.c_str());
    return 2;
  }
  std::printf("%" PRId64 " ticks, decision hash %016" PRIx64 "\n", report.ticks,
              report.decision_hash);
  if (report.difference.found) {
    std::fprintf(stderr, "tick %" PRIu64 " decides differently: %s\n", report.difference.index,
                 report.difference.what.c_str());
  }
  if (!report.not_comparable.empty()) std::fprintf(stderr, "%s\n", report.not_comparable.c_str());
  return report.same() ? 0 : 1;
}
