// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hal/can_frame.h"
#include "tools/sim/vehicle/body_on_ground.h"
#include "tools/sim/vehicle/pose.h"
#include "tools/sim/vehicle/sevcon_drive.h"
#include "tools/sim/vehicle/steered_model.h"
#include "tools/sim/vehicle/twist_controller.h"
#include "tools/sim/vehicle/vehicle_model.h"
#include "tools/sim/world/contact.h"

// Two simulated drives, and the motion of a skid-steered vehicle from their wheels, on level ground
// that holds unless it has a model and SetGround says otherwise:
//   v = ground_per_wheel r (w_l + w_r) / 2,  w = r (w_r - w_l) / baseline
// or, if VehicleSettings has a model, by that model (vehicle_model.h), which then also moves the
// wheels. Otherwise no wheel slips; there are no collisions. A vehicle may have a motion controller
// in place of the drives (twist_controller.h), and then steered wheels in place of a skid-steered
// body (steered_model.h). Frame: the world's, metres, x and y level, angles anticlockwise.

namespace hardpack::sim {

struct GroundModel {
  double wheel_radius_m = 0.30;
  double ground_per_wheel = 0.962;
  double skid_baseline_m = 1.87;
};

struct VehicleSettings {
  DriveSettings left;
  DriveSettings right;
  GroundModel ground;
  Pose start;
  std::optional<VehicleModelParams> model;  // in place of the drives' motors and of `ground`
  // In place of the drives, which are then off; without `model` its body is a Warthog's.
  std::optional<TwistControllerSettings> controller;
  std::optional<SteeredModelParams> steered;  // in place of `model`
};

// Under a vehicle that stands in a world. In one without friction: level ground that holds.
GroundUnder GroundOf(const world::World& world, const Pose& pose,
                     const world::Footprint& footprint);

// Both drives at their nodes 2 and 3.
VehicleSettings DefaultVehicle();

enum class Side : uint8_t { kLeft = 0, kRight = 1 };
inline constexpr Side kBothSides[] = {Side::kLeft, Side::kRight};

class SimVehicle {
 public:
  static constexpr uint64_t kStep_ns = SevconDrive::kStep_ns;

  SimVehicle(const VehicleSettings& settings, uint64_t start_ns);

  // A frame sent by another node: each drive receives it. Time does not run backwards.
  void TakeFrame(const CanFrame& frame, uint64_t now_ns);
  // Appends what the drives have sent until now_ns; they receive each other's frames.
  void Advance(uint64_t now_ns, std::vector<CanFrame>& sent);

  // Null if it has drives.
  TwistController* controller() { return controller_ ? &*controller_ : nullptr; }
  const TwistController* controller() const { return controller_ ? &*controller_ : nullptr; }

  // Share of the wheels' motion that moves the vehicle from now on: 1 all of it, 0 none (they spin
  // in place).
  void SetTraction(double share) { traction_ = share; }

  // What it stands on from now on; a vehicle without a model stands on level ground that holds.
  void SetGround(const GroundUnder& ground);
  // Null without a model.
  const BodyOnGround* body() const;

  SevconDrive& drive(Side side) { return side == Side::kLeft ? left_ : right_; }
  const SevconDrive& drive(Side side) const { return side == Side::kLeft ? left_ : right_; }
  const Pose& pose() const { return pose_; }
  double speed_mps() const { return speed_mps_; }
  double yaw_rate_radps() const { return yaw_rate_radps_; }
  double driven_m() const { return driven_m_; }  // distance covered, forwards or backwards
  const world::Footprint& footprint() const { return footprint_; }

 private:
  void StepTo(uint64_t now_ns);
  void CollectSent(uint64_t now_ns);
  void Move(double seconds);

  void MoveModel();
  void MoveSteered();
  WheelSetpoints Setpoints() const;
  void TakeMotion(double speed_mps, double yaw_rate_radps, const Pose& pose, double driven_m);
  void Integrate(double seconds);

  GroundModel ground_;
  world::Footprint footprint_;
  std::optional<VehicleModelParams> body_;  // of model_
  std::optional<VehicleModel> model_;
  std::optional<SteeredModel> steered_;
  std::optional<TwistController> controller_;
  SevconDrive left_;
  SevconDrive right_;
  uint64_t now_ns_;
  std::vector<CanFrame> outbox_;
  Pose pose_;
  double speed_mps_ = 0.0;
  double yaw_rate_radps_ = 0.0;
  double driven_m_ = 0.0;
  double traction_ = 1.0;
  bool has_slipped_ = false;  // the pose is no longer the model's
};

}  // namespace hardpack::sim
