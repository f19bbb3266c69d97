// SPDX-License-Identifier: Apache-2.0
#include "core/people/people_tracks.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/units.h"

namespace hardpack {
namespace {

float Distance2(Vec2 a, Vec2 b) {
  return Squared(a.x_m - b.x_m) + Squared(a.y_m - b.y_m);
}

}  // namespace

void PeopleTracks::Reset() {
  tracks_.Clear();
  next_ = 0;
  lost_ = 0;
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
void PeopleTracks::Begin(Vec2 place_odom, uint64_t now_ns, uint64_t measured_ns) {
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
  Find(place_odom, now_ns);
  Track& track = tracks_[free];
  track.place_odom = place_odom;
  track.returns = 1;
  track.passes = 1;
  track.is_alone = true;
  track.is_found = false;
  track.seen_ns = now_ns;
  track.measured_ns = measured_ns;
  track.motion = Motion{};
  track.places.Clear();
  Note(free, now_ns);
}

// Of those out of sight the nearest who could have walked here: it may be them.
void PeopleTracks::Find(Vec2 place_odom, uint64_t now_ns) {
  int nearest = -1;
  float nearest_m2 = 0.0f;
  HP_LOOP_BOUND(kMost)
  for (int k = 0; k < tracks_.size(); ++k) {
    const Track& track = tracks_[k];
    const uint64_t unseen_ns = now_ns - track.seen_ns;
    if (IsFollowed(track, now_ns) || track.is_found || unseen_ns > kFound_ns) continue;
    const float gate_m = kBody_m + kFoundWalk_mps * SecondsBetween(track.seen_ns, now_ns);
    const float off_m2 = Distance2(track.place_odom, place_odom);
    if (off_m2 > Squared(gate_m) || (nearest >= 0 && off_m2 >= nearest_m2)) continue;
    nearest = k;
    nearest_m2 = off_m2;
  }
  if (nearest >= 0) tracks_[nearest].is_found = true;
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

void PeopleTracks::Look(Vec2 place_odom, uint64_t now_ns, uint64_t measured_ns) {
  if (!IsFinite(place_odom)) return;
  const int k = TrackOf(place_odom, now_ns);
  if (k < 0) return Begin(place_odom, now_ns, measured_ns);
  Track& track = tracks_[k];
  const bool is_next_pass = now_ns - track.seen_ns > kPass_ns;
  if (is_next_pass) Measure(track.place_odom, track.measured_ns, track.motion);
  track.returns = is_next_pass ? 1 : track.returns + 1;
  if (is_next_pass && track.passes < kKnownPasses) ++track.passes;
  const bool is_alone =
      is_next_pass || Distance2(track.place_odom, place_odom) <= Squared(kAlone_m);
  track.is_alone = is_alone && (is_next_pass || track.is_alone);
  const float share = 1.0f / static_cast<float>(track.returns);
  track.place_odom = {track.place_odom.x_m + share * (place_odom.x_m - track.place_odom.x_m),
                      track.place_odom.y_m + share * (place_odom.y_m - track.place_odom.y_m)};
  track.seen_ns = now_ns;
  track.measured_ns = measured_ns;
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

// A step of the filter: to the time of the measurement, and by it.
void PeopleTracks::Measure(Vec2 place_odom, uint64_t time_ns, Motion& motion) {
  constexpr float kPlace_m2 = kPlaceSigma_m * kPlaceSigma_m;
  if (motion.time_ns != 0 && time_ns <= motion.time_ns) return;
  if (motion.time_ns == 0) {
    motion = {.place_odom = place_odom,
              .velocity_mps = {},
              .time_ns = time_ns,
              .place_m2 = kPlace_m2,
              .both_m2ps = 0.0f,
              .velocity_m2ps2 = kFirstSigma_mps * kFirstSigma_mps};
    return;
  }
  const float s = SecondsBetween(motion.time_ns, time_ns);
  const Vec2 v = motion.velocity_mps;
  const float place_m2 = motion.place_m2 + 2.0f * s * motion.both_m2ps +
                         s * s * motion.velocity_m2ps2 + kWhim_m2ps3 * s * s * s / 3.0f;
  const float both_m2ps = motion.both_m2ps + s * motion.velocity_m2ps2 + 0.5f * kWhim_m2ps3 * s * s;
  const float velocity_m2ps2 = motion.velocity_m2ps2 + kWhim_m2ps3 * s;
  const Vec2 expected = {motion.place_odom.x_m + s * v.x_m, motion.place_odom.y_m + s * v.y_m};
  const Vec2 off = {place_odom.x_m - expected.x_m, place_odom.y_m - expected.y_m};
  const float of_place = place_m2 / (place_m2 + kPlace_m2);
  const float of_velocity = both_m2ps / (place_m2 + kPlace_m2);
  motion = {
      .place_odom = {expected.x_m + of_place * off.x_m, expected.y_m + of_place * off.y_m},
      .velocity_mps = {v.x_m + of_velocity * off.x_m, v.y_m + of_velocity * off.y_m},
      .time_ns = time_ns,
      .place_m2 = (1.0f - of_place) * place_m2,
      .both_m2ps = (1.0f - of_place) * both_m2ps,
      .velocity_m2ps2 = velocity_m2ps2 - of_velocity * both_m2ps,
  };
}

bool PeopleTracks::IsKnown(int track, uint64_t now_ns) const {
  const Track& own = tracks_[track];
  bool is_known = IsFollowed(own, now_ns) && own.passes >= kKnownPasses && own.is_alone;
  HP_LOOP_BOUND(kMost)
  for (int k = 0; k < tracks_.size(); ++k) {
    const bool is_beside = AreWithin(tracks_[k].place_odom, own.place_odom, kMixed_m);
    is_known = is_known && (k == track || !is_beside || !IsFollowed(tracks_[k], now_ns));
  }
  return is_known;
}

Walker PeopleTracks::WalkerOf(int k, uint64_t now_ns, float person_speed_mps) const {
  const Track& track = tracks_[k];
  if (!IsKnown(k, now_ns)) return {track.place_odom, {}, person_speed_mps};
  const Motion& motion = track.motion;
  const Vec2 v = motion.velocity_mps;
  const float speed_mps = Sqrt(v.x_m * v.x_m + v.y_m * v.y_m);
  const float turns_mps = kTurns_mps + 2.0f * Sqrt(Max(motion.velocity_m2ps2, 0.0f));
  const float s = SecondsBetween(motion.time_ns, now_ns);
  return {
      .place_odom = {motion.place_odom.x_m + s * v.x_m, motion.place_odom.y_m + s * v.y_m},
      .velocity_mps = v,
      .doubt_mps = Min(Max(turns_mps, person_speed_mps - kSetsOff * speed_mps), person_speed_mps)};
}

void PeopleTracks::Walk(uint64_t now_ns, float person_speed_mps, Walkers& walkers) const {
  walkers.Clear();
  HP_LOOP_BOUND(kMost)
  for (int k = 0; k < tracks_.size(); ++k) {
    const Track& track = tracks_[k];
    const bool is_lost = !IsFollowed(track, now_ns);
    if (is_lost && (track.is_found || track.passes < kSurePasses)) continue;
    static_cast<void>(walkers.PushBack(WalkerOf(k, now_ns, person_speed_mps)));
  }
}

bool PeopleTracks::IsAnyoneWithin(Vec2 place_odom, float reach_m, uint64_t now_ns,
                                  uint64_t for_ns) const {
  bool is_anyone = false;
  HP_LOOP_BOUND(kMost)
  for (const Track& track : tracks_) {
    const bool is_recent = now_ns - track.seen_ns <= for_ns;
    is_anyone = is_anyone || (is_recent && AreWithin(track.place_odom, place_odom, reach_m));
  }
  return is_anyone;
}

bool PeopleTracks::LookForLost(uint64_t now_ns, Vec2& place_odom) {
  if (tracks_.empty()) return false;
  lost_ = lost_ + 1 < tracks_.size() ? lost_ + 1 : 0;
  place_odom = tracks_[lost_].place_odom;
  return !tracks_[lost_].is_found && now_ns - tracks_[lost_].seen_ns > kLost_ns;
}

void PeopleTracks::ForgetLost() {
  if (lost_ < tracks_.size()) tracks_[lost_].is_found = true;
}

}  // namespace hardpack
