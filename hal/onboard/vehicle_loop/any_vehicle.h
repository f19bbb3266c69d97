// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/decision_hash.h"
#include "core/base/loop_bound.h"
#include "core/base/status.h"
#include "hal/onboard/control/status_report.h"
#include "hal/onboard/pilot/pilot.h"
#include "hal/onboard/vehicle_loop/device_reports.h"
#include "hal/onboard/vehicle_loop/tick.h"
#include "hal/onboard/vehicle_loop/vehicle_loop.h"

// A vehicle's loop behind an interface, for users who learn only at run time which vehicle it is:
// the run loop, replay, simulation. The tick itself has no virtual call; the only one is around it.

namespace hardpack {

class AnyVehicle {
 public:
  // The name of its type: vehicle.type in a configuration.
  virtual const char* type() const = 0;
  // Copies it into a field of a report or a record, padded with zeros.
  void CopyType(char (&text)[kMaxVehicleType + 1]) const;

  // BasicVehicleLoop::Tick.
  virtual Status Tick(const TickInput& input, TickOutput& output) = 0;

  virtual const Pilot& pilot() const = 0;

  // What the drives report, as of the last tick.
  virtual DriveFeedback Drives() const = 0;

  // No drive produces torque: each has reported so, or has been silent for so long that we no
  // longer wait for it. A command or a wish to be off does not count.
  virtual bool DrivesAreOff() const = 0;

  // Fills in the report parts of its devices.
  virtual void Report(control::StatusReport& report) const = 0;

  // The entire state, as a flight log copies it.
  virtual std::span<const std::byte> state() const = 0;
  // Restores a state copied from a vehicle with the same layout. kInvalidArgument: it has another
  // size; then nothing has changed.
  virtual Status Restore(std::span<const std::byte> state) = 0;

  // Distinguishes programs and vehicles with different state layouts, as far as the sizes of their
  // parts show it: the state of one is meaningless to the other.
  virtual uint64_t state_layout() const = 0;

 protected:
  ~AnyVehicle() = default;
};

inline void AnyVehicle::CopyType(char (&text)[kMaxVehicleType + 1]) const {
  const char* const name = type();
  bool ended = false;
  HP_LOOP_BOUND(kMaxVehicleType + 1)
  for (int i = 0; i <= kMaxVehicleType; ++i) {
    ended = ended || i == kMaxVehicleType || name[i] == '\0';
    text[i] = ended ? '\0' : name[i];
  }
}

template <VehicleType Vehicle>
class VehicleOf final : public AnyVehicle {
 public:
  using Loop = BasicVehicleLoop<Vehicle>;

  // Configure it before the first tick.
  Loop& loop() { return loop_; }
  const Loop& loop() const { return loop_; }

  const char* type() const override { return Vehicle::kType; }
  Status Tick(const TickInput& input, TickOutput& output) override {
    return loop_.Tick(input, output);
  }
  const Pilot& pilot() const override { return loop_; }
  DriveFeedback Drives() const override { return loop_.drives().State(loop_.now_ns()); }
  bool DrivesAreOff() const override { return loop_.drives().AreOff(loop_.now_ns()); }
  void Report(control::StatusReport& report) const override {
    AddToReport(loop_.lidar(), report);
    AddToReport(loop_.ins(), report);
    AddToReport(loop_.drives(), loop_.now_ns(), loop_.config().onboard, report);
    AddToReport(loop_.lidar_time(), report.lidar_clock);
  }
  std::span<const std::byte> state() const override { return std::as_bytes(std::span(&loop_, 1)); }
  Status Restore(std::span<const std::byte> state) override {
    if (state.size() != sizeof(Loop)) return Status::kInvalidArgument;
    const std::span<std::byte> own = std::as_writable_bytes(std::span(&loop_, 1));
    HP_LOOP_BOUND(sizeof(Loop))
    for (size_t i = 0; i < sizeof(Loop); ++i) own[i] = state[i];
    return Status::kOk;
  }
  uint64_t state_layout() const override;

 private:
  Loop loop_;
};

template <VehicleType Vehicle>
uint64_t VehicleOf<Vehicle>::state_layout() const {
  constexpr std::array<uint64_t, 19> kSizes = {
      sizeof(void*),
      sizeof(Loop),
      alignof(Loop),
      sizeof(typename Loop::Config),
      sizeof(LoopCounters),
      sizeof(Mapper),
      sizeof(Replanner),
      sizeof(Odometry),
      sizeof(MapFromOdom),
      sizeof(Tracker),
      sizeof(Supervisor),
      sizeof(Timebase),
      sizeof(typename Loop::Drives),
      sizeof(typename Loop::Lidar),
      sizeof(typename Loop::Ins),
      sizeof(control::OperatorCommand),
      sizeof(PlannerParams),
      sizeof(OnboardParams),
      std::endian::native == std::endian::little ? 1u : 0u};
  DecisionHash hash;
  HP_LOOP_BOUND(kSizes.size())
  for (const uint64_t size : kSizes) hash.AddU64(size);
  HP_LOOP_BOUND(kMaxVehicleType)
  for (int i = 0; i < kMaxVehicleType && Vehicle::kType[i] != '\0'; ++i) {
    hash.AddU8(static_cast<uint8_t>(Vehicle::kType[i]));
  }
  return hash.value();
}

}  // namespace hardpack
