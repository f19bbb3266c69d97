// SPDX-License-Identifier: Apache-2.0
// The whole tick with any interleaving of bytes and time. A simulated vehicle has driven for some
// seconds; what came in the ticks behind that is recorded, and each input is a script that plays
// the recording to a copy of the state: it loses, repeats, reorders, cuts and changes datagrams and
// frames, adds its own bytes, lets time pass or stand, changes the bus and gives commands.
//
// Required of every tick: what is sent are frames a bus can carry, the commands are numbers within
// their limits, nothing is driven on inputs that are too old, a safe stop ends in time, the state
// is finite, the tick's limits hold, and a second copy that is given the same decides the same.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include "hal/control/messages.h"
#include "hal/vehicle_loop/vehicle_loop.h"
#include "port_linux/ouster_metadata.h"
#include "test/fuzz/mapper_script.h"
#include "test/loop_count/counted_beams.h"
#include "tools/sim/scripted_vehicle.h"

namespace hardpack {
namespace {

constexpr uint64_t kTick_ns = 10'000'000;
constexpr uint64_t kStart_ns = 100'000'000'000;
constexpr int kRecorded = 60;
constexpr int kMostTicks = 48;

struct RecordedTick {
  std::vector<std::vector<uint8_t>> bytes;
  std::vector<InputSource> sources;
  std::vector<CanFrame> frames;
};

struct Recording {
  std::vector<uint8_t> state;  // of the VehicleLoop
  uint64_t index = 0;
  uint64_t now_ns = 0;
  std::vector<RecordedTick> ticks;
};

// A vehicle that is brought up and, if it is to drive, sent off; what comes after that is recorded.
class Recorder {
 public:
  Recorder() {
    settings_.world = sim::LaneWorld();
    settings_.lidar.columns = 512;
    vehicle_ =
        std::make_unique<sim::ScriptedVehicle>(settings_, std::vector<sim::ScriptEvent>{}, now_ns_);
    config_.onboard.drive.left_sign = settings_.vehicle.left.sign;
    config_.onboard.drive.right_sign = settings_.vehicle.right.sign;
    config_.onboard.drive.gear_ratio = static_cast<float>(settings_.vehicle.left.gear_ratio);
    config_.onboard.drive.login_user = settings_.vehicle.left.login_user;
    config_.onboard.drive.login_password = settings_.vehicle.left.login_password;
    config_.onboard.tick.planning_units = 512;
    Require(ouster::ParseMetadata(vehicle_->lidar().MetadataJson(), "fuzz", config_.lidar).ok());
    Require(loop_->Configure(config_) == Status::kOk);
    CountedBeams::Set(config_.lidar.beams);
  }

  void BringUp() {
    for (int i = 0; i < 2000 && !loop_->drives().ready(); ++i) Tick({});
    for (int i = 0; i < 40; ++i) Tick({});
  }

  void Drive() {
    Say(control::Kind::kArm);
    for (int i = 0; i < 500 && !loop_->drives().enabled(); ++i) Tick({});
    Say(control::Kind::kGoal);
    for (int i = 0; i < 300; ++i) Tick({});
    Require(loop_->permission().mode == Mode::kDriving);
  }

  Recording Record() {
    Recording recording;
    recording.state.resize(sizeof(VehicleLoop));
    std::memcpy(recording.state.data(), loop_.get(), sizeof(VehicleLoop));
    recording.index = index_;
    recording.now_ns = now_ns_;
    for (int i = 0; i < kRecorded; ++i) {
      Tick({});
      recording.ticks.push_back(last_);
    }
    return recording;
  }

 private:
  void Say(control::Kind kind) {
    control::OperatorCommand command;
    command.kind = kind;
    command.sequence = ++sequence_;
    if (kind == control::Kind::kGoal) {
      command.waypoints = 1;
      command.waypoint[0].frame = control::GoalFrame::kOdom;
      command.waypoint[0].position_m = {25.0f, 1.0f};
    }
    uint8_t bytes[control::kMaxMessageBytes];
    int size = 0;
    Require(control::Encode(command, bytes, size) == Status::kOk);
    Tick({bytes, static_cast<size_t>(size)});
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
  VehicleConfig config_;
  std::unique_ptr<VehicleLoop> loop_ = std::make_unique<VehicleLoop>();
  TickOutput output_;
  RecordedTick last_;
};

// Standing in standby, and driving.
const Recording& RecordingOf(bool drives) {
  static const Recording standing = [] {
    Recorder recorder;
    recorder.BringUp();
    return recorder.Record();
  }();
  static const Recording driving = [] {
    Recorder recorder;
    recorder.BringUp();
    recorder.Drive();
    return recorder.Record();
  }();
  return drives ? driving : standing;
}

class Play {
 public:
  Play(const uint8_t* data, size_t size)
      : script_(data, size), recording_(RecordingOf((script_.Byte() & 1) != 0)) {
    std::memcpy(static_cast<void*>(loop_.get()), recording_.state.data(), sizeof(VehicleLoop));
    std::memcpy(static_cast<void*>(twin_.get()), recording_.state.data(), sizeof(VehicleLoop));
    index_ = recording_.index;
    now_ns_ = recording_.now_ns;
  }

  void Run() {
    for (int i = 0; i < kMostTicks && !script_.ended(); ++i) Tick();
  }

 private:
  void Tick() {
    Take(recording_.ticks[next_++ % recording_.ticks.size()]);
    command_.clear();
    const uint8_t changes = script_.Byte() % 4u;
    for (uint8_t i = 0; i < changes; ++i) Change();
    std::vector<TickDatagram> datagrams;
    for (size_t i = 0; i < tick_.bytes.size(); ++i) {
      datagrams.push_back({tick_.sources[i], tick_.bytes[i]});
    }
    now_ns_ += step_ns_;
    step_ns_ = kTick_ns;
    const TickInput input = {++index_, now_ns_, bus_, datagrams, tick_.frames, command_};
    const Status status = loop_->Tick(input, output_);
    Require(status == Status::kOk || status == Status::kInvalidArgument);
    Require(twin_->Tick(input, twin_output_) == status);
    Require(loop_->decision_hash() == twin_->decision_hash());
    CheckFrames();
    if (status != Status::kOk) return;
    CheckInputs();
    CheckStop();
    CheckState();
  }

  void Take(const RecordedTick& recorded) { tick_ = recorded; }

  void Change() {
    const uint8_t what = script_.Byte();
    const size_t count = tick_.bytes.size();
    const size_t which = count == 0 ? 0 : script_.Byte() % count;
    switch (what % 16) {
      case 0:  // lost
        if (count > 0) Drop(which);
        return;
      case 1:  // all of one source
        DropAll(static_cast<InputSource>(script_.Byte() % 3u));
        return;
      case 2:  // twice
        if (count == 0) return;
        tick_.bytes.push_back(tick_.bytes[which]);
        tick_.sources.push_back(tick_.sources[which]);
        return;
      case 3:  // out of order
        if (count > 1) std::swap(tick_.bytes[which], tick_.bytes[count - 1]);
        if (count > 1) std::swap(tick_.sources[which], tick_.sources[count - 1]);
        return;
      case 4:  // cut
        if (count > 0) tick_.bytes[which].resize(script_.Two() % (tick_.bytes[which].size() + 1));
        return;
      case 5:  // changed: a byte, or several in a row
      case 6:
      case 7:
        if (count > 0) Corrupt(tick_.bytes[which]);
        return;
      case 8:  // somebody else's
        AddOwn();
        return;
      case 9:
        step_ns_ = script_.Four();
        return;
      case 10:
        step_ns_ = script_.Byte() == 0 ? 0 : step_ns_ + uint64_t{script_.Byte()} * kTick_ns;
        return;
      case 11:
        bus_ = static_cast<CanBusState>(script_.Byte() % 6u);
        return;
      case 12:
        tick_.frames.resize(tick_.frames.size() / 2);
        return;
      case 13:
        ChangeFrame();
        return;
      case 14:
        Command();
        return;
      default:  // a jump of the recording, a missed tick
        next_ += script_.Byte();
        index_ += script_.Byte() % 4u;
        return;
    }
  }

  void Drop(size_t which) {
    tick_.bytes.erase(tick_.bytes.begin() + static_cast<std::ptrdiff_t>(which));
    tick_.sources.erase(tick_.sources.begin() + static_cast<std::ptrdiff_t>(which));
  }

  void DropAll(InputSource source) {
    for (size_t i = tick_.bytes.size(); i > 0; --i) {
      if (tick_.sources[i - 1] == source) Drop(i - 1);
    }
  }

  void Corrupt(std::vector<uint8_t>& bytes) {
    if (bytes.empty()) return;
    const size_t at = script_.Two() % bytes.size();
    const uint8_t length = script_.Byte() % 16u + 1u;
    for (size_t i = at; i < bytes.size() && i < at + length; ++i) bytes[i] = script_.Byte();
  }

  void AddOwn() {
    std::vector<uint8_t> bytes(script_.Two() % 2048u);
    for (uint8_t& byte : bytes) byte = script_.Byte();
    tick_.sources.push_back(static_cast<InputSource>(script_.Byte() % 3u));
    tick_.bytes.push_back(std::move(bytes));
  }

  void ChangeFrame() {
    CanFrame frame;
    const bool known = !tick_.frames.empty() && (script_.Byte() & 1) != 0;
    if (known) {
      frame = tick_.frames[script_.Byte() % tick_.frames.size()];
      frame.data[script_.Byte() % 8u] = script_.Byte();
    } else {
      frame.id = script_.Two() % 0x800u;
      frame.size = script_.Byte() % 9u;
      for (uint8_t& byte : frame.data) byte = script_.Byte();
    }
    tick_.frames.push_back(frame);
  }

  void Command() {
    control::OperatorCommand command;
    command.kind = static_cast<control::Kind>(script_.Byte() % 16u);
    command.sequence = script_.Byte();
    command.waypoints = script_.Byte() % 3u;
    for (int32_t i = 0; i < command.waypoints; ++i) {
      command.waypoint[i].frame = static_cast<control::GoalFrame>(script_.Byte() % 4u);
      command.waypoint[i].position_m = {script_.Any(), script_.Any()};
    }
    uint8_t bytes[control::kMaxMessageBytes];
    int size = 0;
    if (!IsUsable(control::Encode(command, bytes, size))) return;
    command_.assign(bytes, bytes + size);
    if (script_.Byte() % 8u == 0) Corrupt(command_);
  }

  void CheckFrames() const {
    Require(output_.frames.size() <= kMaxFramesOut);
    for (const CanFrame& frame : output_.frames) Require(IsValid(frame) && !frame.extended);
  }

  // Nothing is driven on what is too old, or on a bus that is not there.
  void CheckInputs() const {
    const Permission& permission = loop_->permission();
    if (permission.mode != Mode::kDriving || permission.motion != Motion::kFollow) return;
    const SafetyParams& safety = loop_->config().onboard.safety;
    const auto is_young = [&](uint64_t then_ns, float limit_s) {
      return then_ns != 0 && static_cast<double>(now_ns_ - std::min(then_ns, now_ns_)) * 1e-9 <=
                                 static_cast<double>(limit_s) + 1e-6;
    };
    Require(is_young(loop_->lidar_ns(), safety.max_lidar_age_s));
    Require(is_young(loop_->ins_ns(), safety.max_ins_age_s));
    Require(is_young(loop_->odometry().moved_ns(), safety.max_odometry_age_s));
    Require(is_young(loop_->replanner().committed().checked_ns, safety.max_plan_age_s));
    Require(bus_ == CanBusState::kActive || bus_ == CanBusState::kWarning ||
            bus_ == CanBusState::kPassive);
    // The drives are judged anew when they are commanded: what has just fallen silent is sent zero,
    // and is a fault in the next tick.
    const WheelCommand sent = loop_->drives().commanded();
    Require(loop_->drives().ready() || (sent.left_radps == 0.0f && sent.right_radps == 0.0f));
  }

  // A safe stop becomes zero speed when it has lasted too long.
  void CheckStop() {
    const Permission& permission = loop_->permission();
    const bool stops = permission.mode == Mode::kSafeStop;
    if (stops && !stopped_) stop_ns_ = now_ns_;
    stopped_ = stops;
    if (!stops || permission.motion != Motion::kStopAlong) return;
    const double lasted_s = static_cast<double>(now_ns_ - stop_ns_) * 1e-9;
    Require(lasted_s <= static_cast<double>(loop_->config().onboard.safety.max_stop_s) + 0.001);
  }

  void CheckState() const {
    const WheelCommand& command = loop_->gate().last();
    const float most = loop_->config().planner.vehicle.max_wheel_speed_radps;
    Require(std::abs(command.left_radps) <= most && std::abs(command.right_radps) <= most);
    const Motion motion = loop_->permission().motion;
    const bool may_move = motion == Motion::kFollow || motion == Motion::kStopAlong;
    Require(may_move || (command.left_radps == 0.0f && command.right_radps == 0.0f));
    const StampedPose& pose = loop_->odometry().pose();
    Require(IsFinite(pose.position.x_m) && IsFinite(pose.position.y_m) && IsFinite(pose.yaw_rad));
    Require(IsFinite(loop_->odometry().speed_mps()));
    const CommittedPlan& plan = loop_->replanner().committed();
    for (const float speed_mps : plan.speed) Require(speed_mps >= 0.0f && speed_mps <= 20.0f);
    for (const Pose2& place : plan.path) Require(IsFinite(place.x_m) && IsFinite(place.y_m));
  }

  Script script_;
  const Recording& recording_;
  std::unique_ptr<VehicleLoop> loop_ = std::make_unique<VehicleLoop>();
  std::unique_ptr<VehicleLoop> twin_ = std::make_unique<VehicleLoop>();
  uint64_t index_ = 0;
  uint64_t now_ns_ = 0;
  uint64_t step_ns_ = kTick_ns;
  bool stopped_ = false;  // the tick before was of a safe stop ...
  uint64_t stop_ns_ = 0;  // ... that began then
  size_t next_ = 0;
  CanBusState bus_ = CanBusState::kActive;
  RecordedTick tick_;
  std::vector<uint8_t> command_;
  TickOutput output_;
  TickOutput twin_output_;
};

}  // namespace
}  // namespace hardpack

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 2) return 0;
  hardpack::Play(data, size).Run();
  return 0;
}
