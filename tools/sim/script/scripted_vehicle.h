// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "hal/can_frame.h"
#include "tools/sim/script/suspension.h"
#include "tools/sim/sensors/sim_ins.h"
#include "tools/sim/sensors/sim_labels.h"
#include "tools/sim/sensors/sim_lidar.h"
#include "tools/sim/vehicle/sim_vehicle.h"
#include "tools/sim/world/world.h"

// A complete vehicle at the other end of the wires: two drives, a lidar, an INS and optionally a
// segmentation computer in a world, with faults at set times. It runs in lock step with the
// caller's time: the same calls give the same bytes. tools/sim/wire runs it on real sockets.

namespace hardpack::sim {

enum class Sensor : uint8_t { kLidar = 0, kIns = 1, kLabels = 2 };
inline constexpr int kSensors = 3;

struct SensorDatagram {
  Sensor sensor = Sensor::kLidar;
  bool foreign = false;  // sent from an address other than the sensor's
  std::vector<uint8_t> bytes;
};

// An error that a CAN controller reports, in the terms of linux/can/error.h: not a frame on the
// bus.
struct BusError {
  uint32_t error_class = 0;
  uint8_t controller = 0;  // data byte 1
};

struct Outgoing {
  std::vector<CanFrame> frames;
  std::vector<BusError> bus_errors;
  std::vector<SensorDatagram> datagrams;
  std::vector<std::string> trace;  // JSON objects, one per line
};

struct SensorFaults {
  bool silent = false;
  bool foreign = false;       // everything arrives from another address instead
  bool duplicated = false;    // everything arrives twice
  bool garbage = false;       // random bytes with each datagram, from the right address
  int loss_permille = 0;      // of its datagrams
  double delay_s = 0.0;       // delay of each; the delay does not change their order
  double delay_growth = 0.0;  // growth of that delay, in seconds per second
  int reordered = 0;          // this many at a time arrive together, in random order; 0, 1: none
};

class ScriptedVehicle;

// Something that happens at a time since the start.
struct ScriptEvent {
  double at_s = 0.0;
  std::string text;
  std::function<void(ScriptedVehicle&)> act;
};

struct ScriptedVehicleSettings {
  VehicleSettings vehicle = DefaultVehicle();
  LidarSettings lidar;
  InsSettings ins;
  std::optional<LabelSettings> labels;  // none: the returns are not labelled
  world::World world;
  double brake_pitch_rad = 0.0;  // how far its nose dips when it brakes at 2 m/s2
  double trace_period_s = 0.02;  // of the samples; events are traced when they happen
  uint32_t seed = 1;             // for losses and garbage
};

class ScriptedVehicle {
 public:
  static constexpr uint64_t kStep_ns = SimVehicle::kStep_ns;

  // Everything is switched on at start_ns.
  ScriptedVehicle(const ScriptedVehicleSettings& settings, std::vector<ScriptEvent> script,
                  uint64_t start_ns);

  // A frame sent by another node. Time does not run backwards.
  void TakeFrame(const CanFrame& frame, uint64_t now_ns);
  // Executes a script event now, and traces it.
  void Act(const ScriptEvent& event);
  // Appends everything sent until now_ns: CAN and datagrams each in order.
  void Advance(uint64_t now_ns, Outgoing& out);

  SimVehicle& vehicle() { return vehicle_; }
  const SimVehicle& vehicle() const { return vehicle_; }
  const Suspension& suspension() const { return suspension_; }
  SimLidar& lidar() { return lidar_; }
  SimIns& ins() { return ins_; }
  std::optional<SimLabels>& labels() { return labels_; }
  world::World& world() { return world_; }
  const world::World& world() const { return world_; }
  SensorFaults& faults(Sensor sensor) { return sensor_faults_[static_cast<size_t>(sensor)]; }

  // Sends a frame from a node that should not exist, `count` times; the drives receive it too.
  void SendForeignFrame(const CanFrame& frame, double period_s, int count);
  void SendBusError(const BusError& error) { pending_.bus_errors.push_back(error); }
  void RestartLidar() { lidar_.Restart(now_ns_); }
  void Quit() { quit_ = true; }

  bool quit() const { return quit_; }
  bool collided() const { return collided_; }
  uint64_t now_ns() const { return now_ns_; }
  std::string Summary() const;  // one JSON object

 private:
  struct ForeignFrame {
    CanFrame frame;
    uint64_t next_ns;
    uint64_t period_ns;
    int left;
  };
  struct UnderWay {
    uint64_t arrives_ns;
    SensorDatagram datagram;
  };
  struct Seen {  // last state of a drive, to trace changes
    NmtState nmt = NmtState::kInitialising;
    PowerState power = PowerState::kNotReady;
    uint32_t emergencies = 0;
    uint64_t boot_ups = 0;
  };

  void StepTo(uint64_t now_ns);
  void Step();
  void LetPeopleWalk();
  void SendForeignFrames();
  void Deliver(Sensor sensor, std::vector<std::vector<uint8_t>>& datagrams);
  void Carry(Sensor sensor, SensorDatagram datagram);
  void Arrive(Sensor sensor);
  std::vector<uint8_t> Garbage();
  void AdvanceSensors();
  void TraceChanges(Side side);
  void TraceController(const TwistController& controller);
  void TraceCollision();
  void TraceSample();
  double Since_s() const;

  std::vector<ScriptEvent> script_;  // by time
  size_t next_event_ = 0;
  SimVehicle vehicle_;
  SimLidar lidar_;
  SimIns ins_;
  std::optional<SimLabels> labels_;
  world::World world_;
  SensorFaults sensor_faults_[kSensors];
  std::deque<UnderWay> under_way_[kSensors];        // delayed
  std::vector<SensorDatagram> together_[kSensors];  // waiting to be reordered
  std::deque<ForeignFrame> foreign_frames_;
  std::mt19937 random_;
  uint64_t start_ns_;
  uint64_t now_ns_;
  uint64_t sample_ns_;
  uint64_t next_sample_ns_;
  Seen seen_[2];
  TwistState seen_controller_ = TwistState::kStarting;
  bool quit_ = false;
  bool collided_ = false;
  double max_speed_mps_ = 0.0;
  Suspension suspension_;
  uint64_t datagrams_[kSensors] = {};
  Outgoing pending_;
};

// Open ground around a straight lane along +x: boxes and posts at least 4 m off it, on both sides.
world::World LaneWorld();

}  // namespace hardpack::sim
