// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/sensors/sim_lidar.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace hardpack::sim {
namespace {

using world::kPi;
using world::Turn;
using world::TurnOf;
using world::Vector;

LidarSettings Completed(LidarSettings settings) {
  if (IsVelodyne(settings.model)) settings.beams = LidarBeams::Of(settings.model);
  return settings;
}

}  // namespace

SimLidar::SimLidar(const LidarSettings& settings, uint64_t start_ns)
    : settings_(Completed(settings)),
      head_(settings_),
      ouster_(settings_),
      velodyne_(settings_.model),
      said_(static_cast<size_t>(head_.places())),
      foliage_key_(world::KeyOf(settings.seed, world::Stream::kFoliage)),
      range_key_(world::KeyOf(settings.seed, world::Stream::kRange)),
      drop_out_key_(world::KeyOf(settings.seed, world::Stream::kDropOut)),
      rain_key_(world::KeyOf(settings.seed, world::Stream::kRain)),
      dust_key_(world::KeyOf(settings.seed, world::Stream::kDust)),
      first_start_ns_(start_ns),
      start_ns_(start_ns) {
  for (size_t beam = 0; beam < Beams(); ++beam) {
    const Turn altitude = TurnOf(settings_.beams.altitude_deg[beam] * kPi / 180.0);
    const Turn azimuth = TurnOf(-settings_.beams.azimuth_deg[beam] * kPi / 180.0);
    beams_[beam] = {altitude.cos * azimuth.cos, altitude.cos * azimuth.sin, altitude.sin};
  }
}

void SimLidar::Restart(uint64_t now_ns) {
  start_ns_ = now_ns;
  columns_sent_ = 0;
  loses_packet_ = false;
  settings_.clock_start_ns = IsVelodyne(settings_.model) ? 0 : 5'000'000'000;
  ouster_.Restart();
  velodyne_.Restart();
}

void SimLidar::JumpClock(int64_t jump_ns) {
  // Unsigned, as the stamps are: a jump to before their zero wraps around as theirs would.
  settings_.clock_start_ns += static_cast<uint64_t>(jump_ns);
}

std::string SimLidar::MetadataJson() const {
  return IsVelodyne(settings_.model) ? std::string() : ouster_.MetadataJson(settings_);
}

uint64_t SimLidar::StampOf_ns(uint64_t since_ns) const {
  const double drift_ns = settings_.clock_drift * static_cast<double>(since_ns);
  return settings_.clock_start_ns + since_ns + static_cast<uint64_t>(std::llround(drift_ns));
}

void SimLidar::Advance(uint64_t now_ns, const world::BodyPose& pose, const world::World& world,
                       std::vector<std::vector<uint8_t>>& packets, std::vector<CastColumn>* truth) {
  const uint64_t last_after_ns = settings_.beams.fires_after_ns[Beams() - 1];
  while (start_ns_ + head_.Since_ns(columns_sent_) + last_after_ns <= now_ns) {
    const uint64_t since_ns = head_.Since_ns(columns_sent_);
    const uint64_t stamp_ns = StampOf_ns(since_ns);
    CastColumnUnderWay(now_ns, pose, world);
    if (weather_.dust_permille > 0) Dust();
    if (weather_.rain_permille > 0) Rain();
    Freeze();
    Spoil();
    if (truth != nullptr && !IsVelodyne(settings_.model)) {
      const OusterPackets::Column name = NameOfColumn(stamp_ns);
      truth->push_back(
          {start_ns_ + since_ns, stamp_ns, name.frame_id, name.measurement_id, labels_});
    }
    const bool is_whole = SendColumnUnderWay(stamp_ns);
    ++columns_sent_;
    ++columns_cast_;
    if (!is_whole) continue;
    if (!loses_packet_) {
      packets.push_back(IsVelodyne(settings_.model) ? velodyne_.bytes() : ouster_.bytes());
    }
    loses_packet_ = false;
  }
  has_pose_ = true;
  pose_ns_ = now_ns;
  pose_ = pose;
}

OusterPackets::Column SimLidar::NameOfColumn(uint64_t stamp_ns) const {
  OusterPackets::Column name;
  name.measurement_id = static_cast<uint16_t>(head_.Place(columns_sent_));
  name.frame_id = static_cast<uint16_t>(columns_sent_ / static_cast<uint64_t>(settings_.columns));
  name.stamp_ns = stamp_ns;
  name.is_valid = faults_.sector != SectorFault::kInvalid || !IsInSector();
  return name;
}

// True: it completes a packet.
bool SimLidar::SendColumnUnderWay(uint64_t stamp_ns) {
  if (!IsVelodyne(settings_.model)) return ouster_.Append(NameOfColumn(stamp_ns), returns_);
  const double azimuth_turns = head_.Azimuth_turns(head_.Since_ns(columns_sent_));
  return velodyne_.Append(azimuth_turns, stamp_ns, returns_);
}

world::BodyPose SimLidar::PoseAt(uint64_t time_ns, uint64_t now_ns,
                                 const world::BodyPose& pose) const {
  // A sequence that was under way at the previous call began slightly before that pose.
  if (!has_pose_ || time_ns >= now_ns || now_ns <= pose_ns_ ||
      time_ns + LidarHead::kSequence_ns < pose_ns_) {
    return pose;
  }
  const double left =
      static_cast<double>(now_ns - time_ns) / static_cast<double>(now_ns - pose_ns_);
  const auto between = [left](double from, double to) { return to - left * (to - from); };
  const auto turned = [left](double from, double to) {
    return to - left * world::Wrapped(to - from);
  };
  return {{between(pose_.position.x_m, pose.position.x_m),
           between(pose_.position.y_m, pose.position.y_m),
           between(pose_.position.z_m, pose.position.z_m)},
          turned(pose_.roll_rad, pose.roll_rad),
          turned(pose_.pitch_rad, pose.pitch_rad),
          turned(pose_.yaw_rad, pose.yaw_rad)};
}

// The stand from which a beam of the current column is cast.
SimLidar::Stand SimLidar::StandOf(size_t beam, uint64_t now_ns, const world::BodyPose& pose) const {
  const uint64_t after_ns = settings_.beams.fires_after_ns[beam];
  const world::BodyPose at =
      PoseAt(start_ns_ + head_.Since_ns(columns_sent_) + after_ns, now_ns, pose);
  Stand stand;
  stand.encoder =
      TurnOf(head_.Angle_rad(columns_sent_, after_ns) + settings_.yaw_rad + faults_.turned_yaw_rad);
  stand.to_world = world::Rotation::FromAngles(at.roll_rad, at.pitch_rad, at.yaw_rad);
  const double n_m = settings_.beams.origin_to_beam_m;
  const Vector offset = stand.to_world.Apply(
      {settings_.x_m + n_m * stand.encoder.cos, settings_.y_m + n_m * stand.encoder.sin,
       settings_.z_m + settings_.beams.lidar_above_sensor_m + settings_.beams.above_m[beam]});
  stand.origin = {at.position.x_m + offset.x_m, at.position.y_m + offset.y_m,
                  at.position.z_m + offset.z_m};
  return stand;
}

void SimLidar::CastColumnUnderWay(uint64_t now_ns, const world::BodyPose& pose,
                                  const world::World& world) {
  const uint64_t time_ns = start_ns_ + head_.Since_ns(columns_sent_);
  Stand stand = StandOf(0, now_ns, pose);
  const std::vector<world::Body> people =
      world.PeopleAt(static_cast<double>(time_ns - first_start_ns_) * 1.0e-9);
  const bool is_tilted = faults_.turned_pitch_rad != 0.0 || faults_.turned_roll_rad != 0.0;
  const world::Rotation tilt =
      world::Rotation::FromAngles(faults_.turned_roll_rad, faults_.turned_pitch_rad, 0.0);
  const world::Rotation off =
      world::Rotation::FromAngles(settings_.off_roll_rad, settings_.off_pitch_rad, 0.0);
  const LidarBeams& of = settings_.beams;
  for (size_t beam = 0; beam < Beams(); ++beam) {
    const bool stands_elsewhere =
        beam > 0 && (of.fires_after_ns[beam] != of.fires_after_ns[beam - 1] ||
                     of.above_m[beam] != of.above_m[beam - 1]);
    if (stands_elsewhere) stand = StandOf(beam, now_ns, pose);
    const uint64_t index = columns_cast_ * kBeams + beam;
    const Turn& encoder = stand.encoder;
    const Vector& d = beams_[beam];
    Vector along = {encoder.cos * d.x_m - encoder.sin * d.y_m,
                    encoder.sin * d.x_m + encoder.cos * d.y_m, d.z_m};
    if (is_tilted) along = tilt.Apply(along);
    world::Ray ray;
    ray.origin = stand.origin;
    ray.direction = stand.to_world.Apply(off.Apply(along));
    ray.max_range_m = settings_.reach_m;
    ray.key = world::DrawBits(foliage_key_, index);
    const world::Hit hit = world.Cast(ray, people);
    const uint32_t range_mm = hit.any() ? Measured_mm(hit.range_m + of.origin_to_beam_m, index) : 0;
    returns_.ranges_mm[beam] = range_mm;
    returns_.reflectivities[beam] = range_mm != 0 ? hit.reflectivity : uint8_t{0};
    returns_.is_faint[beam] = false;
    labels_[beam] = range_mm != 0 ? static_cast<uint8_t>(hit.label) : uint8_t{0};
  }
}

// 0: no return.
uint32_t SimLidar::Measured_mm(double range_m, uint64_t index) const {
  if (settings_.drop_out_share > 0.0 &&
      world::DrawUniform(drop_out_key_, index) < settings_.drop_out_share) {
    return 0;
  }
  const double sigma_m = settings_.noise_m + settings_.noise_per_m * range_m;
  double measured_m = range_m;
  if (sigma_m > 0.0) measured_m += sigma_m * world::DrawNormal(range_key_, index);
  return static_cast<uint32_t>(std::lround(1000.0 * std::max(measured_m, 0.1)));
}

// The beam's ray hits a drop or a grain in front of its original target: at `share` of the distance
// between the nearest and the farthest possible place. Its label stays that of the target behind:
// the picture of a segmentation computer shows the world through rain and dust.
void SimLidar::SeeInAir(size_t beam, double nearest_m, double farthest_m, double share) {
  const double free_m =
      returns_.ranges_mm[beam] == 0 ? farthest_m : 0.001 * returns_.ranges_mm[beam];
  const double last_m = std::min(farthest_m, free_m);
  if (last_m <= nearest_m) return;
  const double range_m = nearest_m + share * (last_m - nearest_m);
  returns_.ranges_mm[beam] = static_cast<uint32_t>(std::lround(1000.0 * range_m));
  returns_.reflectivities[beam] = 1;
  returns_.is_faint[beam] = true;
}

void SimLidar::Rain() {
  const double seen_share = 0.001 * weather_.rain_permille;
  for (size_t beam = 0; beam < Beams(); ++beam) {
    const uint64_t index = 2 * (columns_cast_ * kBeams + beam);
    const double drawn = world::DrawUniform(rain_key_, index);
    if (drawn < seen_share) {
      SeeInAir(beam, LidarWeather::kRainNearest_m, LidarWeather::kRainFarthest_m,
               world::DrawUniform(rain_key_, index + 1));
    } else if (drawn > 1.0 - LidarWeather::kRainLost) {
      returns_.ranges_mm[beam] = 0;
      returns_.reflectivities[beam] = 0;
      returns_.is_faint[beam] = false;
      labels_[beam] = 0;
    }
  }
}

void SimLidar::Dust() {
  if (!LooksBetween(weather_.dust_from_deg, weather_.dust_to_deg)) return;
  for (size_t beam = 0; beam < Beams(); ++beam) {
    const uint64_t index = 2 * (columns_cast_ * kBeams + beam);
    if (world::DrawUniform(dust_key_, index) >= 0.001 * weather_.dust_permille) continue;
    SeeInAir(beam, LidarWeather::kDustNearest_m, weather_.dust_range_m,
             world::DrawUniform(dust_key_, index + 1));
  }
}

bool SimLidar::IsInSector() const {
  return faults_.sector != SectorFault::kNone && LooksBetween(faults_.from_deg, faults_.to_deg);
}

// By the horizontal direction of the current column at its start, without the turn of the mount. A
// full turn includes every direction.
bool SimLidar::LooksBetween(double from_deg, double to_deg) const {
  if (to_deg - from_deg >= 360.0) return true;
  const double angle_deg = 360.0 * head_.Turns(columns_sent_) + settings_.yaw_rad * 180.0 / kPi;
  const auto wrapped = [](double deg) { return deg - 360.0 * std::floor(deg / 360.0); };
  return wrapped(angle_deg - from_deg) <= wrapped(to_deg - from_deg);
}

// While the image is frozen, the current column repeats the last data from its place.
void SimLidar::Freeze() {
  const auto place = static_cast<size_t>(head_.Place(columns_sent_));
  if (faults_.frozen) {
    returns_ = said_[place];
    return;
  }
  said_[place] = returns_;
  // The next sequence of a Velodyne may lie beyond the next place and skip that one.
  if (IsVelodyne(settings_.model)) said_[(place + 1) % said_.size()] = returns_;
}

// Applies the fault of a sector to the current column.
void SimLidar::Spoil() {
  if (!IsInSector()) return;
  const bool is_dark = faults_.sector == SectorFault::kDark ||
                       (faults_.sector == SectorFault::kInvalid && IsVelodyne(settings_.model));
  if (faults_.sector == SectorFault::kLost) loses_packet_ = true;
  if (is_dark) {
    returns_.ranges_mm.fill(0);
    returns_.reflectivities.fill(0);
  }
  if (faults_.sector == SectorFault::kCovered) {
    constexpr uint32_t kWindow_mm = 60;
    for (size_t beam = 0; beam < Beams(); ++beam) {
      const uint64_t index = columns_cast_ * kBeams + beam;
      returns_.ranges_mm[beam] =
          kWindow_mm + static_cast<uint32_t>(world::DrawBits(range_key_, index) % 9);
    }
  }
}

}  // namespace hardpack::sim
