// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "hal/onboard/flight_log/flight_log.h"
#include "hal/onboard/run_loop/run_loop.h"
#include "hal/onboard/vehicle_loop/any_vehicle.h"
#include "port_linux/chosen_vehicle.h"
#include "port_linux/control_socket.h"
#include "port_linux/file_recorder.h"
#include "port_linux/files/configuration.h"
#include "port_linux/monotonic_clock.h"
#include "port_linux/realtime.h"
#include "port_linux/service_watchdog.h"
#include "port_linux/socket_can_bus.h"
#include "port_linux/udp_socket.h"

namespace hardpack {

// The validated inputs of the program.
struct Startup {
  Configuration configuration;
  std::string configuration_text;  // as TOML, every key, without the drives' password
  std::string lidar_text;          // the file that describes the lidar, as read
  LidarConfigs lidars;
};

// Everything that hardpackd opens: buses, sockets, recorder, watchdog. Each problem is one line on
// stderr that says what to do; problems that are not fatal are warnings there.
class Devices {
 public:
  // False: something essential could not be opened.
  bool Open(const Startup& startup, const AnyVehicle& vehicle);

  // After Open, before the first tick: makes the tick thread real-time as far as permitted.
  void BecomeRealtime(const ProcessConfiguration& process);

  // Closes everything: the log is written to its end.
  void Close();

  OnboardDevices ForOnboard();
  const RealtimeOutcome& realtime() const { return realtime_; }

 private:
  bool OpenSensors(const Configuration& configuration);
  bool OpenLog(const Startup& startup, const AnyVehicle& vehicle);

  MonotonicClock clock_;
  SocketCanBus can_;
  UdpSocket ins_;
  UdpSocket labels_;
  UdpSocket lidar_;
  bool has_ins_ = false;
  bool has_labels_ = false;
  FileRecorder recorder_;
  std::unique_ptr<uint8_t[]> snapshot_;
  std::unique_ptr<flight_log::FlightLog> flight_log_;
  ServiceWatchdog watchdog_;
  ControlSocket control_;
  RealtimeOutcome realtime_;
};

std::span<const uint8_t> BytesOf(std::string_view text);

// "hardpackd: ..." on stderr, one line.
void Say(std::string_view text);

}  // namespace hardpack
