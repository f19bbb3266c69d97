// SPDX-License-Identifier: Apache-2.0
#include "port_linux/chosen_vehicle.h"

#include <memory>

#include "port_linux/files/ouster_metadata.h"
#include "port_linux/files/read_file.h"
#include "port_linux/files/vehicle_types.h"

namespace hardpack {
namespace {

// Creates the vehicle of that type and passes it to `use`. False: there is none.
template <typename... Vehicle, typename Storage, typename Use>
bool Make(VehicleList<Vehicle...>, std::string_view type, Storage& storage, const Use& use) {
  storage.template emplace<std::monostate>();
  return ((type == Vehicle::kType && (use(storage.template emplace<VehicleOf<Vehicle>>()), true)) ||
          ...);
}

template <VehicleType Vehicle>
ReadOutcome SetUp(const Configuration& configuration, const LidarConfigs& lidars,
                  VehicleOf<Vehicle>& vehicle) {
  const auto config =
      std::make_unique<BasicVehicleConfig<Vehicle>>(ConfigOf<Vehicle>(configuration, lidars));
  const Status status = vehicle.loop().Configure(*config);
  if (IsUsable(status)) return {};
  const ParameterConflict conflict = BasicVehicleLoop<Vehicle>::ConflictOf(*config);
  if (conflict.name == nullptr) {
    return {status, std::string("the configuration is inconsistent: ") + StatusName(status)};
  }
  std::string text = std::string(conflict.name) + " and " + conflict.other + ": ";
  return {status, text.append(conflict.name).append(" must be ").append(conflict.rule)};
}

}  // namespace

ReadOutcome ReadLidar(const Configuration& configuration, std::string& text, LidarConfigs& lidars) {
  text.clear();
  if (!DevicesOf(configuration.vehicle_type).ouster) {
    return ParseLidar(configuration, text, "", lidars);
  }
  const std::string& metadata = configuration.lidar.metadata;
  const ReadOutcome read = ReadFile(metadata, ouster::kMaxMetadataBytes, text);
  return read.ok() ? ParseLidar(configuration, text, metadata, lidars) : read;
}

ReadOutcome ParseLidar(const Configuration& configuration, std::string_view text,
                       std::string_view name, LidarConfigs& lidars) {
  if (DevicesOf(configuration.vehicle_type).ouster) {
    return ouster::ParseMetadata(text, name, std::get<ouster::Metadata>(lidars));
  }
  return {ToConfig(configuration.velodyne, std::get<velodyne::Config>(lidars)), "[velodyne]"};
}

bool ChosenVehicle::Choose(std::string_view type) {
  return Make(Vehicles{}, type, vehicle_, [](const AnyVehicle&) {});
}

ReadOutcome ChosenVehicle::Configure(const Configuration& configuration,
                                     const LidarConfigs& lidars) {
  ReadOutcome outcome = {Status::kUnsupported,
                         "vehicle.type: this program has no " + configuration.vehicle_type};
  Make(Vehicles{}, configuration.vehicle_type, vehicle_,
       [&](auto& vehicle) { outcome = SetUp(configuration, lidars, vehicle); });
  return outcome;
}

AnyVehicle* ChosenVehicle::get() {
  return std::visit(
      [](auto& vehicle) -> AnyVehicle* {
        if constexpr (std::is_same_v<std::decay_t<decltype(vehicle)>, std::monostate>) {
          return nullptr;
        } else {
          return &vehicle;
        }
      },
      vehicle_);
}

const AnyVehicle* ChosenVehicle::get() const {
  return const_cast<ChosenVehicle*>(this)->get();
}

}  // namespace hardpack
