// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/fixed_vector.h"
#include "core/base/pose.h"
#include "core/people/walker.h"

// Where people have been seen to walk, so that what they left behind can be released
// (docs/decisions/0048-what-people-leave-behind.md), and how they walk now
// (docs/decisions/0052-where-people-will-be.md). Beams above a person's knees show that the
// rest of a cell is empty only down to the lowest beam: near the vehicle their lower half would
// stay on the map for good. But a person who is seen elsewhere is not there any more. It does not
// decide who is a person. Ours.
//
//   a track, followed from look to look:     x--x--x--x--O      O: its place now
//                                            left       |<--- at least kLeft_m
//
// A place is left only if one person walked on from it in sight:
// - from each look to the next no longer than kUnseen_ns, and no farther than the gate, which is
//   kBody_m plus kFastest_mps times that time. Whoever crouches, lies down or walks behind
//   something is not followed: their track stays where it was, until more than kMost others have
//   come since, and its places are never left.
// - and nobody else's track, followed or not, was within kBeside_m of theirs before they had left
//   it, or is within that of the place: of two who meet nobody knows who walks on.
// - and no return was farther than kAlone_m from the mean of the others of its revolution: of two
//   who walk side by side one may stay.
// A track that is not followed any more counts for others only if its person was seen in
// kSurePasses revolutions: single returns may be labelled wrongly.
//
// The velocity of a track is that of a Kalman filter with a constant velocity (Bar-Shalom et al.,
// Estimation with Applications to Tracking and Navigation, 2001, section 6.2.2), whose measurements
// are the means of whole revolutions, with kPlaceSigma_m, and whose acceleration is white noise of
// density kWhim_m2ps3. It is known after kKnownPasses revolutions, if all returns of the last one
// were alone and nobody else who is followed is within kMixed_m. Who walks at v may be faster than
// that by kTurns_mps plus two standard deviations in any direction, or, if that is more, by
// person_speed - kSetsOff v: who stands may set off anywhere.
//
// Whoever is out of sight stays where they were, and may walk anywhere, until the owner finds
// nobody there any more (LookForLost, ForgetLost), or somebody appears where they could have walked
// to at kFoundWalk_mps, within kFound_ns: that is taken for them. Neither releases their places.

namespace hardpack {

class PeopleTracks {
 public:
  static constexpr int kMost = 32;
  static constexpr int kMostPlaces = 8;  // not left yet, of a track
  static constexpr float kPlacesApart_m = 0.3f;
  static constexpr float kBody_m = 0.6f;
  static constexpr float kAlone_m = 0.45f;
  static constexpr float kFastest_mps = 3.0f;
  static constexpr float kLeft_m = 0.9f;
  static constexpr float kBeside_m = 1.5f;
  static constexpr int kSurePasses = 3;
  static constexpr uint64_t kUnseen_ns = 250'000'000;
  static constexpr int kKnownPasses = 6;
  static constexpr float kMixed_m = 1.0f;
  static constexpr uint64_t kLost_ns = 2'000'000'000;
  static constexpr uint64_t kFound_ns = 3'000'000'000;
  static constexpr float kFoundWalk_mps = 2.0f;
  static constexpr float kPlaceSigma_m = 0.08f;
  static constexpr float kWhim_m2ps3 = 0.6f;
  static constexpr float kFirstSigma_mps = 1.5f;
  static constexpr float kTurns_mps = 0.4f;
  static constexpr float kSetsOff = 1.5f;

  // Forgets everybody.
  void Reset();

  // A return of a person, seen at now_ns, which must not fall: one of each column with any. Of more
  // than kMost people the longest unseen is forgotten, first of those who are not sure, or, if all
  // are followed, this one ignored. measured_ns: when it was measured, which may fall. Not finite:
  // no effect. Cost: three times kMost distances.
  void Look(Vec2 place_odom, uint64_t now_ns, uint64_t measured_ns);
  void Look(Vec2 place_odom, uint64_t now_ns) { Look(place_odom, now_ns, now_ns); }

  // A place that its person has left, which is forgotten then; false: none. Looks at one track a
  // call: call it once a tick. Cost: kMostPlaces times kMost distances.
  bool TakeLeft(uint64_t now_ns, Vec2& place_odom);

  // Everybody who is in sight, or was and has not been found, and where they are at now_ns.
  // person_speed_mps: the doubt about those of whom nothing else is known. Cost: kMost squared
  // distances.
  void Walk(uint64_t now_ns, float person_speed_mps, Walkers& walkers) const;

  // Of those who were not seen for kLost_ns, one more at each call: where they were. False: nobody.
  // Until then they may have come nearer, where no beam reaches.
  bool LookForLost(uint64_t now_ns, Vec2& place_odom);
  // The place told last was seen without anybody: they are not looked for any more. It does not
  // release what others leave beside it: they may crouch there, below the beams.
  void ForgetLost();

  // Whether somebody was last seen within reach_m of a place, no longer than `for_ns` ago.
  bool IsAnyoneWithin(Vec2 place_odom, float reach_m, uint64_t now_ns, uint64_t for_ns) const;

  int size() const { return tracks_.size(); }

 private:
  // A person's returns of one revolution come together; those of the next one later than this.
  static constexpr uint64_t kPass_ns = 30'000'000;

  // As filtered. The variances are of x and of y alike.
  struct Motion {
    Vec2 place_odom;
    Vec2 velocity_mps;
    uint64_t time_ns = 0;  // 0: nothing was measured yet
    float place_m2 = 0.0f;
    float both_m2ps = 0.0f;
    float velocity_m2ps2 = 0.0f;
  };

  struct Track {
    Vec2 place_odom;  // mean of the returns of the newest revolution, until now
    int32_t returns = 0;
    int32_t passes = 1;    // revolutions in which it was seen, up to kKnownPasses
    bool is_alone = true;  // all returns of the newest revolution are near their mean
    uint64_t seen_ns = 0;
    bool is_found = false;     // out of sight, and not looked for any more
    uint64_t measured_ns = 0;  // the newest return
    Motion motion;
    FixedVector<Vec2, kMostPlaces> places;  // oldest first
  };

  bool IsFollowed(const Track& track, uint64_t now_ns) const {
    return now_ns - track.seen_ns <= kUnseen_ns;
  }
  int TrackOf(Vec2 place_odom, uint64_t now_ns) const;
  void Begin(Vec2 place_odom, uint64_t now_ns, uint64_t measured_ns);
  void Note(int track, uint64_t now_ns);
  void KeepLeft(Track& track);
  bool IsApart(int track, Vec2 place_odom, uint64_t now_ns) const;
  static void Measure(Vec2 place_odom, uint64_t time_ns, Motion& motion);
  void Find(Vec2 place_odom, uint64_t now_ns);
  bool IsKnown(int track, uint64_t now_ns) const;
  Walker WalkerOf(int track, uint64_t now_ns, float person_speed_mps) const;

  FixedVector<Track, kMost> tracks_;
  int32_t next_ = 0;  // looked at by TakeLeft
  int32_t lost_ = 0;  // told by LookForLost
};
static_assert(std::is_trivially_copyable_v<PeopleTracks>);

}  // namespace hardpack
