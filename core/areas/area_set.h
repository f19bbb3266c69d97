// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/areas/area.h"
#include "core/areas/area_shape.h"
#include "core/base/footprint.h"
#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/odometry/map_from_odom.h"

// All areas in force, with their places in odom: first the configured ones, which stay, then the
// operator's, which arrive one at a time and are replaced and cleared together. The operator's set
// is complete once as many have arrived as were announced. Until then, and while an area on earth
// has no place in odom, is_known() is false, and the vehicle must not drive: what is not known
// cannot be kept to.
//
// An area on earth follows the transform from odom to map, also while that is only held
// (MapFromOdom). If the transform is lost, the area keeps its last place, which still closes cells,
// but it does not count as known before there is a transform again.

namespace hardpack {

class AreaSet {
 public:
  // An area on earth stays where it is in odom until a corner would move by more than this: each
  // move may open and close cells at its border.
  static constexpr int32_t kFollows_mm = 50;

  // Only the configured areas. The statuses of CheckAreas; on failure there are none.
  Status Configure(const AreaList& configured);

  // The operator's area number `index` of `count`, from 0. 0 drops the operator's previous areas
  // first, even if it is then refused itself; every other must follow the one before it. The
  // statuses of CheckArea; kInvalidArgument: out of order, or another count; kCapacityExceeded:
  // count and the configured areas are more than kMaxAreas; kSecondFence. On failure nothing is
  // added, so the set remains incomplete. Cost: CheckArea.
  Status Take(int index, int count, const Area& area);

  // Drops the operator's areas. The configured ones stay.
  void Clear();

  // Once a tick: places one area on earth, each in turn. Constant cost.
  void Advance(const MapFromOdom& map_from_odom);

  int size() const { return areas_.size(); }
  bool empty() const { return areas_.empty(); }
  int configured() const { return configured_; }
  // Precondition: 0 <= index < size().
  const Area& operator[](int index) const { return areas_[index]; }
  // Whether it has a place in odom, if only an old one: else it cannot be drawn.
  bool HasPlace(int index) const { return place_[index] != Place::kNone; }
  // The operator's set is complete, and every area has a place that is up to date.
  bool is_known() const { return is_known_; }
  int expected() const { return expected_; }  // of the operator, announced

  // The first area that the outline breaches; -1: none. Areas without a place do not count. Cost:
  // one pass over the corners of the areas whose boxes are near.
  int BreachedBy(const Footprint& footprint, const Pose2& pose) const;

  // Whether a goal may be there: in no keep-out area and inside the fence, as far as they have a
  // place. Precondition: finite. Cost: one pass over all corners.
  bool Permits(Vec2 place_odom) const;

  // Whether an area is a speed zone that the outline touches; see IsTouched. Precondition: 0 <=
  // index < size().
  bool IsInZone(int index, const Footprint& footprint, const Pose2& pose, float ends_m,
                float flanks_m) const;

 private:
  enum class Place : uint8_t { kNone, kOld, kPresent };
  struct Box {
    int32_t low_x_mm = 0;
    int32_t low_y_mm = 0;
    int32_t high_x_mm = 0;
    int32_t high_y_mm = 0;
  };

  bool HasFence() const;
  void Append(const Area& area);
  void FindBox(int index);
  void PlaceOnEarth(int index, const MapFromOdom& map_from_odom);
  bool IsNear(int index, const Pose2& pose, float reach_m) const;
  void Judge();

  AreaList areas_;
  Box box_[kMaxAreas] = {};
  Place place_[kMaxAreas] = {};
  int32_t configured_ = 0;
  int32_t expected_ = 0;
  int32_t next_ = 0;  // to be placed
  bool is_known_ = true;
};
static_assert(std::is_trivially_copyable_v<AreaSet>);
static_assert(sizeof(AreaSet) <= 52 * 1024);

}  // namespace hardpack
