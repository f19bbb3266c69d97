// SPDX-License-Identifier: Apache-2.0
#include "core/speed/brow.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {

void BrowFinder::Begin(Vec2 climb, float max_unseen_m) {
  *this = BrowFinder();
  climb_ = Length(climb);
  max_unseen_m_ = max_unseen_m;
  is_done_ = climb_ <= 0.0f;
  if (!is_done_) uphill_ = {climb.x_m / climb_, climb.y_m / climb_};
}

void BrowFinder::Step(const Costmap& map, const Terrain& terrain, const PathChords& path,
                      const float* aside_m) {
  if (chord_ + 1 >= path.points || path.reversed[chord_]) return End();
  const float begin_m = path.along_m[chord_];
  const float length_m = path.along_m[chord_ + 1] - begin_m;
  on_m_ += kStep_m;
  if (on_m_ >= length_m) {  // and at once where the vehicle turns on the spot
    ++chord_;
    on_m_ = 0.0f;
    return;
  }
  if (begin_m + on_m_ > kReach_m) return End();
  along_m_ = begin_m + on_m_;
  const Vec2 from = {path.x_m[chord_], path.y_m[chord_]};
  const Vec2 direction = {(path.x_m[chord_ + 1] - from.x_m) / length_m,
                          (path.y_m[chord_ + 1] - from.y_m) / length_m};
  HP_LOOP_BOUND(kTracks)
  for (int track = 0; track < kTracks; ++track) {
    const Vec2 place = {from.x_m + on_m_ * direction.x_m - aside_m[track] * direction.y_m,
                        from.y_m + on_m_ * direction.y_m + aside_m[track] * direction.x_m};
    if (!tracks_[track].ends) Look(map, terrain, CellAt(place), tracks_[track]);
  }
}

void BrowFinder::Look(const Costmap& map, const Terrain& terrain, Cell cell, Track& track) {
  if (!map.window.Contains(cell)) return;
  const int index = map.window.Index(cell);
  if ((map.flags[index] & Costmap::kObserved) == 0) return;
  if (along_m_ - track.seen_m > max_unseen_m_) {
    const Terrain::Ground ground = terrain.At(index);
    if (!ground.is_told) return;  // one ring of the lidar, which tells no slope
    const float rises = ground.grade_x * uphill_.x_m + ground.grade_y * uphill_.y_m;
    track.ends = rises > climb_ - kBends;
    if (track.ends) return;
    track.brow = {Min(track.brow.from_m, track.seen_m), along_m_};
  }
  track.seen_m = along_m_;
}

void BrowFinder::End() {
  is_done_ = true;
  HP_LOOP_BOUND(kTracks)
  for (Track& track : tracks_) {
    const bool is_open = !track.ends && along_m_ - track.seen_m >= kLeast_m;
    if (is_open) track.brow = {Min(track.brow.from_m, track.seen_m), Brow::kFar_m};
  }
}

}  // namespace hardpack
