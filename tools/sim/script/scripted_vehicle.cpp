// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/script/scripted_vehicle.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "nlohmann/json.hpp"
#include "tools/sim/world/features.h"
#include "tools/sim/world/walk.h"

namespace hardpack::sim {
namespace {

using Json = nlohmann::ordered_json;

const char* Name(Side side) {
  return side == Side::kLeft ? "left" : "right";
}

double Rounded(double value) {
  return std::round(value * 1.0e4) / 1.0e4;
}

Json DriveJson(const SevconDrive& drive) {
  return {{"wheel", Rounded(drive.wheel_radps())},
          {"command", Rounded(drive.commanded_radps())},
          {"rpm", drive.reported_rpm()},
          {"nmt", Name(drive.nmt_state())},
          {"state", Name(drive.power_state())},
          {"controlword", drive.controlword()},
          {"statusword", drive.statusword()},
          {"braked", drive.braked()},
          {"rpdos", drive.rpdos()}};
}

// The state of its drives or of its controller.
Json DrivesJson(const SimVehicle& vehicle) {
  if (const TwistController* controller = vehicle.controller()) {
    const TwistController::Motion told = controller->motion();
    return {{"controller",
             {{"state", Name(controller->state())},
              {"driven", told.driven},
              {"speed", Rounded(told.speed_mps)},
              {"turn", Rounded(told.turn)}}}};
  }
  return {{"left", DriveJson(vehicle.drive(Side::kLeft))},
          {"right", DriveJson(vehicle.drive(Side::kRight))}};
}

}  // namespace

ScriptedVehicle::ScriptedVehicle(const ScriptedVehicleSettings& settings,
                                 std::vector<ScriptEvent> script, uint64_t start_ns)
    : script_(std::move(script)),
      vehicle_(settings.vehicle, start_ns),
      lidar_(settings.lidar, start_ns),
      ins_(settings.ins, start_ns),
      world_(settings.world),
      random_(settings.seed),
      start_ns_(start_ns),
      now_ns_(start_ns),
      sample_ns_(static_cast<uint64_t>(std::llround(settings.trace_period_s * 1.0e9))),
      next_sample_ns_(start_ns),
      suspension_(settings.brake_pitch_rad, 1.0e-9 * kStep_ns) {
  std::stable_sort(script_.begin(), script_.end(),
                   [](const ScriptEvent& a, const ScriptEvent& b) { return a.at_s < b.at_s; });
  if (settings.labels) labels_.emplace(*settings.labels);
}

double ScriptedVehicle::Since_s() const {
  return static_cast<double>(now_ns_ - start_ns_) * 1.0e-9;
}

void ScriptedVehicle::TakeFrame(const CanFrame& frame, uint64_t now_ns) {
  StepTo(now_ns);
  vehicle_.TakeFrame(frame, now_ns_);
}

void ScriptedVehicle::Advance(uint64_t now_ns, Outgoing& out) {
  StepTo(now_ns);
  vehicle_.Advance(now_ns_, pending_.frames);  // answers to what came since
  const auto move = [](auto& from, auto& to) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
    from.clear();
  };
  move(pending_.frames, out.frames);
  move(pending_.bus_errors, out.bus_errors);
  move(pending_.datagrams, out.datagrams);
  move(pending_.trace, out.trace);
}

void ScriptedVehicle::StepTo(uint64_t now_ns) {
  while (now_ns_ + kStep_ns <= now_ns) Step();
}

void ScriptedVehicle::Step() {
  now_ns_ += kStep_ns;
  while (next_event_ < script_.size() && script_[next_event_].at_s <= Since_s()) {
    Act(script_[next_event_++]);
  }
  SendForeignFrames();
  vehicle_.SetGround(GroundOf(world_, vehicle_.pose(), vehicle_.footprint()));
  vehicle_.Advance(now_ns_, pending_.frames);
  max_speed_mps_ = std::max(max_speed_mps_, std::abs(vehicle_.speed_mps()));
  LetPeopleWalk();
  AdvanceSensors();
  if (vehicle_.controller() != nullptr) {
    TraceController(*vehicle_.controller());
  } else {
    for (const Side side : kBothSides) TraceChanges(side);
  }
  TraceCollision();
  if (sample_ns_ > 0 && now_ns_ >= next_sample_ns_) TraceSample();
}

void ScriptedVehicle::LetPeopleWalk() {
  constexpr double kStands_mps = 0.1;
  constexpr double kStands_radps = 0.1;
  world::LetPeopleWalk(world_, Since_s(), static_cast<double>(kStep_ns) * 1.0e-9,
                       {.place = {vehicle_.pose().x_m, vehicle_.pose().y_m},
                        .yaw_rad = vehicle_.pose().theta_rad,
                        .stands = std::abs(vehicle_.speed_mps()) < kStands_mps &&
                                  std::abs(vehicle_.yaw_rate_radps()) < kStands_radps,
                        .footprint = vehicle_.footprint()});
}

void ScriptedVehicle::Act(const ScriptEvent& event) {
  pending_.trace.push_back(
      Json{{"t", Rounded(Since_s())}, {"event", "script"}, {"line", event.text}}.dump());
  event.act(*this);
}

void ScriptedVehicle::AdvanceSensors() {
  constexpr double kStep_s = 1.0e-9 * kStep_ns;
  for (SensorFaults& faults : sensor_faults_) faults.delay_s += faults.delay_growth * kStep_s;
  const BodyMotion motion = suspension_.Step(vehicle_, world_);
  std::vector<std::vector<uint8_t>> datagrams;
  std::vector<CastColumn> truth;
  lidar_.Advance(now_ns_, motion.pose, world_, datagrams, labels_ ? &truth : nullptr);
  Deliver(Sensor::kLidar, datagrams);
  datagrams.clear();
  ins_.Advance(now_ns_, motion, datagrams);
  Deliver(Sensor::kIns, datagrams);
  if (!labels_) return;
  datagrams.clear();
  labels_->Advance(now_ns_, truth, datagrams);
  Deliver(Sensor::kLabels, datagrams);
}

void ScriptedVehicle::SendForeignFrame(const CanFrame& frame, double period_s, int count) {
  const auto period_ns = static_cast<uint64_t>(std::llround(period_s * 1.0e9));
  foreign_frames_.push_back({frame, now_ns_, std::max(period_ns, kStep_ns), count});
}

void ScriptedVehicle::SendForeignFrames() {
  for (ForeignFrame& foreign : foreign_frames_) {
    if (foreign.left <= 0 || now_ns_ < foreign.next_ns) continue;
    --foreign.left;
    foreign.next_ns += foreign.period_ns;
    pending_.frames.push_back(foreign.frame);
    vehicle_.TakeFrame(foreign.frame, now_ns_);
  }
  std::erase_if(foreign_frames_, [](const ForeignFrame& foreign) { return foreign.left <= 0; });
}

std::vector<uint8_t> ScriptedVehicle::Garbage() {
  constexpr uint32_t kMaxGarbage_bytes = 20'000;
  std::vector<uint8_t> bytes(1 + random_() % kMaxGarbage_bytes);
  for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random_());
  return bytes;
}

void ScriptedVehicle::Deliver(Sensor sensor, std::vector<std::vector<uint8_t>>& datagrams) {
  const SensorFaults& faults = sensor_faults_[static_cast<size_t>(sensor)];
  for (std::vector<uint8_t>& bytes : datagrams) {
    if (faults.silent) continue;
    if (faults.garbage) pending_.datagrams.push_back({sensor, false, Garbage()});
    const bool lost =
        faults.loss_permille > 0 && static_cast<int>(random_() % 1000u) < faults.loss_permille;
    if (lost) continue;
    ++datagrams_[static_cast<size_t>(sensor)];
    if (faults.duplicated) Carry(sensor, {sensor, faults.foreign, bytes});
    Carry(sensor, {sensor, faults.foreign, std::move(bytes)});
  }
  Arrive(sensor);
}

// Delays a datagram on its way, or collects it with others to be reordered.
void ScriptedVehicle::Carry(Sensor sensor, SensorDatagram datagram) {
  const auto index = static_cast<size_t>(sensor);
  const SensorFaults& faults = sensor_faults_[index];
  const auto delay_ns = static_cast<uint64_t>(std::llround(faults.delay_s * 1.0e9));
  std::deque<UnderWay>& under_way = under_way_[index];
  const auto send = [&](SensorDatagram& one) {
    const uint64_t before_ns = under_way.empty() ? 0 : under_way.back().arrives_ns;
    under_way.push_back({std::max(now_ns_ + delay_ns, before_ns), std::move(one)});
  };
  std::vector<SensorDatagram>& together = together_[index];
  together.push_back(std::move(datagram));
  if (static_cast<int>(together.size()) < faults.reordered) return;
  while (!together.empty()) {
    const auto drawn = faults.reordered > 1 ? random_() % together.size() : 0;
    send(together[drawn]);
    together.erase(together.begin() + static_cast<std::ptrdiff_t>(drawn));
  }
}

void ScriptedVehicle::Arrive(Sensor sensor) {
  std::deque<UnderWay>& under_way = under_way_[static_cast<size_t>(sensor)];
  for (; !under_way.empty() && under_way.front().arrives_ns <= now_ns_; under_way.pop_front()) {
    pending_.datagrams.push_back(std::move(under_way.front().datagram));
  }
}

void ScriptedVehicle::TraceChanges(Side side) {
  const SevconDrive& drive = vehicle_.drive(side);
  Seen& seen = seen_[static_cast<size_t>(side)];
  const auto trace = [&](const char* event, Json more) {
    Json line = {{"t", Rounded(Since_s())}, {"event", event}, {"side", Name(side)}};
    line.update(more);
    pending_.trace.push_back(line.dump());
  };
  if (drive.boot_ups() != seen.boot_ups) trace("boot-up", Json::object());
  if (drive.nmt_state() != seen.nmt) {
    trace("nmt", {{"from", Name(seen.nmt)}, {"to", Name(drive.nmt_state())}});
  }
  if (drive.power_state() != seen.power) {
    trace("state", {{"from", Name(seen.power)}, {"to", Name(drive.power_state())}});
  }
  if (drive.emergencies() != seen.emergencies) {
    const Emergency& emergency = drive.last_emergency();
    trace("emcy", {{"code", emergency.code},
                   {"register", emergency.error_register},
                   {"fault_id", emergency.fault_id}});
  }
  seen = {drive.nmt_state(), drive.power_state(), drive.emergencies(), drive.boot_ups()};
}

void ScriptedVehicle::TraceController(const TwistController& controller) {
  if (controller.state() == seen_controller_) return;
  const Json line = {{"t", Rounded(Since_s())},
                     {"event", "controller"},
                     {"from", Name(seen_controller_)},
                     {"to", Name(controller.state())}};
  pending_.trace.push_back(line.dump());
  seen_controller_ = controller.state();
}

void ScriptedVehicle::TraceCollision() {
  if (collided_) return;
  const Pose& pose = vehicle_.pose();
  const bool collides =
      world::ContactOf(world_, pose.x_m, pose.y_m, pose.theta_rad, Since_s(), vehicle_.footprint())
          .touches();
  if (!collides) return;
  collided_ = true;
  pending_.trace.push_back(Json{{"t", Rounded(Since_s())}, {"event", "collision"}}.dump());
}

void ScriptedVehicle::TraceSample() {
  next_sample_ns_ += sample_ns_;
  const Pose& pose = vehicle_.pose();
  Json line = {{"t", Rounded(Since_s())},
               {"x", Rounded(pose.x_m)},
               {"y", Rounded(pose.y_m)},
               {"theta", Rounded(pose.theta_rad)},
               {"v", Rounded(vehicle_.speed_mps())},
               {"w", Rounded(vehicle_.yaw_rate_radps())}};
  line.update(DrivesJson(vehicle_));
  pending_.trace.push_back(line.dump());
}

std::string ScriptedVehicle::Summary() const {
  const Pose& pose = vehicle_.pose();
  Json summary = {{"seconds", Rounded(Since_s())},
                  {"x", Rounded(pose.x_m)},
                  {"y", Rounded(pose.y_m)},
                  {"theta", Rounded(pose.theta_rad)},
                  {"driven_m", Rounded(vehicle_.driven_m())},
                  {"max_speed", Rounded(max_speed_mps_)},
                  {"speed", Rounded(vehicle_.speed_mps())},
                  {"collided", collided_},
                  {"lidar_datagrams", datagrams_[static_cast<size_t>(Sensor::kLidar)]},
                  {"ins_datagrams", datagrams_[static_cast<size_t>(Sensor::kIns)]}};
  summary.update(DrivesJson(vehicle_));
  return summary.dump();
}

world::World LaneWorld() {
  world::World world;
  const auto add_box = [&world](double x_m, double y_m, double size_m, double height_m) {
    world::AddBoxOnGround(world, {x_m, y_m}, 0.0, size_m, size_m, height_m, world::kThing);
  };
  add_box(12.0, 6.5, 2.0, 1.4);
  add_box(22.0, -6.0, 2.5, 2.0);
  add_box(34.0, 7.0, 3.0, 1.2);
  add_box(48.0, -7.0, 4.0, 2.5);
  add_box(-10.0, 8.0, 5.0, 3.0);
  add_box(62.0, 6.5, 2.0, 1.5);
  for (const auto& [x_m, y_m] :
       {std::pair{7.0, -5.0}, {17.0, 5.5}, {28.0, -5.0}, {40.0, 5.5}, {-6.0, -7.0}}) {
    world.AddCylinder({x_m, y_m}, 0.15, -0.5, 3.0, world::kHardWood);
  }
  return world;
}

}  // namespace hardpack::sim
