// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "hal/onboard/control/status_report.h"
#include "port_linux/files/configuration.h"
#include "port_linux/files/read_outcome.h"
#include "tools/sim/mission/mission.h"
#include "tools/sim/wire/real_time.h"

// The mission of tools/sim/mission/mission.h over real sockets and in real time, against a
// hardpackd that somebody else has started and that does not know it from a vehicle. What
// RunMission sees inside the loop is not known here: there are no planned paths, no cross-track
// errors and no histograms of the reaction, and the mode is as old as the newest status
// (WireOperator::kPeriod). The flight log that hardpackd writes has all of it (`hardpack replay`).

namespace hardpack::mission {

struct WireMissionSettings {
  MissionSettings mission;  // `log` is not used: hardpackd writes its own
  wire::Settings wire;
  int lidar_port = 7502;  // of hardpackd, on 127.0.0.1
  int ins_port = 7600;
  int label_port = 7510;
  std::string control = ControlConfiguration{}.socket;
  double wait_s = 60.0;  // for hardpackd, until it can be armed
  // The configuration for hardpackd, with which it takes the simulated vehicle for its own, is
  // written there, and the lidar's metadata beside it; empty: neither is.
  std::string write_configuration;
  std::function<bool()> interrupted;  // to end before the mission's own end
};

// What there is to be said of the coupling.
struct WireReport {
  wire::Lateness lateness;       // from the goal's acceptance to the mission's end
  uint64_t reports = 0;          // of the status
  control::StatusReport status;  // the last one
};

// Failures are settings that cannot be run, and a hardpackd that does not get as far as to accept
// the goal; a mission that goes wrong is a result. One that hardpackd did not live to see the end
// of is a fault, its reason "hardpackd is gone". `trace` may be null.
ReadOutcome RunWireMission(const WireMissionSettings& settings, experiment::RunResult& result,
                           MissionTrace* trace, WireReport& report);

}  // namespace hardpack::mission
