// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "hal/onboard/control/messages.h"
#include "hal/onboard/vehicle_loop/any_vehicle.h"
#include "port_linux/files/ouster_metadata.h"
#include "test/loop_count/counted_beams.h"
#include "tools/sim/script/script.h"
#include "tools/sim/script/scripted_vehicle.h"

// A VehicleLoop and a simulated vehicle in lock step, 100 ticks a second: what the one sends is
// what the other takes in the next tick.

namespace hardpack::testing {

inline VehicleConfig ConfigFor(const sim::ScriptedVehicleSettings& settings,
                               const std::string& lidar_metadata) {
  VehicleConfig config;
  config.onboard.safety.operator_timeout_s = 0.0f;  // a test says what it has to say, and no more
  const sim::DriveSettings& left = settings.vehicle.left;
  const sim::DriveSettings& right = settings.vehicle.right;
  config.onboard.drive.left_sign = left.sign;
  config.onboard.drive.right_sign = right.sign;
  config.onboard.drive.gear_ratio = static_cast<float>(left.gear_ratio);
  config.onboard.drive.login_user = left.login_user;
  config.onboard.drive.login_password = left.login_password;
  EXPECT_TRUE(ouster::ParseMetadata(lidar_metadata, "simulated", config.lidar).ok());
  if (!settings.vehicle.model) {
    // It turns about its middle, and is never behind its wheels.
    config.onboard.odometry.turning_point_m = 0.0f;
    config.onboard.odometry.wheel_lag_share = 0.0f;
  }
  return config;
}

class ClosedLoop {
 public:
  static constexpr uint64_t kTick_ns = 10'000'000;

  // The loop is made in memory that is full of `fill`: nothing may be left as it was found.
  explicit ClosedLoop(std::string_view script = "", world::World world = sim::LaneWorld(),
                      uint8_t fill = 0xa5, sim::LidarProfile profile = sim::LidarProfile::kLegacy)
      : memory_(std::make_unique<std::byte[]>(sizeof(VehicleOf<Warthog>))) {
    std::memset(memory_.get(), fill, sizeof(VehicleOf<Warthog>));
    onboard_ = new (memory_.get()) VehicleOf<Warthog>;  // trivially destructible
    loop_ = &onboard_->loop();
    settings_.world = std::move(world);
    settings_.lidar.columns = 512;  // quicker to cast
    settings_.lidar.profile = profile;
    std::vector<sim::ScriptEvent> events;
    EXPECT_TRUE(sim::ParseScript(script, "script", events).ok());
    vehicle_ = std::make_unique<sim::ScriptedVehicle>(settings_, std::move(events), now_ns_);
    config_ =
        std::make_unique<VehicleConfig>(ConfigFor(settings_, vehicle_->lidar().MetadataJson()));
    config_->planner.speed.assured_width_m = 0.64f;  // else its columns do not carry 5 m/s
    EXPECT_EQ(loop_->Configure(*config_), Status::kOk);
    counted_.Set(config_->lidar.beams);
  }

  void Act(std::string_view script) {
    std::vector<sim::ScriptEvent> events;
    ASSERT_TRUE(sim::ParseScript(script, "act", events).ok());
    for (const sim::ScriptEvent& event : events) event.act(*vehicle_);
  }

  VehicleLoop& loop() { return *loop_; }
  AnyVehicle& onboard() { return *onboard_; }
  sim::ScriptedVehicle& vehicle() { return *vehicle_; }
  const VehicleConfig& config() const { return *config_; }
  const TickOutput& output() const { return output_; }
  Mode mode() const { return loop_->permission().mode; }
  StopReason reason() const { return loop_->permission().reason; }
  uint64_t now_ns() const { return now_ns_; }
  CanBusState bus = CanBusState::kActive;
  bool drops_frames = false;  // nothing reaches the vehicle
  bool repeats_ins = false;   // the INS's bytes are those that came last, again and again
  // What comes besides the vehicle's own datagrams.
  std::function<void(std::vector<TickDatagram>&)> adds;
  // What the bus makes of the vehicle's frames at a time.
  std::function<void(std::vector<CanFrame>&, uint64_t)> carries;

  // Ticks that are missed: time passes, and what comes meanwhile comes with the next one.
  void Miss(int ticks) {
    index_ += static_cast<uint64_t>(ticks);
    now_ns_ += static_cast<uint64_t>(ticks) * kTick_ns;
  }

  // One tick, with a command or without.
  Status Tick(std::span<const uint8_t> command = {}) {
    now_ns_ += kTick_ns;
    sim::Outgoing out;
    vehicle_->Advance(now_ns_, out);
    std::vector<TickDatagram> datagrams;
    for (const sim::SensorDatagram& datagram : out.datagrams) {
      if (datagram.foreign || datagrams.size() == VehicleLoop::kMaxDatagramsPerTick) continue;
      if (datagram.sensor == sim::Sensor::kLabels) {
        datagrams.push_back({InputSource::kLabels, datagram.bytes});
        continue;
      }
      const bool is_lidar = datagram.sensor == sim::Sensor::kLidar;
      if (!is_lidar && !repeats_ins) last_ins_.assign(datagram.bytes.begin(), datagram.bytes.end());
      datagrams.push_back({is_lidar ? InputSource::kLidar : InputSource::kIns, datagram.bytes});
      if (!is_lidar && repeats_ins) datagrams.back().bytes = last_ins_;
    }
    if (adds) adds(datagrams);
    if (carries) carries(out.frames, now_ns_);
    TickInput input;
    input.index = ++index_;
    input.now_ns = now_ns_;
    input.bus = bus;
    input.datagrams = datagrams;
    input.frames = out.frames;
    input.command = command;
    const Status status = loop_->Tick(input, output_);
    for (const CanFrame& frame : output_.frames) {
      if (!drops_frames) vehicle_->TakeFrame(frame, now_ns_);
    }
    return status;
  }

  void Ticks(int count) {
    for (int i = 0; i < count; ++i) ASSERT_EQ(Tick(), Status::kOk);
  }

  // Ticks until it is true, at most so long.
  template <typename Condition>
  bool Until(double limit_s, Condition&& condition) {
    for (int i = 0; i < static_cast<int>(limit_s * 100.0); ++i) {
      if (condition()) return true;
      if (Tick() != Status::kOk) return false;
    }
    return condition();
  }

  Status Say(const control::OperatorCommand& command) {
    uint8_t bytes[control::kMaxMessageBytes];
    int size_bytes = 0;
    EXPECT_EQ(control::Encode(command, bytes, size_bytes), Status::kOk);
    EXPECT_EQ(Tick({bytes, static_cast<size_t>(size_bytes)}), Status::kOk);
    EXPECT_TRUE(output_.has_answer);
    return output_.answer;
  }
  Status Say(control::Kind kind) {
    control::OperatorCommand command;
    command.kind = kind;
    command.sequence = ++sequence_;
    return Say(command);
  }
  Status Goal(float x_m, float y_m, control::GoalFrame frame = control::GoalFrame::kOdom) {
    control::OperatorCommand command;
    command.kind = control::Kind::kGoal;
    command.sequence = ++sequence_;
    command.waypoints = 1;
    command.waypoint[0].frame = frame;
    command.waypoint[0].position_m = {x_m, y_m};
    return Say(command);
  }

  void BringUpAndArm() {
    ASSERT_TRUE(Until(20.0, [&] { return loop_->drives().ready(); }));
    Ticks(30);
    ASSERT_EQ(Say(control::Kind::kArm), Status::kOk) << static_cast<int>(output_.reason);
    ASSERT_TRUE(Until(5.0, [&] { return loop_->drives().enabled(); }));
    ASSERT_EQ(mode(), Mode::kArmed);
  }
  void DriveTo(float x_m, float y_m) {
    BringUpAndArm();
    ASSERT_EQ(Goal(x_m, y_m), Status::kOk);
    ASSERT_TRUE(Until(5.0, [&] { return mode() == Mode::kDriving; }));
    ASSERT_TRUE(Until(10.0, [&] { return Speed_mps() > 1.0; }));
  }

  double Speed_mps() const { return vehicle_->vehicle().speed_mps(); }
  sim::Pose Pose() const { return vehicle_->vehicle().pose(); }

 private:
  CountedBeams counted_{kMaxBeams};
  uint64_t now_ns_ = 100'000'000'000;
  uint64_t index_ = 0;
  uint32_t sequence_ = 0;
  sim::ScriptedVehicleSettings settings_;
  std::unique_ptr<sim::ScriptedVehicle> vehicle_;
  std::unique_ptr<VehicleConfig> config_;
  std::unique_ptr<std::byte[]> memory_;
  VehicleOf<Warthog>* onboard_ = nullptr;
  VehicleLoop* loop_ = nullptr;
  std::vector<uint8_t> last_ins_;
  TickOutput output_;
};

}  // namespace hardpack::testing
