// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/loop_bound.h"
#include "core/base/status.h"
#include "core/timebase/timebase.h"
#include "hal/labels/labels.h"
#include "hal/onboard/pilot/pilot.h"
#include "hal/onboard/vehicle_loop/tick.h"
#include "hal/onboard/vehicle_loop/vehicles.h"

// The whole system for one period: bytes in, CAN frames out. It makes no call through an interface
// and reads no clock: all its input is in TickInput, so a recording of the inputs reproduces the
// outputs bit for bit. The state is one trivially copyable object without pointers. The vehicle's
// devices are given by a type (vehicles.h); the pilot decides what to do with their data.

namespace hardpack {

// Everything that determines the vehicle's behaviour.
template <VehicleType Vehicle>
struct BasicVehicleConfig : PilotConfig {
  typename Vehicle::Lidar::Config lidar;
};

template <VehicleType Vehicle>
class BasicVehicleLoop : public Pilot, public TickLimits {
 public:
  using Lidar = typename Vehicle::Lidar;
  using Ins = typename Vehicle::Ins;
  using Drives = typename Vehicle::Drives;
  using Config = BasicVehicleConfig<Vehicle>;

  // Parameters that conflict, by name: those of config/conflicts.h, and a period in which the lidar
  // sends more columns than a tick classes directions, or more datagrams than a tick takes. No
  // name: no conflict. Precondition: each parameter is within its range.
  static ParameterConflict ConflictOf(const Config& config);

  // Sets everything up and clears the state. The statuses of the stages' Configure; also
  // kParameterOutOfRange if there is a conflict. Cost: everything is cleared.
  Status Configure(const Config& config);

  // One tick. kOk; kNotStarted: Configure has not succeeded; kInvalidArgument: the time or the
  // index does not increase, or the input exceeds the limits. Then only a counter has changed, and
  // `output` is valid but has no frames. Cost: bounded, the sum of its stages.
  Status Tick(const TickInput& input, TickOutput& output);

  const Drives& drives() const { return drives_; }
  const Lidar& lidar() const { return lidar_; }
  const Ins& ins() const { return ins_; }
  const typename Lidar::Config& lidar_config() const { return lidar_config_; }
  const Timebase& lidar_time() const { return lidar_time_; }

 private:
  bool IsRefused(const TickInput& input) const;
  DriveFeedback Sense(const TickInput& input);
  void Map(const TickInput& input);
  void Send(const DriveDemand& demand, TickOutput& output);
  void AddToHash(const TickOutput& output);
  void TakeDatagrams(const TickInput& input, InputSource source);
  void TakeDatagram(const TickDatagram& datagram);
  Status TakeIns(std::span<const uint8_t> bytes);
  Status TakeLabels(std::span<const uint8_t> bytes);
  void TakeLabelColumn(const labels::Header& header, std::span<const uint8_t> bytes, int index);
  Status TakeLidar(std::span<const uint8_t> bytes);
  void TakeLidarColumn(std::span<const uint8_t> bytes, int index);
  Status CheckLidar(std::span<const uint8_t> bytes);
  Status ObserveLidarClock(std::span<const uint8_t> bytes);
  uint64_t MeasuredAt(const InsSample& sample);

  bool configured_ = false;
  bool may_resume_ = true;    // the lidar has not restarted in this tick
  int32_t columns_left_ = 0;  // lidar columns that this tick still takes ...
  int32_t labels_left_ = 0;   // ... and label columns
  InsSample ins_sample_;      // just decoded
  LidarColumn column_;
  ColumnLabels labels_;
  typename Lidar::Config lidar_config_;
  Lidar lidar_;
  Ins ins_;
  Drives drives_;
  Timebase lidar_time_;
  Timebase ins_time_;
};

using VehicleLoop = BasicVehicleLoop<Warthog>;
using VehicleConfig = BasicVehicleConfig<Warthog>;
static_assert(std::is_trivially_copyable_v<VehicleLoop>);

// Size limit of the whole state: it is copied into a flight log at once.
inline constexpr int kStateBudget_bytes = 11 * 1024 * 1024;
static_assert(sizeof(VehicleLoop) <= kStateBudget_bytes);
static_assert(sizeof(BasicVehicleLoop<WarthogVelodyne>) <= kStateBudget_bytes);
static_assert(sizeof(BasicVehicleLoop<TwistBase>) <= kStateBudget_bytes);

extern template class BasicVehicleLoop<Warthog>;
extern template class BasicVehicleLoop<WarthogVelodyne>;
extern template class BasicVehicleLoop<TwistBase>;

}  // namespace hardpack
