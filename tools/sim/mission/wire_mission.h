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
// separately started hardpackd that cannot tell it from a real vehicle. Data that RunMission sees
// inside the loop is not available here: there are no planned paths, no cross-track errors and no
// reaction histograms, and the mode is as old as the newest status (WireOperator::kPeriod). The
// flight log that hardpackd writes has all of it (`hardpack replay`).

namespace hardpack::mission {

struct WireMissionSettings {
  MissionSettings mission;  // `log` is not used: hardpackd writes its own
  wire::Settings wire;
  int lidar_port = 7502;  // of hardpackd, on 127.0.0.1
  int ins_port = 7600;
  int label_port = 7510;
  std::string control = ControlConfiguration{}.socket;
  double wait_s = 60.0;  // for hardpackd, until it can be armed
  // Where to write the configuration with which hardpackd drives the simulated vehicle, with the
  // lidar's metadata beside it; empty: neither is written.
  std::string write_configuration;
  std::function<bool()> interrupted;  // to end before the mission's own end
};

// Report on the coupling.
struct WireReport {
  wire::Lateness lateness;       // from the goal's acceptance to the mission's end
  uint64_t reports = 0;          // status reports received
  control::StatusReport status;  // the last one
};

// Failures are settings that cannot be run, and a hardpackd that does not get as far as accepting
// the goal; a mission that goes wrong is a result. If hardpackd ends before the mission, the result
// is a fault with the reason "hardpackd is gone". `trace` may be null.
ReadOutcome RunWireMission(const WireMissionSettings& settings, experiment::RunResult& result,
                           MissionTrace* trace, WireReport& report);

}  // namespace hardpack::mission
