// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/fixed_vector.h"
#include "core/base/saturate.h"
#include "core/base/status.h"

// Areas that a person draws: where the vehicle must not go, what it must not leave, and where it
// must drive slowly. Each is a simple polygon: its border neither touches nor crosses itself. The
// corners may go round either way, and the last is joined to the first. docs/areas.md.
//
// Every number is whole, so all judgements of a polygon as given are exact: corners in odom are in
// millimetres, corners on earth in 1e-9 degree (0.11 mm), like a goal's.

namespace hardpack {

inline constexpr int kMaxAreas = 64;  // configured and the operator's together
inline constexpr int kMinAreaCorners = 3;
inline constexpr int kMaxAreaCorners = 32;
// Of a corner in odom, either way. A float is exact to 8 mm there.
inline constexpr int32_t kMaxAreaPosition_mm = 100'000'000;
constexpr bool IsAreaPosition(int32_t x_mm, int32_t y_mm) {
  return x_mm >= -kMaxAreaPosition_mm && x_mm <= kMaxAreaPosition_mm &&
         y_mm >= -kMaxAreaPosition_mm && y_mm <= kMaxAreaPosition_mm;
}
// To the nearest; saturates.
inline int32_t ToMillimeters(float length_m) {
  return RoundToInt(length_m * 1000.0f);
}
// A smaller polygon is a mistake: less than a cell.
inline constexpr int64_t kMinArea_mm2 = 40'000;
inline constexpr float kMinZoneSpeed_mps = 0.1f;
inline constexpr float kMaxZoneSpeed_mps = 15.0f;

enum class AreaKind : uint8_t {
  kKeepOut = 0,    // the vehicle's outline must not touch it
  kFence = 1,      // the outline must stay inside it; at most one
  kSpeedZone = 2,  // no faster than speed_mps while the outline touches it
};
inline constexpr int kAreaKinds = 3;

enum class AreaFrame : uint8_t {
  kOdom = 0,   // metres in the local frame
  kEarth = 1,  // latitude and longitude, WGS 84: moves in odom with the transform to map
};
inline constexpr int kAreaFrames = 2;

struct AreaCorner {
  // In odom. Of an area on earth: where it lies at present, filled in by AreaSet.
  int32_t x_mm = 0;
  int32_t y_mm = 0;
  int64_t latitude_ndeg = 0;  // kEarth: 1e-9 degree
  int64_t longitude_ndeg = 0;
  constexpr bool operator==(const AreaCorner&) const = default;
};

struct Area {
  AreaKind kind = AreaKind::kKeepOut;
  AreaFrame frame = AreaFrame::kOdom;
  int32_t corners = 0;     // kMinAreaCorners .. kMaxAreaCorners
  float speed_mps = 0.0f;  // kSpeedZone: kMinZoneSpeed_mps .. kMaxZoneSpeed_mps; otherwise 0
  AreaCorner corner[kMaxAreaCorners] = {};  // the first `corners`
};
static_assert(std::is_trivially_copyable_v<Area>);

// Areas as somebody gives them.
using AreaList = FixedVector<Area, kMaxAreas>;

// Whether an area can be used as it is given. The first that applies: kInvalidArgument: an unknown
// kind or frame, fewer than three corners, a corner out of range (in odom beyond
// kMaxAreaPosition_mm; on earth beyond LocalPlane's latitudes and longitudes, or more than
// LocalPlane::kMaxRange_m from the first corner), a speed out of range, or one on an area that is
// no speed zone; kCapacityExceeded: too many corners; kNotFinite: the speed; kAreaNotSimple;
// kAreaTooSmall. A polygon on earth is judged in the plane that touches the earth at its first
// corner, to a millimetre. Cost: at most 496 pairs of edges.
Status CheckArea(const Area& area);

// The same for all areas of a list; also kSecondFence.
Status CheckAreas(const AreaList& areas);

}  // namespace hardpack
