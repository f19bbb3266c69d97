// SPDX-License-Identifier: Apache-2.0
#include "core/base/math.h"
#include "core/odometry/map_from_odom.h"
#include "core/odometry/odometry.h"
#include "core/tracking/tracking.h"
#include "test/decision/random.h"
#include "test/decision/random_scenes.h"
#include "test/decision/vary.h"

// What is known and commanded of a vehicle's motion: drives of random vehicles with random
// parameters through odometry, its place on earth and the tracker, with sensors that fail in random
// ways.

namespace hardpack::decision {
namespace {

constexpr int kGroups = 8;
constexpr int kDrives = 8;  // of a group
constexpr int kTicks = 1500;
constexpr uint64_t kTick_ns = 10'000'000u;
constexpr float kTick_s = 0.01f;

// Too large for a stack.
Odometry g_odometry;
MapFromOdom g_map;
Tracker g_tracker;

struct Truth {
  Pose2 pose;
  float roll_rad = 0.0f;
  float pitch_rad = 0.0f;
  WheelParts wheels;
};

class RandomMotion {
 public:
  explicit RandomMotion(uint32_t seed) : random_(seed) {
    Vary(random_, 10, vehicle_);
    Vary(random_, 10, speed_);
    Vary(random_, 10, onboard_);
    gives_wheels_s_ = random_.Between(0, 2) == 0 ? random_.RealBetween(1.0f, 6.0f) : 100.0f;
    north_rad_ = random_.RealBetween(-3.1f, 3.1f);
    tilt_rad_ = random_.RealBetween(0.0f, random_.Between(0, 7) == 0 ? 1.4f : 0.3f);
    noise_ = random_.RealBetween(0.0f, 2.0f);
    turns_per_m_ = random_.RealBetween(-0.5f, 0.5f);
    reverse_ = random_.Between(0, 5) == 0;
  }

  // Whether the stages took the parameters.
  bool Run(DecisionHash& hash) {
    const int64_t latitude_ndeg = random_.Between(-80, 80) * 1'000'000'000LL;
    const int64_t longitude_ndeg = random_.Between(-170, 170) * 1'000'000'000LL;
    const Status statuses[] = {g_odometry.Configure(vehicle_, onboard_.odometry, onboard_.ins),
                               g_map.Configure(onboard_.map_from_odom, onboard_.ins),
                               g_tracker.Configure(vehicle_, speed_, onboard_.odometry,
                                                   onboard_.dynamics, onboard_.tracking),
                               plane_.SetAnchor(latitude_ndeg, longitude_ndeg)};
    bool taken = true;
    for (const Status status : statuses) {
      hash.AddU8(static_cast<uint8_t>(status));
      taken = taken && IsUsable(status);
    }
    if (!taken) return false;
    for (tick_ = 1; tick_ <= kTicks; ++tick_) Tick(hash);
    return true;
  }

 private:
  // One time in so many.
  bool Seldom(int times) { return random_.Between(1, times) == 1; }
  float Noise(float sigma) { return random_.RealBetween(-sigma, sigma) * noise_; }

  void Tick(DecisionHash& hash) {
    now_ns_ += Seldom(300) ? 30 * kTick_ns : kTick_ns;
    Move();
    const InsSample sample = Sample();
    if (!Seldom(15)) {
      const uint64_t late_ns = Seldom(20) ? 40'000'000u : 3'000'000u;
      hash.AddU8(static_cast<uint8_t>(g_odometry.TakeIns(sample, now_ns_ - late_ns)));
    }
    hash.AddU8(static_cast<uint8_t>(g_odometry.Advance(now_ns_, Wheels())));
    const StampedPose& pose = g_odometry.pose();
    const Pose2 at = {pose.position.x_m, pose.position.y_m, pose.yaw_rad};
    hash.AddU8(static_cast<uint8_t>(g_map.TakeIns(sample, at, g_odometry.driven_m(), now_ns_)));
    g_map.Advance(now_ns_, at);
    Steer(at, hash);
    if (tick_ % 20 == 0) AddState(hash);
  }

  // The wheels lag behind what they were told; the vehicle follows them, and slips.
  void Move() {
    const WheelParts told = PartsOf(output_.wheels.left_radps, output_.wheels.right_radps);
    truth_.wheels.common_radps += 0.02f * (told.common_radps - truth_.wheels.common_radps);
    truth_.wheels.differential_radps +=
        0.015f * (told.differential_radps - truth_.wheels.differential_radps);
    const SinCosPair heading = SinCos(truth_.pose.theta_rad);
    const float way_m = 0.0029f * truth_.wheels.common_radps;
    truth_.pose.x_m += way_m * heading.cos;
    truth_.pose.y_m += way_m * heading.sin;
    const float turn_rad = 0.0031f * truth_.wheels.differential_radps;
    truth_.pose.theta_rad = WrapAngle(truth_.pose.theta_rad + turn_rad);
    truth_.roll_rad = tilt_rad_ * Sin(0.3f * truth_.pose.x_m);
    truth_.pitch_rad = tilt_rad_ * Sin(0.2f * truth_.pose.y_m + 1.0f);
  }

  InsSample Sample() {
    InsSample sample;
    sample.has_timestamp = !Seldom(10);
    sample.timestamp_ns = Seldom(40) ? last_ns_ : now_ns_;
    last_ns_ = sample.timestamp_ns;
    sample.has_angular_rate = !Seldom(12);
    const float rate_radps = 0.31f * truth_.wheels.differential_radps;
    sample.angular_rate = {Noise(0.02f), Noise(0.02f), -rate_radps - 0.01f + Noise(0.01f)};
    if (Seldom(150)) sample.angular_rate.z_radps = random_.RealBetween(-40.0f, 40.0f);
    sample.has_attitude = !Seldom(12);
    sample.roll_rad = truth_.roll_rad + Noise(0.01f);
    sample.pitch_rad = truth_.pitch_rad + Noise(0.01f);
    sample.yaw_rad = WrapAngle(north_rad_ - truth_.pose.theta_rad + Noise(0.02f));
    sample.has_velocity = !Seldom(12);
    sample.has_status = !Seldom(12);
    sample.has_position = !Seldom(12);
    const SinCosPair north = SinCos(sample.yaw_rad);
    float speed_mps = 0.29f * truth_.wheels.common_radps + Noise(0.1f);
    if (Seldom(150)) speed_mps = random_.RealBetween(-160.0f, 160.0f);
    sample.velocity_ned = {speed_mps * north.cos, speed_mps * north.sin, Noise(0.1f)};
    if (Seldom(200)) jump_m_ = random_.RealBetween(-15.0f, 15.0f);
    if (Seldom(100)) jump_m_ = 0.0f;
    sample.status.mode = Seldom(60) ? InsMode::kGnssLost : InsMode::kTracking;
    sample.status.gnss_fix = !Seldom(60);
    sample.has_position_uncertainty = Seldom(2);
    sample.position_uncertainty_m = random_.RealBetween(0.0f, 3.0f);
    const SinCosPair world = SinCos(kHalfPi - north_rad_);
    const Vec2 place = {
        world.cos * truth_.pose.x_m - world.sin * truth_.pose.y_m + jump_m_ + Noise(0.3f),
        world.sin * truth_.pose.x_m + world.cos * truth_.pose.y_m + Noise(0.3f)};
    static_cast<void>(plane_.ToGeodetic(place, sample.latitude_ndeg, sample.longitude_ndeg));
    return sample;
  }

  WheelFeedback Wheels() {
    WheelFeedback wheels;
    const bool frozen = static_cast<float>(tick_) * kTick_s > gives_wheels_s_;
    wheels.valid = !Seldom(60);
    wheels.time_ns = now_ns_ - (Seldom(30) ? kTick_ns : 0u);
    wheels.left_radps = truth_.wheels.common_radps - truth_.wheels.differential_radps;
    wheels.right_radps = truth_.wheels.common_radps + truth_.wheels.differential_radps;
    if (Abs(wheels.left_radps) > 0.1f) wheels.left_radps += Noise(0.1f);
    if (Seldom(200)) wheels.right_radps = random_.RealBetween(-120.0f, 120.0f);
    if (Seldom(300)) wheels.left_radps = random_.RealBetween(-800.0f, 800.0f);
    if (frozen) {
      wheels.left_radps = frozen_.left_radps;
      wheels.right_radps = frozen_.right_radps;
    }
    frozen_ = wheels;
    return wheels;
  }

  TrackingInput Input() {
    const Pose2& pose = g_tracker.predicted().pose;
    TrackingInput input;
    input.pose = pose;
    const int part = tick_ / 250;
    input.turn = part == 4;
    input.reverse = reverse_ && part == 2;
    input.speed_limit_mps = part == 1 || part == 5 ? 1.0f : 4.0f;
    input.acceleration_mps2 = part == 3 ? -1.0f : 0.0f;
    input.left_m = part == 3 ? 3.0f : 20.0f;
    const float wave = Sin(0.4f * pose.x_m);
    input.path = {pose.x_m, turns_per_m_ * 2.0f * wave, turns_per_m_ * 0.8f};
    input.turn_curvature_per_m = turns_per_m_ * wave;
    input.wheel_curvature_per_m = turns_per_m_ * (wave + 0.1f);
    input.curvature_rate_per_m2 = turns_per_m_ * 0.3f;
    input.aim.pose = {pose.x_m + 2.0f, pose.y_m * 0.5f, 1.5f};
    input.aim.speed_mps = input.speed_limit_mps;
    return input;
  }

  void Steer(const Pose2& pose, DecisionHash& hash) {
    const BodyMotion body = {.valid = !Seldom(8),
                             .speed_mps = g_odometry.speed_mps(),
                             .yaw_rate_radps = g_odometry.yaw_rate_radps()};
    hash.AddU8(static_cast<uint8_t>(g_tracker.Predict(now_ns_, pose, frozen_, body)));
    const TrackingInput input = Input();
    const Status status = tick_ % 700 < 600 ? g_tracker.Follow(input, kTick_s, output_)
                                            : g_tracker.StopAlong(input, kTick_s, output_);
    hash.AddU8(static_cast<uint8_t>(status));
    if (Seldom(1000)) g_tracker.Zero(output_);
    hash.AddFloat(output_.wheels.left_radps);
    hash.AddFloat(output_.wheels.right_radps);
  }

  void AddState(DecisionHash& hash) {
    for (const float value :
         {g_odometry.pose().position.x_m, g_odometry.pose().yaw_rad, g_odometry.pose().pitch_rad,
          g_odometry.speed_mps(), g_odometry.yaw_rate_radps(), g_odometry.gyro_bias_radps(),
          g_odometry.wheel_scale(), g_odometry.skid_baseline_m(), g_tracker.predicted().pose.x_m,
          g_tracker.EndSpeed(random_.RealBetween(0.0f, 4.0f), 2.0f), g_tracker.TurnAhead_m(),
          g_tracker.WheelAhead_m()}) {
      hash.AddFloat(value);
    }
    const OdometryCounters& counters = g_odometry.counters();
    for (const uint32_t count :
         {counters.gyro_rejected, counters.wheel_speed_rejected, counters.wheel_turn_rejected,
          counters.ground_speed_rejected, counters.reopened, counters.late, counters.too_late,
          counters.repeated, counters.refused, counters.gyro_frozen, counters.wheels_frozen,
          counters.restarts, g_map.counters().taken, g_map.counters().rejected,
          g_map.counters().relocations}) {
      hash.AddU32(count);
    }
    hash.AddU8(static_cast<uint8_t>(g_map.status()));
    if (!g_map.has_transform()) return;
    hash.AddFloat(g_map.map_from_odom().x_m);
    hash.AddFloat(g_map.map_from_odom().theta_rad);
    hash.AddFloat(g_map.position_sigma_m());
    hash.AddFloat(g_map.yaw_sigma_rad());
  }

  Random random_;
  VehicleParams vehicle_;
  SpeedParams speed_;
  OnboardParams onboard_;
  LocalPlane plane_;
  Truth truth_;
  TrackingOutput output_;
  WheelFeedback frozen_;
  uint64_t now_ns_ = 1'000'000'000u;
  uint64_t last_ns_ = 0;
  int tick_ = 0;
  float gives_wheels_s_ = 0.0f;  // then it says the same for ever
  float north_rad_ = 0.0f;
  float tilt_rad_ = 0.0f;
  float noise_ = 0.0f;
  float turns_per_m_ = 0.0f;
  float jump_m_ = 0.0f;  // of the satellites
  bool reverse_ = false;
};

}  // namespace

void RunRandomMotion(Report& report) {
  uint32_t taken = 0;
  uint32_t seed = 0x5eed0500u;
  for (int group = 0; group < kGroups; ++group) {
    DecisionHash hash;
    for (int drive = 0; drive < kDrives; ++drive) taken += RandomMotion(seed++).Run(hash) ? 1 : 0;
    report.Add("random.motion", hash);
  }
  PrintNumber("random.motion taken", taken);
}

}  // namespace hardpack::decision
