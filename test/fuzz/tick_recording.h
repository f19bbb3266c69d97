// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "test/fuzz/fuzzed_vehicle.h"
#include "test/fuzz/mapper_script.h"
#include "test/hal/onboard/control/command_bytes.h"
#include "test/loop_count/counted_beams.h"
#include "tools/sim/script/scripted_vehicle.h"
#include "tools/sim/world/features.h"
#include "tools/sim/world/world.h"

// What the tick's fuzz target plays: a simulated vehicle that has driven for some seconds, as the
// state of its FuzzedLoop, and what came in the ticks behind that.

namespace hardpack {

inline constexpr uint64_t kStart_ns = 100'000'000'000;
inline constexpr int kRecorded = 60;

struct RecordedTick {
  std::vector<std::vector<uint8_t>> bytes;
  std::vector<InputSource> sources;
  std::vector<CanFrame> frames;
};

struct Recording {
  std::vector<uint8_t> state;  // of the FuzzedLoop
  uint64_t index = 0;
  uint64_t now_ns = 0;
  std::vector<RecordedTick> ticks;
};

// A vehicle that is brought up and, if it is to drive, sent off; what comes after that is recorded.
class RecordedDrive {
 public:
  RecordedDrive() {
    settings_.world = sim::LaneWorld();
    DescribeFuzzed(settings_);
    vehicle_ =
        std::make_unique<sim::ScriptedVehicle>(settings_, std::vector<sim::ScriptEvent>{}, now_ns_);
    config_.onboard.drive.left_sign = settings_.vehicle.left.sign;
    config_.onboard.drive.right_sign = settings_.vehicle.right.sign;
    config_.onboard.drive.gear_ratio = static_cast<float>(settings_.vehicle.left.gear_ratio);
    config_.onboard.drive.login_user = settings_.vehicle.left.login_user;
    config_.onboard.drive.login_password = settings_.vehicle.left.login_password;
    config_.onboard.tick.planning_units = 512;
    config_.onboard.safety.operator_timeout_s = 0.0f;
    config_.planner.speed.assured_height_m = 0.5f;  // few beams are enough to drive fast
    DescribeLidar(vehicle_->lidar(), config_.lidar);
    // The least there may be, so that it can be reached.
    const int32_t columns = FuzzedVehicle::Lidar::MostColumnsPerSecond(config_.lidar);
    config_.onboard.tick.directions = std::max(160, (columns + 99) / 100);
    Require(loop_->Configure(config_) == Status::kOk);
    CountedBeams::Set(loop_->mapper().model().beams);
  }

  void BringUp() {
    for (int i = 0; i < 2000 && !Drives().ready; ++i) Tick({});
    for (int i = 0; i < 40; ++i) Tick({});
  }

  void Drive() {
    Say(control::Kind::kArm);
    for (int i = 0; i < 500 && !Drives().enabled; ++i) Tick({});
    Say(control::Kind::kGoal);
    for (int i = 0; i < 300; ++i) Tick({});
    Require(loop_->permission().mode == Mode::kDriving);
  }

  // Something stands ahead, too near to come to rest along the path: zero goes out at once.
  void Block() {
    const StampedPose& pose = loop_->odometry().pose();
    const double ahead_m = 2.5;
    const double x_m = static_cast<double>(pose.position.x_m) + ahead_m * std::cos(pose.yaw_rad);
    const double y_m = static_cast<double>(pose.position.y_m) + ahead_m * std::sin(pose.yaw_rad);
    world::AddBoxOnGround(vehicle_->world(), {x_m, y_m}, 0.0, 1.0, 3.0, 1.4, world::kThing);
    for (int i = 0; i < 60 && loop_->permission().motion != Motion::kZero; ++i) Tick({});
    Require(loop_->permission().motion == Motion::kZero && !Drives().standstill);
  }

  Recording Record() {
    Recording recording;
    recording.state.resize(sizeof(FuzzedLoop));
    std::memcpy(recording.state.data(), loop_.get(), sizeof(FuzzedLoop));
    recording.index = index_;
    recording.now_ns = now_ns_;
    for (int i = 0; i < kRecorded; ++i) {
      Tick({});
      recording.ticks.push_back(last_);
    }
    return recording;
  }

 private:
  DriveFeedback Drives() const { return loop_->drives().State(now_ns_); }

  void Say(control::Kind kind) {
    const std::vector<uint8_t> command = control::CommandBytes(kind, ++sequence_, {25.0f, 1.0f});
    Require(!command.empty());
    Tick(command);
  }

  void Tick(std::span<const uint8_t> command) {
    now_ns_ += kTick_ns;
    sim::Outgoing out;
    vehicle_->Advance(now_ns_, out);
    last_ = {};
    for (const sim::SensorDatagram& datagram : out.datagrams) {
      const InputSource source = datagram.sensor == sim::Sensor::kLidar    ? InputSource::kLidar
                                 : datagram.sensor == sim::Sensor::kLabels ? InputSource::kLabels
                                                                           : InputSource::kIns;
      last_.bytes.emplace_back(datagram.bytes.begin(), datagram.bytes.end());
      last_.sources.push_back(source);
    }
    last_.frames.assign(out.frames.begin(), out.frames.end());
    std::vector<TickDatagram> datagrams;
    for (size_t i = 0; i < last_.bytes.size(); ++i) {
      datagrams.push_back({last_.sources[i], last_.bytes[i]});
    }
    const TickInput input = {++index_,  now_ns_,      CanBusState::kActive,
                             datagrams, last_.frames, command};
    Require(loop_->Tick(input, output_) == Status::kOk);
    for (const CanFrame& frame : output_.frames) vehicle_->TakeFrame(frame, now_ns_);
  }

  uint64_t now_ns_ = kStart_ns;
  uint64_t index_ = 0;
  uint32_t sequence_ = 0;
  sim::ScriptedVehicleSettings settings_;
  std::unique_ptr<sim::ScriptedVehicle> vehicle_;
  FuzzedConfig config_;
  std::unique_ptr<FuzzedLoop> loop_ = std::make_unique<FuzzedLoop>();
  TickOutput output_;
  RecordedTick last_;
};

enum class Scene : uint8_t { kStanding, kDriving, kBlocked };

inline Recording RecordScene(Scene scene) {
  RecordedDrive drive;
  drive.BringUp();
  if (scene != Scene::kStanding) drive.Drive();
  if (scene == Scene::kBlocked) drive.Block();
  return drive.Record();
}

// Each is made when it is first asked for.
inline const Recording& RecordingOf(Scene scene) {
  static std::map<Scene, Recording> recordings;
  const auto known = recordings.find(scene);
  if (known != recordings.end()) return known->second;
  return recordings.emplace(scene, RecordScene(scene)).first->second;
}

}  // namespace hardpack
