// SPDX-License-Identifier: Apache-2.0
#include "core/people/people_tracks.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/units.h"

namespace hardpack {
namespace {

float Squared(float value) {
  return value * value;
}

float Distance2(Vec2 a, Vec2 b) {
  return Squared(a.x_m - b.x_m) + Squared(a.y_m - b.y_m);
}

}  // namespace

void PeopleTracks::Reset() {
  tracks_.Clear();
  next_ = 0;
}

// The nearest followed track whose gate the place is in; -1: none.
int PeopleTracks::TrackOf(Vec2 place_odom, uint64_t now_ns) const {
  int nearest = -1;
  float nearest_m2 = 0.0f;
  HP_LOOP_BOUND(kMost)
  for (int k = 0; k < tracks_.size(); ++k) {
    const Track& track = tracks_[k];
    if (!IsFollowed(track, now_ns)) continue;
    const float gate_m = kBody_m + kFastest_mps * SecondsBetween(track.seen_ns, now_ns);
    const float off_m2 = Distance2(track.place_odom, place_odom);
    const bool is_nearer = nearest < 0 || off_m2 < nearest_m2;
    if (off_m2 > Squared(gate_m) || !is_nearer) continue;
    nearest = k;
    nearest_m2 = off_m2;
  }
  return nearest;
}

// If there are too many, in the place of the one that has not been seen for longest.
void PeopleTracks::Begin(Vec2 place_odom, uint64_t now_ns) {
  int free = -1;
  HP_LOOP_BOUND(kMost)
  for (int k = 0; k < tracks_.size(); ++k) {
    if (IsFollowed(tracks_[k], now_ns)) continue;
    const bool is_less_sure = free >= 0 && tracks_[k].passes < tracks_[free].passes;
    const bool is_longer = free >= 0 && tracks_[k].passes == tracks_[free].passes &&
                           tracks_[k].seen_ns < tracks_[free].seen_ns;
    if (free < 0 || is_less_sure || is_longer) free = k;
  }
  const bool is_spare = free >= 0 && tracks_[free].passes < kSurePasses;
  if (!is_spare && !tracks_.full()) {
    free = tracks_.size();
    tracks_.Resize(free + 1);
  }
  if (free < 0) return;
  Track& track = tracks_[free];
  track.place_odom = place_odom;
  track.returns = 1;
  track.passes = 1;
  track.seen_ns = now_ns;
  track.places.Clear();
  Note(free, now_ns);
}

// Where a track is now, unless it might be somebody else's. Those that do not fit are not released.
void PeopleTracks::Note(int k, uint64_t now_ns) {
  Track& track = tracks_[k];
  if (!IsApart(k, track.place_odom, now_ns)) return KeepLeft(track);
  const bool is_new = track.places.empty() ||
                      Distance2(track.places.back(), track.place_odom) >= Squared(kPlacesApart_m);
  if (is_new) static_cast<void>(track.places.PushBack(track.place_odom));
}

// Of its places those that it has left by now.
void PeopleTracks::KeepLeft(Track& track) {
  int kept = 0;
  HP_LOOP_BOUND(kMostPlaces)
  for (const Vec2& place : track.places) {
    if (Distance2(place, track.place_odom) >= Squared(kLeft_m)) track.places[kept++] = place;
  }
  track.places.Resize(kept);
}

void PeopleTracks::Look(Vec2 place_odom, uint64_t now_ns) {
  if (!IsFinite(place_odom)) return;
  const int k = TrackOf(place_odom, now_ns);
  if (k < 0) return Begin(place_odom, now_ns);
  Track& track = tracks_[k];
  const bool is_next_pass = now_ns - track.seen_ns > kPass_ns;
  track.returns = is_next_pass ? 1 : track.returns + 1;
  if (is_next_pass && track.passes < kSurePasses) ++track.passes;
  const bool is_alone =
      is_next_pass || Distance2(track.place_odom, place_odom) <= Squared(kAlone_m);
  const float share = 1.0f / static_cast<float>(track.returns);
  track.place_odom = {track.place_odom.x_m + share * (place_odom.x_m - track.place_odom.x_m),
                      track.place_odom.y_m + share * (place_odom.y_m - track.place_odom.y_m)};
  track.seen_ns = now_ns;
  if (!is_alone) return track.places.Clear();
  Note(k, now_ns);
}

// Whether no other track that counts is beside a place.
bool PeopleTracks::IsApart(int track, Vec2 place_odom, uint64_t now_ns) const {
  HP_LOOP_BOUND(kMost)
  for (int k = 0; k < tracks_.size(); ++k) {
    const bool is_beside = Distance2(tracks_[k].place_odom, place_odom) < Squared(kBeside_m);
    const bool counts = tracks_[k].passes >= kSurePasses || IsFollowed(tracks_[k], now_ns);
    if (k != track && is_beside && counts) return false;
  }
  return true;
}

bool PeopleTracks::TakeLeft(uint64_t now_ns, Vec2& place_odom) {
  if (tracks_.empty()) return false;
  next_ = next_ + 1 < tracks_.size() ? next_ + 1 : 0;
  Track& track = tracks_[next_];
  if (!IsFollowed(track, now_ns)) return false;
  HP_LOOP_BOUND(kMostPlaces)
  for (int k = 0; k < track.places.size(); ++k) {
    const bool is_left = Distance2(track.places[k], track.place_odom) >= Squared(kLeft_m);
    if (!is_left || !IsApart(next_, track.places[k], now_ns)) continue;
    place_odom = track.places[k];
    HP_LOOP_BOUND(kMostPlaces)
    for (; k + 1 < track.places.size(); ++k) track.places[k] = track.places[k + 1];
    track.places.Resize(track.places.size() - 1);
    return true;
  }
  return false;
}

}  // namespace hardpack
