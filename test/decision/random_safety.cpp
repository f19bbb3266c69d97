// SPDX-License-Identifier: Apache-2.0
#include "core/base/math.h"
#include "core/safety/command_gate.h"
#include "core/safety/corridor.h"
#include "core/safety/motion_watch.h"
#include "core/safety/reaction_meter.h"
#include "core/safety/supervisor.h"
#include "test/decision/random.h"
#include "test/decision/random_scenes.h"
#include "test/decision/vary.h"

// What watches over the vehicle, each by itself, under inputs that change at random times.

namespace hardpack::decision {
namespace {

constexpr int kGroups = 8;

// Too large for a stack.
Corridor g_corridor;
ReactionMeter g_meter;

bool Seldom(Random& random, int times) {
  return random.Between(1, times) == 1;
}

// --- supervisor
// -----------------------------------------------------------------------------------

// Everything is well as a rule; one thing after the other is not for a while.
void Disturb(Random& random, SupervisorInput& input) {
  const auto flip = [&](bool& flag, bool usual) {
    if (Seldom(random, 40)) flag = !usual;
    if (Seldom(random, 12)) flag = usual;
  };
  const auto age = [&](uint64_t& time_ns) {
    if (!Seldom(random, 30)) return;
    const uint64_t gap_ns = static_cast<uint64_t>(random.Between(0, 1500)) * 1'000'000u;
    time_ns = input.now_ns > gap_ns ? input.now_ns - gap_ns : 0;
  };
  flip(input.bus_active, true);
  flip(input.drives_ready, true);
  flip(input.drives_enabled, true);
  flip(input.drives_faulty, false);
  flip(input.foreign_sender, false);
  flip(input.at_rest, true);
  flip(input.has_goal, true);
  flip(input.has_plan, true);
  flip(input.has_path, true);
  flip(input.arrived, false);
  flip(input.ahead_is_person, false);
  for (uint64_t* time_ns : {&input.lidar_ns, &input.look_ns, &input.odometry_ns, &input.ins_ns,
                            &input.plan_checked_ns, &input.operator_ns}) {
    if (Seldom(random, 3)) *time_ns = input.now_ns;
    age(*time_ns);
  }
  if (Seldom(random, 30)) input.ahead = static_cast<WayAhead>(random.Between(0, 2));
  constexpr StopReason kHeld[] = {StopReason::kNone, StopReason::kNone, StopReason::kNoWay,
                                  StopReason::kUnseenGround, StopReason::kPerson};
  if (Seldom(random, 20)) input.held_by = kHeld[random.Between(0, 4)];
  constexpr StopReason kMisbehaves[] = {StopReason::kNone, StopReason::kNone, StopReason::kNone,
                                        StopReason::kRunaway, StopReason::kStuck};
  if (Seldom(random, 60)) input.misbehaves = kMisbehaves[random.Between(0, 4)];
  input.wishes = {};
  input.wishes.arm = Seldom(random, 10);
  input.wishes.disarm = Seldom(random, 60);
  input.wishes.go = Seldom(random, 15);
  input.wishes.stop = Seldom(random, 80);
  input.wishes.emergency_stop = Seldom(random, 200);
}

void Supervise(Random& random, DecisionHash& hash) {
  SafetyParams params;
  Vary(random, 6, params);
  Supervisor supervisor;
  hash.AddU8(static_cast<uint8_t>(supervisor.Configure(params)));
  SupervisorInput input;
  input.now_ns = 2'000'000'000u;
  input.bus_active = input.drives_ready = input.drives_enabled = input.at_rest = true;
  for (int tick = 0; tick < 2000; ++tick) {
    input.now_ns += static_cast<uint64_t>(random.Between(1, 60)) * 1'000'000u;
    Disturb(random, input);
    const Permission permission = supervisor.Judge(input);
    hash.AddU8(static_cast<uint8_t>(permission.mode));
    hash.AddU8(static_cast<uint8_t>(permission.reason));
    hash.AddU8(static_cast<uint8_t>(permission.motion));
    hash.AddU8(static_cast<uint8_t>(permission.wish_status));
    hash.AddU64(permission.reason_since_ns);
    hash.AddU8(permission.drop_goal);
    hash.AddU8(permission.reset_faults);
    hash.AddU8(static_cast<uint8_t>(supervisor.last_stop()));
  }
}

// --- commands and motion
// --------------------------------------------------------------------------

void Gate(Random& random, DecisionHash& hash) {
  CommandGate gate;
  const GateLimits limits = {random.RealBetween(1.0f, 20.0f), random.RealBetween(1.0f, 90.0f)};
  hash.AddU8(static_cast<uint8_t>(gate.Configure(limits)));
  WheelCommand wanted;
  for (int tick = 0; tick < 1000; ++tick) {
    if (Seldom(random, 10)) wanted.left_radps = random.RealBetween(-25.0f, 25.0f);
    if (Seldom(random, 10)) wanted.right_radps = random.RealBetween(-25.0f, 25.0f);
    if (Seldom(random, 40)) wanted = {};
    const float dt_s = Seldom(random, 50) ? random.RealBetween(-0.1f, 0.3f) : 0.01f;
    const WheelCommand passed = gate.Pass(wanted, !Seldom(random, 30), dt_s);
    hash.AddFloat(passed.left_radps);
    hash.AddFloat(passed.right_radps);
    if (Seldom(random, 50)) gate.ClearFault();
  }
  for (const uint32_t count : {gate.counters().not_finite, gate.counters().above_speed,
                               gate.counters().above_change, gate.counters().not_permitted}) {
    hash.AddU32(count);
  }
}

void Watch(Random& random, DecisionHash& hash) {
  SafetyParams params;
  Vary(random, 6, params);
  MotionWatch watch;
  hash.AddU8(static_cast<uint8_t>(watch.Configure(params)));
  MotionSample sample;
  float off_mps = 0.0f;
  float off_radps = 0.0f;
  for (int tick = 0; tick < 3000; ++tick) {
    if (Seldom(random, 60)) sample.commanded_mps = random.RealBetween(-1.0f, 4.0f);
    if (Seldom(random, 60)) sample.commanded_radps = random.RealBetween(-1.2f, 1.2f);
    if (Seldom(random, 200)) sample.commanded_mps = sample.commanded_radps = 0.0f;
    if (Seldom(random, 80)) off_mps = random.RealBetween(-1.5f, 1.5f);
    if (Seldom(random, 80)) off_radps = random.RealBetween(-1.5f, 1.5f);
    if (Seldom(random, 30)) off_mps = off_radps = 0.0f;
    sample.has_wheels = !Seldom(random, 15);
    sample.wheels_mps += 0.05f * (sample.commanded_mps + off_mps - sample.wheels_mps);
    sample.wheels_radps += 0.05f * (sample.commanded_radps + off_radps - sample.wheels_radps);
    sample.has_yaw_rate = !Seldom(random, 15);
    sample.yaw_rate_radps = sample.wheels_radps + random.RealBetween(-0.05f, 0.05f);
    hash.AddU8(static_cast<uint8_t>(watch.Judge(sample, 0.01f)));
    if (Seldom(random, 150)) watch.Reset();
  }
}

// --- the way ahead
// --------------------------------------------------------------------------------

// A path that winds, with a turn on the spot now and then.
void Wind(Random& random, WorldPath& path) {
  path.Clear();
  Pose2 at = {random.RealBetween(-3.0f, 3.0f), random.RealBetween(-3.0f, 3.0f),
              random.RealBetween(-3.1f, 3.1f)};
  float turn_rad = 0.0f;
  const int points = random.Between(1, kMaxPathPoints);
  for (int i = 0; i < points; ++i) {
    path.Resize(path.size() + 1);
    path.back() = at;
    if (Seldom(random, 15)) turn_rad = random.RealBetween(-0.2f, 0.2f);
    at.theta_rad = WrapAngle(at.theta_rad + turn_rad);
    if (Seldom(random, 60)) continue;
    const SinCosPair heading = SinCos(at.theta_rad);
    const float step_m = random.RealBetween(0.01f, 0.4f);
    at.x_m += step_m * heading.cos;
    at.y_m += step_m * heading.sin;
  }
}

void LookAhead(Random& random, DecisionHash& hash) {
  g_corridor.Reset();
  SpeedParams speed;
  VehicleParams vehicle;
  Vary(random, 8, speed);
  Vary(random, 8, vehicle);
  WorldPath path;
  float along_m = 0.0f;
  for (int tick = 1; tick < 400; ++tick) {
    g_corridor.Advance({random.RealBetween(-4.0f, 4.0f), random.RealBetween(-4.0f, 4.0f)},
                       static_cast<uint32_t>(tick));
    if (Seldom(random, 12)) {
      Wind(random, path);
      along_m = random.RealBetween(0.0f, 10.0f);
      const CorridorSize size = {random.RealBetween(0.2f, 2.0f), random.RealBetween(0.2f, 2.5f),
                                 random.RealBetween(0.5f, 40.0f)};
      const auto since = static_cast<uint32_t>(random.Between(0, tick));
      hash.AddU8(static_cast<uint8_t>(g_corridor.Build(path, along_m, size, since)));
    }
    const int returns = random.Between(0, 30);
    for (int i = 0; i < returns; ++i) {
      const Vec2 point = {random.RealBetween(-25.0f, 25.0f), random.RealBetween(-25.0f, 25.0f)};
      hash.AddU8(g_corridor.File(point, Seldom(random, 4)));
    }
    const float speed_mps = random.RealBetween(0.0f, 5.0f);
    const float commanded_mps = random.RealBetween(0.0f, 5.0f);
    hash.AddU8(
        static_cast<uint8_t>(g_corridor.Ahead(speed, vehicle, along_m, speed_mps, commanded_mps)));
    hash.AddU8(g_corridor.is_person());
    if (g_corridor.has_obstacle()) hash.AddFloat(g_corridor.obstacle_along_m());
    if (Seldom(random, 60)) g_corridor.Clear();
  }
}

// --- reaction
// -------------------------------------------------------------------------------------

void React(Random& random, DecisionHash& hash) {
  g_meter.Reset();
  uint64_t now_ns = 5'000'000'000u;
  for (int event = 0; event < 4000; ++event) {
    now_ns += static_cast<uint64_t>(random.Between(0, 9)) * 1'000'000u;
    switch (random.Between(0, 9)) {
      case 0:
        g_meter.RoundBegun();
        break;
      case 1:
        g_meter.RoundJudged();
        break;
      case 2:
        g_meter.Commanded(now_ns, random.RealBetween(0.0f, 5.0f));
        break;
      case 3:
        if (Seldom(random, 10)) g_meter.Lost();
        if (Seldom(random, 20)) g_meter.Pause();
        break;
      default:
        g_meter.Filed(now_ns - static_cast<uint64_t>(random.Between(0, 80)) * 1'000'000u);
        break;
    }
    hash.AddI32(g_meter.waiting());
  }
  hash.AddU32(g_meter.columns());
  hash.AddU32(g_meter.lost());
  for (const uint32_t count : g_meter.time_bins()) hash.AddU32(count);
  for (const uint32_t count : g_meter.radius_bins()) hash.AddU32(count);
  for (int percent = 0; percent <= 100; percent += 5) {
    hash.AddFloat(g_meter.Time_s(static_cast<float>(percent) * 0.01f));
    hash.AddFloat(g_meter.Radius_m(static_cast<float>(percent) * 0.01f));
  }
}

}  // namespace

void RunRandomSafety(Report& report) {
  for (int group = 0; group < kGroups; ++group) {
    Random random(0x5eed0600u + static_cast<uint32_t>(group));
    DecisionHash hash;
    for (int i = 0; i < 10; ++i) {
      Supervise(random, hash);
      Gate(random, hash);
      Watch(random, hash);
      LookAhead(random, hash);
      React(random, hash);
    }
    report.Add("random.safety", hash);
  }
}

}  // namespace hardpack::decision
