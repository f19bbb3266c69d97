// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "port_linux/files/read_outcome.h"
#include "tools/sim/script/scripted_vehicle.h"
#include "tools/sim/wire/line_reader.h"
#include "tools/sim/wire/sockets.h"

// A simulated vehicle in real time: its drives on a SocketCAN interface, its sensors over UDP,
// against an onboard program that cannot tell it from a real one. Steps of 1 ms follow the
// monotonic clock. If this process is woken late it reports so, because the simulated vehicle was
// then not valid.

namespace hardpack::wire {

struct Settings {
  std::string can;  // SocketCAN interface; empty: no drives on a bus
  // ADDRESS:PORT that each sends from and to; nothing is sent to an empty one.
  std::string lidar_from = "127.0.0.1:17502";
  std::string lidar_to = "127.0.0.1:7502";
  std::string ins_from = "127.0.0.1:17600";
  std::string ins_to = "127.0.0.1:7600";
  std::string labels_from = "127.0.0.1:17503";
  std::string labels_to;
  std::string foreign_address = "127.0.0.2";  // source of lidar-foreign and ins-foreign
  std::string trace;                          // file of events as JSON lines; empty: none
  bool interactive = false;  // events in script form, without a time, from standard input
  // Time between two reads of the sockets, 1 to 20; 1: each frame is read as it arrives. In either
  // case frames count from their arrival.
  int turn_ms = 1;
};

// How well the simulation kept up with the clock.
struct Lateness {
  uint64_t worst_ns = 0;  // largest delay of the vehicle behind the clock
  uint64_t events = 0;    // times that the delay was kLate_ns or more
};

class RealTime {
 public:
  // The shortest time-out of any node on these wires is 100 ms.
  static constexpr uint64_t kLate_ns = 50'000'000;
  // Between two calls of a watcher, in the vehicle's time.
  static constexpr uint64_t kWatch_ns = 10'000'000;

  // kSystemError, kInvalidArgument: the message says what could not be opened. Call once.
  ReadOutcome Open(const Settings& settings);

  // The watcher is called whenever the vehicle's time reaches another multiple of kWatch_ns since
  // Begin.
  void Watch(std::function<void()> watcher) { watcher_ = std::move(watcher); }

  // Call before the first turn; the vehicle was just switched on.
  void Begin(const sim::ScriptedVehicle& vehicle);

  // Takes the input, advances the vehicle to the current time, sends its output, and waits for the
  // next turn.
  void Turn(sim::ScriptedVehicle& vehicle);

  // Since Begin, or since Forget.
  const Lateness& lateness() const { return lateness_; }
  void ForgetLateness() { lateness_ = {}; }

  // One JSON object: the vehicle's summary, and the traffic on the wires.
  std::string Summary(const sim::ScriptedVehicle& vehicle) const;

 private:
  // A sensor's datagrams, from its own address and from the foreign one.
  struct Senders {
    DatagramSender own;
    DatagramSender foreign;
    bool open = false;

    ReadOutcome Open(const std::string& from, const std::string& to,
                     const std::string& foreign_address);
  };

  double Since_s(const sim::ScriptedVehicle& vehicle) const;
  void NoteLateness(const sim::ScriptedVehicle& vehicle, uint64_t now_ns);
  void TakeLines(sim::ScriptedVehicle& vehicle);
  void AdvanceTo(sim::ScriptedVehicle& vehicle, uint64_t time_ns);
  void Send(const sim::Outgoing& out);
  void Wait(uint64_t until_ns) const;

  LineReader lines_;
  VehicleCan can_;
  Senders senders_[sim::kSensors];
  std::ofstream trace_;
  std::function<void()> watcher_;
  std::vector<ReceivedFrame> frames_;
  sim::Outgoing out_;
  uint64_t start_ns_ = 0;
  uint64_t next_watch_ns_ = 0;
  uint64_t turn_ns_ = sim::ScriptedVehicle::kStep_ns;
  Lateness lateness_;
  uint64_t worst_ever_ns_ = 0;
};

}  // namespace hardpack::wire
