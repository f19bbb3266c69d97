// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/parameters.h"
#include "core/measurements/measurements.h"

// The ground of one direction: a line of ground returns from the vehicle outward, and the ground
// height at any level distance. It knows nothing of classes and of neighbouring directions; do not
// pass it isolated returns (docs/algorithm.md section 1; ours).
//
// A return joins the line when
//   it can be reached:   its rise over level distance from the line's end, from a point of the line
//                        further back, and from the last obstacle on the way is within the slope,
//   and it lies on a drivable surface: the returns of the beams above and below it
//                        advance outward as they would on ground; on a face they do not,
//   and it is open:      no return of the next beams above stands up in front of it, none of the
//                        next below lies behind and shows that it stands up itself, and neither do
//                        the next above that lie behind: a low rock far away has one beam on it,
//                        and the next one meets the ground behind it.
// A return no higher than the extrapolated line may be the edge of a surface and need not be open:
// the line keeps to the lower side.
// A return that is closer than the line's end but passes the same tests from further back takes the
// line back: what it occludes cannot have been ground (multipath below the ground).

namespace hardpack {

// Of ground that a lidar measures as even.
inline constexpr float kHeightNoise_m = 0.05f;

// The returns of one direction that may be ground, from the lowest beam to the highest.
struct GroundCandidates {
  int32_t count = 0;
  float level_m[kMaxBeams] = {};   // level distance from the sensor
  float height_m[kMaxBeams] = {};  // above the place where the vehicle stands
  float slope[kMaxBeams] = {};     // rise of the beam over level distance
  uint8_t beam[kMaxBeams] = {};
};

// Ground height at a place.
struct GroundHeight {
  float height_m = 0.0f;  // the best estimate, even if not known
  bool known = false;
};

class GroundLine {
 public:
  // Finds the line. Cost: at most kMaxBeams candidates, each of which looks at 40 others at most
  // and removes at most what was added.
  void Find(const GroundCandidates& candidates, float max_slope);

  // The ground at a level distance. Between two points of the line: the straight line, but not
  // above the nearer point extrapolated with the slope that the line had there, so that the foot of
  // a step counts and not its top. Beyond the last point it is extrapolated for carry_m. point: as
  // LastPointBefore(level_m). Cost: constant.
  GroundHeight At(int point, float level_m, float carry_m) const;

  // The last point of the line closer than a level distance, 0 if there is none. hint: any point;
  // the answer is the same, but immediate if it is that point or the next. Cost: a binary search.
  int LastPointBefore(float level_m, int hint) const;

  // Points of the line: 0 is the vehicle's own position, which no beam saw (beam -1).
  int size() const { return size_; }
  float level_m(int index) const { return level_m_[index]; }
  float height_m(int index) const { return height_m_[index]; }
  int beam(int index) const { return beam_[index]; }

 private:
  // Beams above and below a return that must not contradict it.
  static constexpr int kMaxOrder = 4;

  bool Reaches(int point, float level_m, float height_m) const;
  float AboveCarried(int point, float level_m, float height_m) const;
  bool CanJoin(int point, float level_m, float height_m) const;
  bool IsSurface(const GroundCandidates& all, int candidate, bool continues) const;
  bool IsOpen(const GroundCandidates& all, int candidate, int point) const;
  void Join(int point, float level_m, float height_m, int beam);

  int32_t size_ = 1;
  float max_slope_ = 0.0f;
  float obstacle_level_m_ = 0.0f;  // position of the last one beyond the line's end; 0: none
  float level_m_[kMaxBeams + 1] = {};
  float height_m_[kMaxBeams + 1] = {};
  float slope_[kMaxBeams + 1] = {};   // of the line up to this point
  int16_t base_[kMaxBeams + 1] = {};  // the earlier point from which it is measured
  int16_t beam_[kMaxBeams + 1] = {};
};
static_assert(std::is_trivially_copyable_v<GroundLine>);

}  // namespace hardpack
