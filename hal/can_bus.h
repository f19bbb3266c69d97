// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/status.h"
#include "hal/can_frame.h"

// One CAN interface, as seen by the owner of the tick. No call blocks. The calls of a tick are
//   Advance(now), Receive until kEmpty (at most kMaxFramesPerTick), ..., Send, Send, ...
// An implementation holds frames that it cannot pass on yet until their deadline: a late command is
// worse than none, so nothing old is ever sent when a broken bus comes back. test/hal/conformance
// tests every implementation against this page.

namespace hardpack {

enum class CanBusState : uint8_t {
  kDown = 0,  // no interface, or it is down: nothing can be sent
  kActive,    // error active: normal
  kWarning,   // error active, a counter above 96
  kPassive,   // error passive
  kBusOff,    // cut off; recovery is in progress if permitted
};
inline constexpr int kCanBusStates = 5;
constexpr bool IsUp(CanBusState state) {
  return state == CanBusState::kActive || state == CanBusState::kWarning ||
         state == CanBusState::kPassive;
}

struct CanBusCounters {
  uint64_t accepted = 0;   // Sends that returned kOk
  uint64_t confirmed = 0;  // of these, seen on the bus (own echoes)
  uint64_t expired = 0;    // accepted, then dropped: deadline passed before they could be sent
  uint64_t refused = 0;    // Sends that returned anything else
  uint64_t received = 0;   // frames of others returned by Receive
  uint64_t malformed = 0;  // frames no bus can carry, including FD frames: not returned
  uint64_t lost = 0;       // frames of others lost for lack of space
  uint64_t error_frames = 0;
  uint64_t bus_offs = 0;
  uint64_t restarts = 0;  // of the interface, by us: after bus-off, or to drop old frames
  uint64_t went_down = 0;
  uint64_t system_errors = 0;  // other refusals of the operating system
};

class CanBus {
 public:
  // What a bus may deliver, and accept, in one tick.
  static constexpr int kMaxFramesPerTick = 128;
  // Most frames handed to the controller and not yet seen on the bus; the next one waits.
  static constexpr int kMaxUnconfirmed = 16;
  // Most frames waiting for that.
  static constexpr int kMaxWaiting = 64;

  // Updates the time (monotonic, never backwards): drops expired frames, sends waiting ones,
  // watches the interface, recovers from bus-off. Once a tick, before the others.
  virtual void Advance(uint64_t now_ns) = 0;

  // Hands over a frame that must be on the bus before deadline_ns, in the order of the calls. kOk:
  // it is, or it waits; kExpired: deadline_ns is not after the last Advance's now;
  // kInvalidArgument: not a frame that a bus can carry; kCapacityExceeded: kMaxWaiting frames are
  // waiting; kInterfaceDown, kBusOff: nothing is accepted until the bus is back; kSystemError.
  virtual Status Send(const CanFrame& frame, uint64_t deadline_ns) = 0;

  // The next frame of another node, in bus order, with its time of arrival if the implementation
  // knows it. Frames beyond kMaxFramesPerTick wait for the next Advance, and keep that time, so the
  // reader sees that they are old. Our own frames are not returned; a frame that another node sends
  // with one of our identifiers is. kEmpty: none; `frame` is unchanged.
  virtual Status Receive(CanFrame& frame) = 0;

  // As of the last call of any of these.
  virtual CanBusState state() const = 0;
  virtual const CanBusCounters& counters() const = 0;

 protected:
  ~CanBus() = default;
};

}  // namespace hardpack
