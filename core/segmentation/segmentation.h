// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "config/parameters.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"
#include "core/segmentation/ground_line.h"
#include "core/segmentation/texture.h"

// The class of each return by geometry alone, direction by direction as the lidar turns: used until
// a label arrives, and for good if there is no segmentation computer (docs/algorithm.md sections 1
// and 8; ours). Also the local ground surface: the ground height under each return, and the
// stretches between returns where it was observed. Causal: a direction is classed as soon as its
// kLag successors have arrived. It never says person, and when in doubt it says hard.
//
// One direction is a column of the range image corrected for the beams' azimuth offsets: all beams
// that looked the same way, from the lowest to the highest.
//
// Ground: the line of GroundLine (ground_line.h), and returns at most ground_band_m, or kBelow_m if
// not firm, above it or kBelow_m below it. Ignored: isolated returns in the range image
// (texture.h): rain, dust, multipath. Soft: most of the returns around it, including itself, look
// like vegetation (a single one is a guess from 24 numbers; among leaves some look even by chance,
// and at the rim of a crown or a box some look rough), it is not part of an upright line, there is
// no definite surface beside it, and nothing at the same distance reaches above max_soft_height_m.
// Hard: everything else, including all of unknown ground. Firm, whatever its class: it lies on one
// surface with its neighbours of the same beam, or on an upright line; a low object is an obstacle
// when most of its returns are firm. Loose: not even at the rim of such a surface. Observed ground:
// the stretch between two consecutive ground returns of one direction, if their level distance is
// at most
//   bridge_factor R^2 da / (h + R s)
// (R level distance of the nearer, da the angle between the nearer's beam and the next higher one,
// h the sensor's height above the nearer, s the rise over level distance between the two, 0 where
// it falls: the ring spacing on such ground) and the slope either way is at most bridge_max_slope,
// apart from 5 cm of noise. Larger gaps stay unknown, so that a ditch does.

namespace hardpack {

// Input of one direction; beams from the lowest to the highest.
struct DirectionView {
  int32_t beams = 0;
  bool seen[kMaxBeams] = {};      // a usable return: in range, and not the vehicle itself
  float level_m[kMaxBeams] = {};  // level distance from the sensor; only where seen
  // Height above the vehicle's position (its body frame's origin, along odom's z).
  float height_m[kMaxBeams] = {};
  float range_m[kMaxBeams] = {};
  // Present rise of the beams over level distance (tangent of the elevation), ascending; for all
  // beams, whether they saw something or not.
  float slope[kMaxBeams] = {};
  float sensor_height_m = 0.0f;  // of the sensor above the same place
};

// Result for one direction, for the same beams.
struct DirectionClasses {
  int32_t beams = 0;
  ReturnClass what[kMaxBeams] = {};      // kIgnored where nothing was seen
  bool ground_known[kMaxBeams] = {};     // false: no ground return close enough
  float above_ground_m[kMaxBeams] = {};  // height above the local ground surface, where known
  // For ground returns: the beam of the next nearer ground return up to which the ground between
  // them counts as observed; -1 if it does not, or if there is none.
  int16_t observed_from[kMaxBeams] = {};
  // For ground returns: the beam of the next nearer ground return, if the ground between them was
  // looked for and not seen: half as far again as may be bridged, at least 0.8 m, with nothing
  // standing between them. -1 otherwise.
  int16_t gap_from[kMaxBeams] = {};
};

class Segmenter {
 public:
  // A return this far below the ground is still ground: a rut, a dip.
  static constexpr float kBelow_m = 0.2f;
  // Directions and beams on either side that count for whether a return is soft.
  static constexpr int kSpread = 2;
  // Directions that must arrive after one before it can be classed, and as many before it that are
  // used. With the columns that a direction is spread over, the wait is at most 132 columns.
  static constexpr int kLag = kSpread + TextureFinder::kReach_directions;

  // kInvalidArgument: beams not 1 .. kMaxBeams; kParameterOutOfRange. Then the segmenter accepts
  // nothing (Push gives kNotStarted). Clears all directions. Cost: the window cleared.
  Status Configure(const SegmentationParams& params, int beams);

  // Clears the earlier directions: the next one is not their neighbour. Cost: the window cleared.
  void Restart();

  // Takes the next direction; push a missing one with nothing seen, so that neighbours stay
  // neighbours. kInvalidArgument: another number of beams; kNotFinite: a number of a seen return,
  // or the sensor's height. The direction then counts as one with nothing seen. kNotStarted: no
  // effect. Cost: constant; at most 24 neighbours per beam for the texture, 40 for the ground line,
  // and 25 for each beam between the lowest and the highest that may be soft.
  Status Push(const DirectionView& view);

  // True once the direction kLag before the last one has arrived since Configure or Restart.
  bool ready() const { return pushed_ > kLag; }

  // The classes of the direction pushed kLag before the last one. Precondition: ready().
  const DirectionClasses& result() const { return result_; }
  // Whether a return of that direction is firm, or loose, or neither, in which case it is at a rim
  // and says nothing. Preconditions: ready(), 0 <= beam < beams.
  bool IsFirm(int beam) const { return Classed().texture.Is(Texture::kFirm, beam); }
  bool IsLoose(int beam) const { return Classed().texture.Is(Texture::kLoose, beam); }
  // Whether a return of that direction is thin: its neighbours on both sides, to the left and right
  // or above and below, returned from at least kThinPast_m farther away. Preconditions: the same,
  // and the direction has a return there.
  static constexpr float kThinPast_m = 0.6f;
  bool IsThin(int beam) const;

 private:
  static constexpr int kSlots = 2 * kLag + 1;
  // Distance up to which vegetation may be soft, in steps of kTallStep_m.
  static constexpr int kTallSteps = 64;

  // One direction of the window.
  struct Direction {
    void Clear();

    RangeColumn ranges;
    int32_t top = 0;  // one above its highest beam with a return
    float level_m[kMaxBeams] = {};
    float height_m[kMaxBeams] = {};
    float slope[kMaxBeams] = {};
    float sensor_height_m = 0.0f;
    Texture texture;
  };

  const Direction& Classed() const { return Back(kLag); }
  // The direction pushed `back` before the last one.
  const Direction& Back(int back) const { return directions_[(newest_ + kSlots - back) % kSlots]; }
  Direction& Back(int back) { return directions_[(newest_ + kSlots - back) % kSlots]; }
  bool Take(const DirectionView& view, Direction& direction) const;
  void FindTexture();
  void Class();
  void FindLine(const Direction& direction);
  void FileHeights(const Direction& direction);
  void FileGround(const Direction& direction);
  // Stretches of one direction, by level distance, where ground was looked for and not seen.
  struct Gaps {
    static constexpr int kMost = 4;  // further ones are dropped
    int32_t count = 0;
    float low_m[kMost] = {};
    float high_m[kMost] = {};
    void Add(float from_m, float to_m);
    bool Hold(float level_m) const;
  };

  void FileStretch(const Direction& direction, int point);
  bool IsLong(const Direction& direction, int point, float factor) const;
  bool StandsBetween(int near_beam, int beam) const;
  void RememberTall(const Direction& direction);
  bool IsTallAt(float level_m) const;
  bool MayBeSoft(const Direction& direction, int beam) const;
  void CountAround(const Direction& direction, int low, int high);
  void FileSoft(const Direction& direction);

  bool configured_ = false;
  int32_t beams_ = 0;
  int32_t pushed_ = 0;  // since Restart, saturates beyond kLag
  int32_t newest_ = 0;
  SegmentationParams params_;
  Direction directions_[kSlots];
  TextureFinder texture_finder_;
  GroundCandidates candidates_;
  GroundLine line_;
  float above_m_[kMaxBeams] = {};  // height above the ground, estimated if not known
  // Sum of the looks of the returns of the same object in the 5 x 5 around a return.
  uint32_t around_[kMaxBeams] = {};
  // Number of coming directions for which something tall stands at each level distance.
  uint8_t tall_[kTallSteps] = {};
  Gaps gaps_;            // of the direction being classed
  Gaps gaps_before_[2];  // and of the two before it
  DirectionClasses result_;
};
static_assert(std::is_trivially_copyable_v<Segmenter>);
static_assert(sizeof(Segmenter) <= 32 * 1024);

}  // namespace hardpack
