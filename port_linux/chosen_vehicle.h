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

// The vehicle that a configuration names (vehicle.type), of those that the program is built with
// (hal/onboard/vehicle_loop/vehicles.h).

namespace hardpack {

// What describes the lidar, by its kind; a vehicle takes that of its own.
using LidarConfigs = std::tuple<ouster::Metadata>;

// Reads what the configuration says or names of its lidar. `text` is the file that it names.
ReadOutcome ReadLidar(const Configuration& configuration, std::string& text, LidarConfigs& lidars);
// The same with that file's text at hand; `name` is what messages call it.
ReadOutcome ParseLidar(const Configuration& configuration, std::string_view text,
                       std::string_view name, LidarConfigs& lidars);

// What that vehicle's loop is set up with.
template <VehicleType Vehicle>
BasicVehicleConfig<Vehicle> ConfigOf(const Configuration& configuration,
                                     const LidarConfigs& lidars) {
  return {{configuration.planner, configuration.perception, configuration.onboard,
           configuration.labels},
          std::get<typename Vehicle::Lidar::Config>(lidars)};
}

class ChosenVehicle {
 public:
  // Makes the vehicle that is called so, not configured. False: there is none, and none is chosen.
  bool Choose(std::string_view type);

  // Makes the configuration's vehicle and sets it up. A failure says which parameters do not go
  // together: "a and b: a has to be ...".
  ReadOutcome Configure(const Configuration& configuration, const LidarConfigs& lidars);

  // Null: none is chosen.
  AnyVehicle* get();
  const AnyVehicle* get() const;

  // Of any of the vehicles, as large as the largest: for whoever wants its pages touched.
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
