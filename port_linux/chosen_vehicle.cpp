// SPDX-License-Identifier: Apache-2.0
#include "port_linux/chosen_vehicle.h"

#include <memory>

#include "port_linux/files/ouster_metadata.h"
#include "port_linux/files/read_file.h"

namespace hardpack {
namespace {

template <typename... Vehicle, typename Storage>
bool Emplace(VehicleList<Vehicle...>, std::string_view type, Storage& storage) {
  return ((type == Vehicle::kType && (storage.template emplace<VehicleOf<Vehicle>>(), true)) ||
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
    return {status, std::string("the configuration does not go together: ") + StatusName(status)};
  }
  std::string text = std::string(conflict.name) + " and " + conflict.other + ": ";
  return {status, text.append(conflict.name).append(" has to be ").append(conflict.rule)};
}

}  // namespace

ReadOutcome ReadLidar(const Configuration& configuration, std::string& text, LidarConfigs& lidars) {
  const std::string& metadata = configuration.lidar.metadata;
  const ReadOutcome read = ReadFile(metadata, ouster::kMaxMetadataBytes, text);
  return read.ok() ? ParseLidar(configuration, text, metadata, lidars) : read;
}

ReadOutcome ParseLidar(const Configuration& /*configuration*/, std::string_view text,
                       std::string_view name, LidarConfigs& lidars) {
  return ouster::ParseMetadata(text, name, std::get<ouster::Metadata>(lidars));
}

bool ChosenVehicle::Choose(std::string_view type) {
  vehicle_.emplace<std::monostate>();
  return Emplace(Vehicles{}, type, vehicle_);
}

ReadOutcome ChosenVehicle::Configure(const Configuration& configuration,
                                     const LidarConfigs& lidars) {
  if (!Choose(configuration.vehicle_type)) {
    return {Status::kUnsupported,
            "vehicle.type: this program has no " + configuration.vehicle_type};
  }
  return std::visit(
      [&](auto& vehicle) -> ReadOutcome {
        if constexpr (std::is_same_v<std::decay_t<decltype(vehicle)>, std::monostate>) {
          return {Status::kNotStarted, "no vehicle is chosen"};
        } else {
          return SetUp(configuration, lidars, vehicle);
        }
      },
      vehicle_);
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
