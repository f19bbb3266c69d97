// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/odometry.h"

#include <cstdint>

#include "core/base/math.h"
#include "core/odometry/map_from_odom.h"
#include "test/decision/random.h"
#include "test/decision/report.h"

// A drive of a minute through the filter: rest, straight, slalom, a turn on the spot; noise,
// glitches, late and repeated measurements, a silent gyro, a jump of the satellites. Every state is
// hashed, and the covariance.

namespace hardpack::decision {
namespace {

constexpr int kTicks = 6000;
constexpr uint64_t kTick_ns = 10'000'000;
constexpr float kTick_s = 0.01f;

struct Truth {
  float x_m = 0.0f;
  float y_m = 0.0f;
  float yaw_rad = 0.0f;
  float speed_mps = 0.0f;
  float rate_radps = 0.0f;
};

void Move(int tick, Truth& truth) {
  const float time_s = static_cast<float>(tick) * kTick_s;
  float wanted_mps = 0.0f;
  float wanted_radps = 0.0f;
  if (tick > 300) wanted_mps = 3.0f;
  if (tick > 1500) wanted_radps = 0.8f * Sin(time_s);
  if (tick > 4000) wanted_mps = 0.0f;
  if (tick > 4300) wanted_radps = tick > 5000 ? 0.0f : 1.0f;
  truth.speed_mps += Clamp(wanted_mps - truth.speed_mps, -0.02f, 0.02f);
  truth.rate_radps += Clamp(wanted_radps - truth.rate_radps, -0.03f, 0.03f);
  const SinCosPair heading = SinCos(truth.yaw_rad);
  truth.x_m += truth.speed_mps * kTick_s * heading.cos;
  truth.y_m += truth.speed_mps * kTick_s * heading.sin;
  truth.yaw_rad = WrapAngle(truth.yaw_rad + truth.rate_radps * kTick_s);
}

void SampleOf(const Truth& truth, int tick, uint64_t now_ns, const LocalPlane& plane,
              Random& random, InsSample& sample) {
  sample.has_timestamp = true;
  sample.timestamp_ns = now_ns;
  sample.has_angular_rate = true;
  sample.angular_rate = {random.RealBetween(-0.02f, 0.02f), random.RealBetween(-0.02f, 0.02f),
                         -truth.rate_radps - 0.01f + random.RealBetween(-0.01f, 0.01f)};
  if (tick % 97 == 0) sample.angular_rate.z_radps = 20.0f;
  sample.has_attitude = true;
  sample.roll_rad = random.RealBetween(-0.1f, 0.1f);
  sample.pitch_rad = random.RealBetween(-0.1f, 0.1f);
  sample.yaw_rad = WrapAngle(0.6f - truth.yaw_rad);
  sample.has_velocity = sample.has_status = sample.has_position = true;
  const SinCosPair north = SinCos(sample.yaw_rad);
  sample.velocity_ned = {truth.speed_mps * north.cos, truth.speed_mps * north.sin, 0.0f};
  sample.status.mode = InsMode::kTracking;
  sample.status.gnss_fix = true;
  const SinCosPair world = SinCos(kHalfPi - 0.6f);
  const float jump_m = tick > 2500 && tick < 3300 ? 12.0f : 0.0f;
  const Vec2 place = {world.cos * truth.x_m - world.sin * truth.y_m + jump_m,
                      world.sin * truth.x_m + world.cos * truth.y_m};
  static_cast<void>(plane.ToGeodetic(place, sample.latitude_ndeg, sample.longitude_ndeg));
}

WheelFeedback WheelsOf(const Truth& truth, int tick, uint64_t now_ns, Random& random) {
  const bool stands = truth.speed_mps == 0.0f && truth.rate_radps == 0.0f;
  const float half_mps = truth.rate_radps * 1.0f;
  WheelFeedback wheels;
  wheels.valid = tick % 500 > 8;
  wheels.time_ns = now_ns;
  wheels.left_radps = (truth.speed_mps - half_mps) / 0.28f;
  wheels.right_radps = (truth.speed_mps + half_mps) / 0.28f;
  if (!stands) wheels.left_radps += random.RealBetween(-0.1f, 0.1f);
  if (tick % 211 == 0) wheels.right_radps = -90.0f;
  return wheels;
}

void AddState(const Odometry& odometry, const MapFromOdom& map, DecisionHash& hash) {
  hash.AddFloat(odometry.pose().position.x_m);
  hash.AddFloat(odometry.pose().position.y_m);
  hash.AddFloat(odometry.pose().yaw_rad);
  hash.AddFloat(odometry.pose().roll_rad);
  hash.AddFloat(odometry.speed_mps());
  hash.AddFloat(odometry.yaw_rate_radps());
  hash.AddFloat(odometry.gyro_bias_radps());
  hash.AddFloat(odometry.wheel_scale());
  hash.AddFloat(odometry.skid_baseline_m());
  for (int i = 0; i < kOdometryStates; ++i) {
    for (int j = 0; j <= i; ++j) hash.AddFloat(odometry.covariance().At(i, j));
  }
  hash.AddU8(static_cast<uint8_t>(map.status()));
  if (!map.has_transform()) return;
  hash.AddFloat(map.map_from_odom().x_m);
  hash.AddFloat(map.map_from_odom().y_m);
  hash.AddFloat(map.map_from_odom().theta_rad);
}

// Too large for a stack.
Odometry g_odometry;
MapFromOdom g_map;
InsSample g_sample;

DecisionHash Drive() {
  DecisionHash hash;
  Random random(0x5eed0006u);
  LocalPlane plane;
  Truth truth;
  hash.AddU8(static_cast<uint8_t>(g_odometry.Configure({}, {}, {})));
  hash.AddU8(static_cast<uint8_t>(g_map.Configure({}, {})));
  hash.AddU8(static_cast<uint8_t>(plane.SetAnchor(46'780'000'000, -71'280'000'000)));
  uint64_t now_ns = 1'000'000'000;
  for (int tick = 1; tick <= kTicks; ++tick) {
    now_ns += kTick_ns;
    Move(tick, truth);
    const bool gyro_is_silent = tick > 1900 && tick < 1950;
    if (tick % 31 != 0) SampleOf(truth, tick, now_ns, plane, random, g_sample);
    const uint64_t late_ns = tick % 13 == 0 ? 25'000'000u : 3'000'000u;
    if (!gyro_is_silent) {
      hash.AddU8(static_cast<uint8_t>(g_odometry.TakeIns(g_sample, now_ns - late_ns)));
    }
    const Status status = g_odometry.Advance(now_ns, WheelsOf(truth, tick, now_ns, random));
    hash.AddU8(static_cast<uint8_t>(status));
    const StampedPose& pose = g_odometry.pose();
    const Pose2 pose_odom = {pose.position.x_m, pose.position.y_m, pose.yaw_rad};
    hash.AddU8(
        static_cast<uint8_t>(g_map.TakeIns(g_sample, pose_odom, g_odometry.driven_m(), now_ns)));
    g_map.Advance(now_ns, pose_odom);
    if (tick % 10 == 0) AddState(g_odometry, g_map, hash);
  }
  hash.AddU32(g_odometry.counters().gyro_rejected);
  hash.AddU32(g_odometry.counters().late);
  hash.AddU32(g_map.counters().rejected);
  hash.AddU32(g_map.counters().relocations);
  return hash;
}

}  // namespace

void RunOdometry(Report& report) {
  report.Add("odometry.drive", Drive());
}

}  // namespace hardpack::decision
