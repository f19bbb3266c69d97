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

// A simulated vehicle in real time: its drives on a SocketCAN interface, its sensors by UDP,
// against an onboard program that does not know it from a real one. Steps of 1 ms follow the
// monotonic clock; where this process was woken late it says so, since the vehicle then was not
// what it is taken for.

namespace hardpack::wire {

struct Settings {
  std::string can;  // SocketCAN interface; empty: no drives are heard
  // ADDRESS:PORT that each sends from and to; nothing is sent to an empty one.
  std::string lidar_from = "127.0.0.1:17502";
  std::string lidar_to = "127.0.0.1:7502";
  std::string ins_from = "127.0.0.1:17600";
  std::string ins_to = "127.0.0.1:7600";
  std::string labels_from = "127.0.0.1:17503";
  std::string labels_to;
  std::string foreign_address = "127.0.0.2";  // where lidar-foreign and ins-foreign come from
  std::string trace;                          // file of JSON lines of what happened; empty: none
  bool interactive = false;  // events of the script's form, without a time, from standard input
  // Between two looks at the sockets, 1 to 20; 1: each frame is looked at as it comes. Frames count
  // from when they came in either case.
  int turn_ms = 1;
};

// How well the clock was kept.
struct Lateness {
  uint64_t worst_ns = 0;  // that the vehicle was behind the clock
  uint64_t events = 0;    // times that it was by kLate_ns or more
};

class RealTime {
 public:
  // The shortest time that anybody on these wires waits for somebody else is 100 ms.
  static constexpr uint64_t kLate_ns = 50'000'000;
  // Of the vehicle's time, between two calls of a watcher.
  static constexpr uint64_t kWatch_ns = 10'000'000;

  // kSystemError, kInvalidArgument: with what could not be opened. Once.
  ReadOutcome Open(const Settings& settings);

  // Is called on the way whenever the vehicle has come to another multiple of kWatch_ns since
  // Begin.
  void Watch(std::function<void()> watcher) { watcher_ = std::move(watcher); }

  // Before the first turn; the vehicle was switched on just now.
  void Begin(const sim::ScriptedVehicle& vehicle);

  // Takes what came, brings the vehicle up to the clock, sends what it sent, and waits for the next
  // turn.
  void Turn(sim::ScriptedVehicle& vehicle);

  // Since Begin, or since Forget.
  const Lateness& lateness() const { return lateness_; }
  void ForgetLateness() { lateness_ = {}; }

  // One JSON object: the vehicle's, and what the wires carried.
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
