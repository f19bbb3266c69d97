// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/status.h"
#include "hal/can_frame.h"

// One CAN interface, as the owner of the tick sees it. No call blocks. The calls of a tick are
//   Advance(now), Receive until kEmpty (at most kMaxFramesPerTick), ..., Send, Send, ...
// An implementation holds what it cannot hand on yet, for as long as each frame's deadline lets it:
// a command that is late is worse than none, so nothing old is ever sent when a broken bus comes
// back. test/hal/conformance holds every implementation to this page.

namespace hardpack {

enum class CanBusState : uint8_t {
  kDown = 0,  // no interface, or it is down: nothing can be sent
  kActive,    // error active: the usual
  kWarning,   // error active, a counter above 96
  kPassive,   // error passive
  kBusOff,    // cut off; recovery is under way where it is permitted
};
inline constexpr int kCanBusStates = 5;
constexpr bool IsUp(CanBusState state) {
  return state == CanBusState::kActive || state == CanBusState::kWarning ||
         state == CanBusState::kPassive;
}

struct CanBusCounters {
  uint64_t accepted = 0;   // Sends that gave kOk
  uint64_t confirmed = 0;  // of these, seen on the bus (own echoes)
  uint64_t expired = 0;    // accepted, dropped since: their deadline passed before they could go
  uint64_t refused = 0;    // Sends that gave anything else
  uint64_t received = 0;   // frames of others given by Receive
  uint64_t malformed = 0;  // frames no bus can carry, FD frames among them: not given
  uint64_t lost = 0;       // frames of others that were lost for want of room
  uint64_t error_frames = 0;
  uint64_t bus_offs = 0;
  uint64_t restarts = 0;  // of the interface, by us: after bus-off, or to drop what had grown old
  uint64_t went_down = 0;
  uint64_t system_errors = 0;  // refusals of the operating system that are none of these
};

class CanBus {
 public:
  // What a bus may hand over, and take, in one tick.
  static constexpr int kMaxFramesPerTick = 128;
  // Frames handed to the controller and not seen on the bus yet; the next waits.
  static constexpr int kMaxUnconfirmed = 16;
  // Frames that wait for that.
  static constexpr int kMaxWaiting = 64;

  // Takes note of the time (monotonic, never backwards): drops what has expired, sends what waits,
  // watches the interface, recovers from bus-off. Once a tick, before the others.
  virtual void Advance(uint64_t now_ns) = 0;

  // Hands over a frame that is to be on the bus before deadline_ns, in the order of the calls. kOk:
  // it is, or it waits; kExpired: deadline_ns is not after the last Advance's now;
  // kInvalidArgument: no frame that a bus can carry; kCapacityExceeded: kMaxWaiting frames wait;
  // kInterfaceDown, kBusOff: nothing is accepted until the bus is back; kSystemError.
  virtual Status Send(const CanFrame& frame, uint64_t deadline_ns) = 0;

  // The next frame of another node, in the order of the bus, with the time at which it came where
  // the implementation knows it. What is more than kMaxFramesPerTick waits for the next Advance,
  // and keeps that time: who takes it sees that it is old. Own frames are not given; a frame that
  // another node sends with one of our identifiers is. kEmpty: none is there, `frame` is untouched.
  virtual Status Receive(CanFrame& frame) = 0;

  // As of the last call of any of these.
  virtual CanBusState state() const = 0;
  virtual const CanBusCounters& counters() const = 0;

 protected:
  ~CanBus() = default;
};

}  // namespace hardpack
