// SPDX-License-Identifier: Apache-2.0
#include "core/areas/area_set.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {
namespace {

// More than the margin of any test of an area.
constexpr float kBeyond_m = 1.0f;

int32_t Smaller(int32_t a, int32_t b) {
  return b < a ? b : a;
}
int32_t Larger(int32_t a, int32_t b) {
  return a < b ? b : a;
}

// Both are within +-kMaxAreaPosition_mm.
int32_t Apart(int32_t a, int32_t b) {
  return a < b ? b - a : a - b;
}

}  // namespace

Status AreaSet::Configure(const AreaList& configured) {
  areas_.Clear();
  configured_ = 0;
  expected_ = 0;
  next_ = 0;
  const Status status = CheckAreas(configured);
  if (IsUsable(status)) {
    HP_LOOP_BOUND(kMaxAreas)
    for (const Area& area : configured) Append(area);
    configured_ = areas_.size();
  }
  Judge();
  return status;
}

Status AreaSet::Take(int index, int count, const Area& area) {
  if (index == 0) {
    Clear();
    if (count < 1 || count > kMaxAreas) return Status::kInvalidArgument;
    expected_ = count;
    Judge();
  }
  const bool follows = index == areas_.size() - configured_ && index < expected_;
  if (!follows || count != expected_) return Status::kInvalidArgument;
  if (configured_ + count > kMaxAreas) return Status::kCapacityExceeded;
  const Status status = CheckArea(area);
  if (!IsUsable(status)) return status;
  if (area.kind == AreaKind::kFence && HasFence()) return Status::kSecondFence;
  Append(area);
  Judge();
  return Status::kOk;
}

void AreaSet::Clear() {
  areas_.Resize(configured_);
  expected_ = 0;
  Judge();
}

// Not inlined: within Configure's loop the full list becomes a second way into it, and such a loop
// has no static bound.
[[gnu::noinline]] void AreaSet::Append(const Area& area) {
  const int index = areas_.size();
  if (!IsUsable(areas_.PushBack(area))) return;
  place_[index] = area.frame == AreaFrame::kOdom ? Place::kPresent : Place::kNone;
  FindBox(index);
}

bool AreaSet::HasFence() const {
  bool has_fence = false;
  HP_LOOP_BOUND(kMaxAreas)
  for (const Area& area : areas_) has_fence = has_fence || area.kind == AreaKind::kFence;
  return has_fence;
}

void AreaSet::FindBox(int index) {
  const Area& area = areas_[index];
  Box box = {INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN};
  HP_LOOP_BOUND(kMaxAreaCorners)
  for (int i = 0; i < area.corners; ++i) {
    const AreaCorner& corner = area.corner[i];
    box = {Smaller(box.low_x_mm, corner.x_mm), Smaller(box.low_y_mm, corner.y_mm),
           Larger(box.high_x_mm, corner.x_mm), Larger(box.high_y_mm, corner.y_mm)};
  }
  box_[index] = box;
}

void AreaSet::Judge() {
  is_known_ = areas_.size() - configured_ == expected_;
  HP_LOOP_BOUND(kMaxAreas)
  for (int i = 0; i < areas_.size(); ++i) is_known_ = is_known_ && place_[i] == Place::kPresent;
}

void AreaSet::Advance(const MapFromOdom& map_from_odom) {
  if (areas_.empty()) return;
  const bool has_transform = map_from_odom.has_transform();
  HP_LOOP_BOUND(kMaxAreas)
  for (int i = 0; i < areas_.size() && !has_transform; ++i) {
    const bool is_lost = areas_[i].frame == AreaFrame::kEarth && place_[i] == Place::kPresent;
    if (is_lost) place_[i] = Place::kOld;
  }
  next_ = next_ + 1 < areas_.size() ? next_ + 1 : 0;
  if (has_transform && areas_[next_].frame == AreaFrame::kEarth) PlaceOnEarth(next_, map_from_odom);
  Judge();
}

// All of its corners, or none: a polygon keeps its shape.
void AreaSet::PlaceOnEarth(int index, const MapFromOdom& map_from_odom) {
  Area& area = areas_[index];
  int32_t x_mm[kMaxAreaCorners] = {};
  int32_t y_mm[kMaxAreaCorners] = {};
  bool moves = place_[index] == Place::kNone;
  HP_LOOP_BOUND(kMaxAreaCorners)
  for (int i = 0; i < area.corners; ++i) {
    const AreaCorner& corner = area.corner[i];
    Vec2 place_odom;
    const Status status =
        map_from_odom.ToOdom(corner.latitude_ndeg, corner.longitude_ndeg, place_odom);
    x_mm[i] = ToMillimeters(place_odom.x_m);
    y_mm[i] = ToMillimeters(place_odom.y_m);
    if (!IsUsable(status) || !IsAreaPosition(x_mm[i], y_mm[i])) {
      if (place_[index] == Place::kPresent) place_[index] = Place::kOld;
      return;
    }
    moves = moves || Apart(x_mm[i], corner.x_mm) > kFollows_mm ||
            Apart(y_mm[i], corner.y_mm) > kFollows_mm;
  }
  place_[index] = Place::kPresent;
  if (!moves) return;
  HP_LOOP_BOUND(kMaxAreaCorners)
  for (int i = 0; i < area.corners; ++i) {
    area.corner[i].x_mm = x_mm[i];
    area.corner[i].y_mm = y_mm[i];
  }
  FindBox(index);
}

// Whether the area's box reaches to within reach_m of the pose.
bool AreaSet::IsNear(int index, const Pose2& pose, float reach_m) const {
  const Box& box = box_[index];
  const int64_t x_mm = ToMillimeters(pose.x_m);
  const int64_t y_mm = ToMillimeters(pose.y_m);
  const int64_t reach_mm = ToMillimeters(reach_m + kBeyond_m);
  return box.low_x_mm - reach_mm <= x_mm && x_mm <= box.high_x_mm + reach_mm &&
         box.low_y_mm - reach_mm <= y_mm && y_mm <= box.high_y_mm + reach_mm;
}

int AreaSet::BreachedBy(const Footprint& footprint, const Pose2& pose) const {
  HP_LOOP_BOUND(kMaxAreas)
  for (int i = 0; i < areas_.size(); ++i) {
    const Area& area = areas_[i];
    if (!HasPlace(i) || area.kind == AreaKind::kSpeedZone) continue;
    // What is far from a fence is outside it.
    if (!IsNear(i, pose, footprint.pivot_radius_m)) {
      if (area.kind == AreaKind::kFence) return i;
      continue;
    }
    if (IsBreached(area, footprint, pose)) return i;
  }
  return -1;
}

bool AreaSet::Permits(Vec2 place_odom) const {
  HP_LOOP_BOUND(kMaxAreas)
  for (int i = 0; i < areas_.size(); ++i) {
    if (HasPlace(i) && Forbids(areas_[i], place_odom)) return false;
  }
  return true;
}

bool AreaSet::IsInZone(int index, const Footprint& footprint, const Pose2& pose, float ends_m,
                       float flanks_m) const {
  const Area& area = areas_[index];
  return area.kind == AreaKind::kSpeedZone && HasPlace(index) &&
         IsNear(index, pose, footprint.pivot_radius_m + ends_m + flanks_m) &&
         IsTouched(area, footprint, pose, ends_m, flanks_m);
}

}  // namespace hardpack
