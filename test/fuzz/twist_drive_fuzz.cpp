// SPDX-License-Identifier: Apache-2.0
// Any frames and demands, in ticks, as the bus of a motion controller. The first byte chooses the
// parameters; each of the others is one step: a frame made of the bytes behind it (its checksum put
// right, mostly), what is demanded, or a tick. Required: one command a tick, well formed; no speed
// unless the controller says that it follows and motion is demanded; no steering beyond the
// vehicle's; and a frame that is taken is encoded to the same bytes.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "core/kinematics/kinematics.h"
#include "hal/twist_drive/twist_drive.h"
#include "test/fuzz/accepted.h"

using namespace hardpack;
using namespace hardpack::twist_drive;

namespace {

void Require(bool condition) {
  if (!condition) std::abort();
}

struct Input {
  const uint8_t* data;
  size_t size;
  uint8_t Next() {
    if (size == 0) return 0;
    --size;
    return *data++;
  }
};

CanFrame AnyFrame(Input& input) {
  constexpr uint32_t kIds[] = {0x211, 0x212, 0x210, 0x213};
  CanFrame frame;
  const uint8_t head = input.Next();
  frame.id = kIds[head % 4];
  frame.size = head < 0xf0 ? uint8_t{8} : uint8_t(head % 9);
  frame.extended = head == 0xef;
  frame.remote = head == 0xee;
  for (int i = 0; i < frame.size; ++i) frame.data[i] = input.Next();
  const bool is_right = head < 0xe0 && frame.size == 8;
  if (is_right) frame.data[7] = CrcOf(frame);
  return frame;
}

void RequireRoundTrip(const CanFrame& frame) {
  Feedback feedback;
  if (frame.id == 0x211 && IsUsable(Decode(frame, feedback))) {
    Accepted("feedback");
    Require(Encode(frame.id, feedback) == frame);
  }
  ControllerStatus status;
  if (frame.id == 0x212 && IsUsable(Decode(frame, status))) {
    Require(Encode(frame.id, status) == frame);
  }
}

void RequireSound(const VehicleParams& vehicle, const TwistDriveParams& params,
                  const TwistDrive& drive, const DriveDemand& demand, const CanBatch& out) {
  Command command;
  Require(out.size() == 1 && IsUsable(Decode(out[0], command)));
  const bool follows = drive.report().state == ControllerState::kFollowing;
  const bool may_move = follows && demand.enable && drive.report().fault == Fault::kNone;
  Require(may_move || command.speed == 0);
  if (command.speed != 0) Accepted("driven");
  if (params.turn == TwistDriveParams::kSteering) {
    Require(std::abs(static_cast<float>(command.turn)) <=
            vehicle.max_steering_rad * kPerSteering + 1.0f);
  } else if (!CanPivot(vehicle)) {
    const float most =
        MostCurvature(vehicle) * (std::abs(static_cast<float>(command.speed)) + 1.0f);
    Require(std::abs(static_cast<float>(command.turn)) <= most + 1.0f);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Input input{data, size};
  VehicleParams vehicle;
  TwistDriveParams params;
  const uint8_t setup = input.Next();
  vehicle.kinematics = setup & 1;
  params.turn = (setup & 3) == 3 ? TwistDriveParams::kSteering : TwistDriveParams::kYawRate;
  TwistDrive drive;
  Require(IsUsable(drive.Configure(vehicle, params)));
  DriveDemand demand;
  CanBatch out;
  uint64_t now_ns = 1'000'000'000;
  while (input.size > 0) {
    const uint8_t step = input.Next();
    if (step < 0x60) {
      CanFrame frame = AnyFrame(input);
      if (step % 4 == 3) frame.received_ns = now_ns - uint64_t{step} * 4'000'000;
      RequireRoundTrip(frame);
      drive.TakeFrame(frame, now_ns);
    } else if (step < 0x80) {
      demand = {(step & 1) != 0,
                (step & 2) != 0,
                {0.2f * static_cast<float>(static_cast<int8_t>(input.Next())),
                 0.2f * static_cast<float>(static_cast<int8_t>(input.Next()))}};
      if (step == 0x7f) demand.wheels.left_radps = NAN;
    } else {
      now_ns += uint64_t{step & 0x7fu} * 1'000'000;
      out.Clear();
      drive.Tick(now_ns, demand, out);
      RequireSound(vehicle, params, drive, demand, out);
      const DriveFeedback state = drive.State(now_ns);
      Require(!(state.enabled && !state.ready) && !(state.ready && state.faulty));
      Require(std::isfinite(state.wheels.left_radps) && std::isfinite(state.wheels.right_radps));
      static_cast<void>(drive.AreOff(now_ns));
    }
  }
  return 0;
}
