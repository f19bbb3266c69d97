// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

#include "hal/onboard/vehicle_loop/any_vehicle.h"
#include "port_linux/files/configuration.h"
#include "port_linux/files/read_outcome.h"

// The vehicle that a configuration selects (vehicle.type), among those built into the program
// (hal/onboard/vehicle_loop/vehicles.h).

namespace hardpack {

// The description of the lidar, by kind; a vehicle uses that of its own lidar.
using LidarConfigs = std::tuple<ouster::Metadata, velodyne::Config>;

// Reads the lidar's description that the configuration names. `text` is the content of that file.
ReadOutcome ReadLidar(const Configuration& configuration, std::string& text, LidarConfigs& lidars);
// The same from the file's text; `name` is its name in messages.
ReadOutcome ParseLidar(const Configuration& configuration, std::string_view text,
                       std::string_view name, LidarConfigs& lidars);

// The configuration of that vehicle's loop.
template <VehicleType Vehicle>
BasicVehicleConfig<Vehicle> ConfigOf(const Configuration& configuration,
                                     const LidarConfigs& lidars) {
  return {{configuration.planner, configuration.perception, configuration.onboard,
           configuration.labels, configuration.areas},
          std::get<typename Vehicle::Lidar::Config>(lidars)};
}

class ChosenVehicle {
 public:
  // Creates the vehicle of that type, not configured. False: there is none, and none is selected.
  bool Choose(std::string_view type);

  // Creates the configuration's vehicle and configures it. A failure names the conflicting
  // parameters: "a and b: a must be ...".
  ReadOutcome Configure(const Configuration& configuration, const LidarConfigs& lidars);

  // Null if none is selected.
  AnyVehicle* get();
  const AnyVehicle* get() const;

  // Memory of any of the vehicles, as large as the largest: for prefaulting its pages.
  std::span<std::byte> memory() { return std::as_writable_bytes(std::span(&vehicle_, 1)); }

 private:
  template <typename List>
  struct Storage;
  template <typename... Vehicle>
  struct Storage<VehicleList<Vehicle...>> {
    using Type = std::variant<std::monostate, VehicleOf<Vehicle>...>;
  };

  Storage<Vehicles>::Type vehicle_;
};

}  // namespace hardpack
