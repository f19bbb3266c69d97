// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/script/script_lidar.h"

#include <cstdlib>

#include "tools/sim/world/portable_math.h"

namespace hardpack::sim::script {
namespace {

MaybeAction LidarClock(const Words& words) {
  constexpr int64_t kMost_ms = 1'000'000;
  const auto jump_ms = Integer(words[0]);
  if (!jump_ms || std::abs(*jump_ms) > kMost_ms) return std::nullopt;
  return [jump_ns = *jump_ms * 1'000'000](ScriptedVehicle& scripted) {
    scripted.lidar().JumpClock(jump_ns);
  };
}

MaybeAction LidarBlind(const Words& words) {
  static const std::map<std::string, SectorFault> kFaults = {{"none", SectorFault::kNone},
                                                             {"lost", SectorFault::kLost},
                                                             {"invalid", SectorFault::kInvalid},
                                                             {"dark", SectorFault::kDark},
                                                             {"covered", SectorFault::kCovered}};
  const auto from_deg = Real(words[0]);
  const auto to_deg = Real(words[1]);
  const auto found = kFaults.find(words[2]);
  if (!from_deg || !to_deg || found == kFaults.end()) return std::nullopt;
  return [=, fault = found->second](ScriptedVehicle& scripted) {
    LidarFaults& faults = scripted.lidar().faults();
    faults.sector = fault;
    faults.from_deg = *from_deg;
    faults.to_deg = *to_deg;
  };
}

MaybeAction LidarFrozen(const Words& words) {
  const auto on = Switch(words[0]);
  if (!on) return std::nullopt;
  return [on = *on](ScriptedVehicle& scripted) { scripted.lidar().faults().frozen = on; };
}

MaybeAction LidarTurned(const Words& words) {
  double angle_rad[3] = {};
  for (size_t i = 0; i < 3; ++i) {
    const auto angle_deg = Real(words[i]);
    if (!angle_deg || std::abs(*angle_deg) > 180.0) return std::nullopt;
    angle_rad[i] = *angle_deg * world::kPi / 180.0;
  }
  return
      [yaw = angle_rad[0], pitch = angle_rad[1], roll = angle_rad[2]](ScriptedVehicle& scripted) {
        LidarFaults& faults = scripted.lidar().faults();
        faults.turned_yaw_rad = yaw;
        faults.turned_pitch_rad = pitch;
        faults.turned_roll_rad = roll;
      };
}

MaybeAction LidarRain(const Words& words) {
  const auto permille = Bounded<uint16_t>(words[0]);
  if (!permille || *permille > 1000) return std::nullopt;
  return [permille = *permille](ScriptedVehicle& scripted) {
    scripted.lidar().weather().rain_permille = permille;
  };
}

MaybeAction LidarDust(const Words& words) {
  const auto from_deg = Real(words[0]);
  const auto to_deg = Real(words[1]);
  const auto range_m = Real(words[2]);
  const auto permille = Bounded<uint16_t>(words[3]);
  if (!from_deg || !to_deg || !range_m || !permille || *permille > 1000) return std::nullopt;
  if (!(*range_m > LidarWeather::kDustNearest_m) || *range_m > 100.0) return std::nullopt;
  return [=](ScriptedVehicle& scripted) {
    LidarWeather& weather = scripted.lidar().weather();
    weather.dust_from_deg = *from_deg;
    weather.dust_to_deg = *to_deg;
    weather.dust_range_m = *range_m;
    weather.dust_permille = *permille;
  };
}

MaybeAction LidarRestart(const Words& /*words*/) {
  return [](ScriptedVehicle& scripted) { scripted.RestartLidar(); };
}

}  // namespace

void AddLidarCommands(std::map<std::string, Command>& commands) {
  commands["lidar-clock"] = {1, 1, LidarClock};
  commands["lidar-blind"] = {3, 3, LidarBlind};
  commands["lidar-frozen"] = {1, 1, LidarFrozen};
  commands["lidar-turned"] = {3, 3, LidarTurned};
  commands["lidar-rain"] = {1, 1, LidarRain};
  commands["lidar-dust"] = {4, 4, LidarDust};
  commands["lidar-restart"] = {0, 0, LidarRestart};
}

}  // namespace hardpack::sim::script
