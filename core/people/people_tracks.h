// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/fixed_vector.h"
#include "core/base/pose.h"

// Where people have been seen to walk, so that what they left behind can be released
// (docs/decisions/0048-what-people-leave-behind.md). Beams above a person's knees show that the
// rest of a cell is empty only down to the lowest beam: near the vehicle their lower half would
// stay on the map for good. But a person who is seen elsewhere is not there any more. It neither
// decides who is a person nor where anybody will be. Ours.
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

  // Forgets everybody.
  void Reset();

  // A return of a person, seen at now_ns, which must not fall: one of each column with any. Of more
  // than kMost people the longest unseen is forgotten, first of those who are not sure, or, if all
  // are followed, this one ignored. Not finite: no effect. Cost: twice kMost distances.
  void Look(Vec2 place_odom, uint64_t now_ns);

  // A place that its person has left, which is forgotten then; false: none. Looks at one track a
  // call: call it once a tick. Cost: kMostPlaces times kMost distances.
  bool TakeLeft(uint64_t now_ns, Vec2& place_odom);

  int size() const { return tracks_.size(); }

 private:
  // A person's returns of one revolution come together; those of the next one later than this.
  static constexpr uint64_t kPass_ns = 30'000'000;

  struct Track {
    Vec2 place_odom;  // mean of the returns of the newest revolution, until now
    int32_t returns = 0;
    int32_t passes = 1;  // revolutions in which it was seen, up to kSurePasses
    uint64_t seen_ns = 0;
    FixedVector<Vec2, kMostPlaces> places;  // oldest first
  };

  bool IsFollowed(const Track& track, uint64_t now_ns) const {
    return now_ns - track.seen_ns <= kUnseen_ns;
  }
  int TrackOf(Vec2 place_odom, uint64_t now_ns) const;
  void Begin(Vec2 place_odom, uint64_t now_ns);
  void Note(int track, uint64_t now_ns);
  void KeepLeft(Track& track);
  bool IsApart(int track, Vec2 place_odom, uint64_t now_ns) const;

  FixedVector<Track, kMost> tracks_;
  int32_t next_ = 0;  // looked at by TakeLeft
};
static_assert(std::is_trivially_copyable_v<PeopleTracks>);

}  // namespace hardpack
