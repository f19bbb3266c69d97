// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "hal/onboard/control/messages.h"
#include "hal/onboard/control/status_report.h"
#include "port_linux/hardpackctl/connection.h"
#include "tools/sim/vehicle/pose.h"
#include "tools/sim/world/world.h"

// The operator of a mission over the wire: sends a hardpackd over its control socket what
// `hardpack ctl` would send, and keeps its newest status. It runs in its own thread, because it
// waits for answers and the vehicle's clock must not wait.

namespace hardpack::mission {

class WireOperator {
 public:
  enum class Phase : uint8_t {
    kWaiting,  // for hardpackd, its drives and its sensors; then it is armed
    kDriving,  // the goal was accepted
    kRefused,  // the goal was not accepted; `message` says why
    kLost,     // hardpackd no longer answers
    kLeft,     // disarmed and the drives are off, or they did not turn off within kLeave_s
  };
  struct Said {
    Phase phase = Phase::kWaiting;
    std::string message;
    uint64_t reports = 0;  // number received
    control::StatusReport status;
  };
  // Between two status requests: a mode that lasts for less is not seen.
  static constexpr std::chrono::milliseconds kPeriod{50};
  static constexpr double kLeave_s = 12.0;

  // The vehicle stands at `start` until the goal is accepted; both are in the world frame.
  WireOperator(std::string socket, double wait_s, const sim::Pose& start, world::Point2 goal,
               std::vector<control::Waypoint> waypoints)
      : socket_(std::move(socket)),
        wait_s_(wait_s),
        start_(start),
        goal_(goal),
        waypoints_(std::move(waypoints)) {}
  ~WireOperator();
  WireOperator(const WireOperator&) = delete;
  WireOperator& operator=(const WireOperator&) = delete;

  void Start();
  Said said() const;
  // Disarms, and waits until the drives are off; call once.
  void Leave() { leaving_ = true; }

 private:
  void Run();
  std::string Begin();
  std::string Connect();
  std::string Arm();
  std::string Go();
  std::string Until(const std::string& what, const std::function<bool()>& condition);
  bool AskStatus(std::string& failure);
  void End(bool is_connected);
  void Tell(Phase phase, const std::string& message = "");

  std::string socket_;
  double wait_s_;
  sim::Pose start_;
  world::Point2 goal_;
  std::vector<control::Waypoint> waypoints_;
  ctl::Connection connection_;
  control::StatusReport status_;  // the thread's own
  std::chrono::steady_clock::time_point patience_;
  std::atomic<bool> leaving_ = false;
  mutable std::mutex mutex_;
  Said said_;
  std::thread thread_;
};

}  // namespace hardpack::mission
