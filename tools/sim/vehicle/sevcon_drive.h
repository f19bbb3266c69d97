// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "hal/can_frame.h"
#include "tools/sim/vehicle/object_dictionary.h"
#include "tools/sim/vehicle/power_states.h"
#include "tools/sim/vehicle/sdo_server.h"
#include "tools/sim/vehicle/wheel_motor.h"

// One simulated Sevcon Gen4 traction controller with its motor and wheels: a CANopen node (CiA 301)
// with a drive profile (CiA 402), written from the standards and the controller's published EDS
// (REFERENCES.md, docs/vehicle.md), not from hal/sevcon, which it tests. Time and frames are
// arguments; the same calls give the same frames.
//
// Assumptions made here, because no public document states them: how long booting and the
// transitions of the state machine take, the RPDO time-out (the EDS has only its severity, 5902h),
// and that its severities 2 and 3 can both be reset.

namespace hardpack::sim {

enum class NmtState : uint8_t {  // as in a heartbeat
  kInitialising = 0,
  kStopped = 4,
  kOperational = 5,
  kPreOperational = 0x7f,
  kOff = 0xff,  // no supply: not on the bus
};
const char* Name(NmtState state);

struct DriveSettings {
  Gen4Identity identity;
  uint16_t login_user = 1;  // invented, like the password: neither is public
  uint16_t login_password = 0x1234;
  double gear_ratio = 1.0;  // motor turns per wheel turn
  int sign = 1;             // of the motor's rotation when the wheel drives forward
  double boot_s = 0.3;
  double transition_s = 0.02;
  double rpdo_timeout_s = 0.2;
  bool has_rpdo_event_timer = false;  // 1400h:5 exists and, when not 0, is that time
  double battery_V = 48.0;
  MotorModel motor;
};

// Faults injected by a test.
struct DriveFaults {
  bool silent = false;  // neither sends nor receives
  bool no_heartbeat = false;
  bool no_process_data = false;             // sends none
  bool mode_refused = false;                // 6061h does not change
  bool opposite = false;                    // the motor turns against its command
  bool blocked = false;                     // the wheels do not turn
  bool frozen = false;                      // the reported speed does not change
  int32_t speed_offset_rpm = 0;             // of the reported speed
  std::map<uint16_t, uint32_t> sdo_aborts;  // index: code of each answer
  std::set<uint16_t> sdo_silent;            // never answered
  std::set<uint16_t> sdo_kept;              // writes are answered, but nothing is written
};

struct Emergency {
  uint16_t code = 0;
  uint8_t error_register = 1;
  uint16_t fault_id = 0;  // the manufacturer's
};

class SevconDrive final : private SdoObjects {
 public:
  static constexpr uint64_t kStep_ns = 1'000'000;

  // Off until power_on_ns.
  SevconDrive(const DriveSettings& settings, uint64_t power_on_ns);

  // Takes a frame that was on the bus at now_ns. Time does not run backwards.
  void TakeFrame(const CanFrame& frame, uint64_t now_ns);
  // Appends the frames it has sent until now_ns, in order.
  void Advance(uint64_t now_ns, std::vector<CanFrame>& sent);

  // Faults.
  DriveFaults& faults() { return faults_; }
  void Reboot(bool with_boot_up_message);
  void SetKey(bool on);  // its supply
  void SendEmergency(const Emergency& emergency);
  void RaiseFault(const Emergency& emergency);
  void LoseEnable() { power_.Disable(); }
  void EnterNmtState(NmtState state);
  // As if built that way: also after a reboot.
  void SetObject(uint16_t index, uint8_t sub_index, int64_t value);

  // From now on the caller turns its wheels, step by step: to setpoint_radps() if it turns() them,
  // otherwise they are braked.
  void LeaveMotor() { has_motor_ = false; }
  double setpoint_radps() const { return faults_.opposite ? -command_radps_ : command_radps_; }
  bool turns() const { return turns_ && !faults_.blocked; }
  void TurnWheels(double speed_radps) { turned_radps_ = speed_radps; }

  NmtState nmt_state() const { return nmt_; }
  PowerState power_state() const { return power_.state(); }
  uint16_t controlword() const { return power_.controlword(); }
  uint16_t statusword() const;
  bool braked() const { return !power_.driven(); }
  double wheel_radps() const { return motor_.speed_radps(); }  // forward positive, true
  double commanded_radps() const { return command_radps_; }    // of the wheel
  int32_t reported_rpm() const { return reported_rpm_; }       // of the motor, 606Ch
  uint32_t rpdos() const { return rpdos_; }                    // taken
  const Emergency& last_emergency() const { return emergency_; }
  uint32_t emergencies() const { return emergencies_; }
  uint64_t boot_ups() const { return boot_ups_; }
  int64_t object(uint16_t index, uint8_t sub_index) const { return objects_.Get(index, sub_index); }
  const DriveSettings& settings() const { return settings_; }

 private:
  struct MadeObject {
    uint16_t index;
    uint8_t sub_index;
    int64_t value;
  };
  struct HeartbeatConsumer {
    bool heard = false;  // since it was configured, or since it was missed
    uint64_t heard_ns = 0;
  };

  uint32_t Read(uint16_t index, uint8_t sub_index, std::vector<uint8_t>& bytes) override;
  uint32_t Write(uint16_t index, uint8_t sub_index, std::span<const uint8_t> bytes,
                 bool sized) override;
  uint32_t CheckWrite(const ObjectEntry& entry, size_t bytes, int64_t value, bool sized);
  uint32_t CheckMapping(uint16_t index, uint8_t sub_index, int64_t value) const;
  uint32_t WriteMaker(uint16_t index, uint8_t sub_index, int64_t value);
  uint32_t RefuseGenerally(uint16_t reason);
  void UseWritten(uint16_t index, uint8_t sub_index);
  bool PdoExists(uint16_t communication) const;

  void StepTo(uint64_t now_ns);
  void Step();
  void FinishBoot();
  void WatchCommands();
  void WatchHeartbeats();
  void MoveWheel();
  void Report();
  void Produce();
  void TakeNmt(const CanFrame& frame);
  void TakeSync();
  void TakeSdo(const CanFrame& frame);
  void TakeRpdo(const CanFrame& frame);
  void TakeHeartbeat(uint8_t node, uint64_t now_ns);
  void ApplyRpdo(std::span<const uint8_t> bytes);
  std::vector<uint8_t> TpdoBytes() const;
  void SendTpdo();
  void SendHeartbeat();
  void Send(uint32_t id, std::span<const uint8_t> bytes);
  bool AtRest() const;
  double CommandedMotor_rpm() const;

  DriveSettings settings_;
  DriveFaults faults_;
  ObjectDictionary objects_;
  std::vector<MadeObject> made_;
  SdoServer sdo_;
  PowerStates power_;
  WheelMotor motor_;
  std::vector<CanFrame> outbox_;

  uint64_t now_ns_;
  NmtState nmt_ = NmtState::kInitialising;
  uint64_t boot_done_ns_;
  bool boot_up_message_ = true;
  uint64_t boot_ups_ = 0;
  uint64_t heartbeat_ns_ = 0;  // last sent
  uint64_t sync_ns_ = 0;       // last sent, if it is the producer
  uint64_t tpdo_ns_ = 0;
  std::vector<uint8_t> tpdo_sent_;
  int64_t syncs_ = 0;                // since the last TPDO
  std::vector<uint8_t> rpdo_waits_;  // for SYNC
  bool rpdo_heard_ = false;          // since it became operational
  uint64_t rpdo_ns_ = 0;
  uint32_t rpdos_ = 0;
  bool warning_ = false;  // RPDO time-out of severity 1: zero speed until the next
  std::array<HeartbeatConsumer, 8> consumers_;
  double command_radps_ = 0.0;
  bool has_motor_ = true;
  bool turns_ = false;
  double turned_radps_ = 0.0;  // by the caller
  int32_t reported_rpm_ = 0;
  Emergency emergency_;
  uint32_t emergencies_ = 0;
};

}  // namespace hardpack::sim
