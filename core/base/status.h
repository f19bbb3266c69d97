// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace hardpack {

// How an operation ended. One list for the whole library, so that a status keeps its meaning (and
// its name in logs and in plan.json) on its way from the codec to the operator. Codes at or above
// kFirstFailure mean that the operation gave no usable result. Lower codes are outcomes with a
// usable result, which the caller may still have to treat differently.
enum class [[nodiscard]] Status : uint8_t{
    kOk = 0,  // Done as requested.

    // Usable results that differ from the request.
    kGoalOutsideMap,   // The goal is off the map; the nearest cell of the map was used.
    kGoalMoved,        // The goal is in a hard obstacle; the nearest free cell was used.
    kStartInObstacle,  // The start is in a hard obstacle; left along falling depth. Drive slowly.
    kPartialPath,      // The expansion limit was hit; the path ends at the best cell seen.
    kPathCut,          // The path exceeded the capacity and was cut there.
    kIterationLimit,   // The optimizer reached its sweep limit before it converged.
    kNarrowGap,        // Little room beside the outline; drive at v_min there.
    kLimitExceeded,    // A curvature or curvature-rate limit is exceeded. Free of hard obstacles,
                       // except those that the start is in.
    kClockJumped,      // A device's clock jumped against ours; the new offset is used from now on.
    kOffPath,          // Too far from the path to follow it; the vehicle is being brought to rest.

    // Failures: there is no result.
    kFirstFailure = 32,
    kNotStarted = kFirstFailure,  // Begin() has not been called, or it failed.
    kInvalidArgument,             // An argument is out of its stated range.
    kNotFinite,                   // A number that must be finite is NaN or infinite.
    kParameterOutOfRange,         // A parameter is outside the range its table gives.
    kCapacityExceeded,  // The input does not fit the fixed capacity; nothing was truncated.
    kNoPath,            // Every way to the goal is blocked.
    kStartOutsideMap,   // The start is off the map.
    kStartEnclosed,     // The start is in a hard obstacle and no falling depth leads out.
    kGoalInObstacle,    // The goal is in a hard obstacle, and moving it is not permitted.
    kPivotBlocked,      // A turn on the spot is needed, but its circle is not free or the vehicle
                        // moves.
    kCollision,         // The checked path touches a hard obstacle.
    kPathTooShort,      // Fewer points than the operation needs.

    // Bytes from outside.
    kTruncated,        // Fewer bytes than the format needs.
    kOversized,        // More bytes than the format allows.
    kWrongPacketType,  // The packet says it is of another type.
    kWrongSensor,      // The packet's identity is not the configured sensor's.
    kBadColumn,        // A column or measurement id is outside the sensor's range.
    kColumnInvalid,    // The sensor marked the column as invalid.
    kUnsupported,      // A profile or format that is known but not handled.
    kBadCrc,           // The checksum does not match.
    kDuplicate,        // The column or packet was already received.
    kLate,             // It arrived too late to be used.
    kSensorRestarted,  // The sensor's counters restarted: its state must be set up again.
    kNoPose,           // The vehicle's pose at that time is not known.

    // Buses, sockets and devices.
    kEmpty,          // Nothing is available now.
    kExpired,        // Its deadline passed before it could be sent; it was dropped.
    kInterfaceDown,  // The network interface is down or gone.
    kBusOff,         // The CAN controller has cut itself off from the bus.
    kNotPermitted,   // The caller or the present mode does not permit it.
    kSystemError,    // The operating system refused, for a reason not listed here.
    kWrongSender,    // The sender's address is not the configured one.
    kTimedOut,       // The answer did not arrive in time.
    kAborted,        // The device refused, and said so.
    kDeviceFault,    // The device reports a fault, or acts against its commands.
    kWrongDevice,    // The device differs from the one in the configuration.
    kStale,          // The data it depends on are too old.

    // Planning, for a vehicle that cannot turn on the spot.
    kNeedsManoeuvre,  // The path bends more sharply than the vehicle can, or needs a turn on the
                      // spot.

    // Areas that a person draws.
    kAreaNotSimple,  // The polygon's border touches or crosses itself.
    kAreaTooSmall,   // The polygon is smaller than a cell of the map.
    kSecondFence,    // There is a fence already.
    kGoalForbidden,  // The goal is in a keep-out area or not inside the fence.
};

// True when there is a result to use (possibly not quite the one asked for).
constexpr bool IsUsable(Status status) {
  return status < Status::kFirstFailure;
}

// The more severe of two related outcomes; statuses are numbered by severity.
constexpr Status Graver(Status a, Status b) {
  return a < b ? b : a;
}

// The code's name in snake_case, as written to plan.json; "unknown" for a value outside the list.
const char* StatusName(Status status);

}  // namespace hardpack
