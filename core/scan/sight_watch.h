// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/onboard_parameters.h"
#include "config/parameters.h"
#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"

// When the lidar last looked in each direction, and whether its data is a look at all
// (docs/safety.md, "Blindness"). It observes accepted columns; it does not stop the vehicle
// (core/safety/supervisor.h does) and does not class returns. Ours.
//
// The directions around the vehicle are divided into sectors as wide as one lidar packet. A sector
// has been looked along if at least a quarter of its columns arrived and are looks. A column is not
// a look if it is
//   empty    fewer than a quarter of the beams returned that would hit the ground within kNear_m:
//            neither of those that would on level ground, nor of those that should by the map;
//            beams towards the sky do not count
//   covered  most of its beams end nearer than the usable range: at the window
//   frozen   all of its ranges equal those of one of the two previous revolutions or of the
//            previous column: measured ranges never repeat
// With a mount where no beam hits the ground within kNear_m, only arrival can be checked. So it is
// where the map knows of nothing within kNear_m, as before a crest, in a sector that has lately
// returned what it should: it keeps that proof until the map knows of something there, and it does
// not come. What no beam has ever come from is not known, and so never driven on.
//
// An occasional lost packet leaves one sector old. So a sector's age is that of the younger of
// itself and its younger neighbour, or half its own age if that is more. With one packet in ten
// lost and a limit of 0.42 s at 10 revolutions a second, this exceeds the limit once in two days of
// driving.

namespace hardpack {

enum class SightCause : uint8_t { kNone = 0, kSilent, kEmpty, kCovered, kFrozen };

// When a stretch of the path was last looked along: the oldest of its directions.
struct SightLook {
  uint64_t time_ns = UINT64_MAX;         // 0: never; UINT64_MAX: no direction was asked for
  SightCause cause = SightCause::kNone;  // why there was no look since
};

class SightWatch {
 public:
  static constexpr int kMaxSectors = 128;
  static constexpr int kLeastSectors = 16;
  static constexpr float kNear_m = 10.0f;
  // Fewer beams than this that should meet something known prove nothing.
  static constexpr int kLeastKnown = 4;
  // With fewer returns a column may equal another one by chance.
  static constexpr int kLeastReturns = 4;
  // One in this many sectors covered or frozen is a fault, in whatever direction.
  static constexpr int kFaultyShare = 16;

  // Resets everything. first, last: the sensor's window of measurement ids, both ends included.
  // kParameterOutOfRange; kInvalidArgument: an empty model, or an invalid window or packet size.
  // Cost: kMaxColumnsPerRevolution angles; kMaxSectors x kMaxBeams directions.
  Status Configure(const LidarMountParams& mount, const SafetyParams& safety,
                   const BeamModel& model, int columns_per_packet, int first, int last);

  // What the map knows in a sector's direction: its beams should come back that fall by more than
  // least_fall per metre along the body's plane (core/autonomy/known_ground.h), but for those that
  // would not on level ground. Without effect before Configure. model: as there. Precondition: 0 <=
  // sector < sectors(). Cost: 7 beams.
  void ExpectKnown(int sector, float least_fall, const BeamModel& model);
  // A sector's middle in the body frame, as a direction of length 1. Precondition as above.
  Vec2 DirectionOf(int sector) const;

  // Takes a column that the map has accepted. One that does not fit the model changes nothing.
  // Cost: its beams.
  void Take(const LidarColumn& column, uint64_t time_ns);

  // Sets `oldest` to the oldest of itself and the sectors from that of `right` anticlockwise to
  // that of `left`, points in the body frame; the other way round if `left` lies clockwise of
  // `right`. Points at the sensor, and points that are not finite, ask for all sectors. Cost: the
  // sectors between.
  void LookBetween(Vec2 right, Vec2 left, uint64_t now_ns, SightLook& oldest) const;
  // The same for all sectors.
  void LookAround(uint64_t now_ns, SightLook& oldest) const;
  // The same for covered or frozen sectors in any direction, if there are too many of them: the
  // time at which that began. Constant cost.
  void LookAtFaults(SightLook& oldest) const;

  // Time of the newest look of any sector; 0: never.
  uint64_t newest_ns() const { return newest_ns_; }
  // From the stamps of two columns of a packet; 0: not known yet.
  uint64_t revolution_ns() const { return revolution_ns_; }
  int sectors() const { return sectors_; }

  // For the operator: one of kShown parts of the circle, anticlockwise from straight behind, and
  // the share of the expected data that arrived in its last revolutions [0.1 %]; 1000 if nothing
  // was expected.
  static constexpr int kShown = 16;
  struct Shares {
    uint16_t columns_permille = 1000;
    uint16_t returns_permille = 1000;  // of beams that would hit the ground
    SightCause cause = SightCause::kNone;
  };
  // Precondition: 0 <= part < kShown. Cost: kMaxSectors / kShown sectors.
  Shares SharesOf(int part, uint64_t now_ns) const;
  // Number of sectors outside the mask that are older than limit_s, covered or frozen.
  int OldSectors(uint64_t now_ns, float limit_s) const;
  int covered_sectors() const { return covered_; }
  int frozen_sectors() const { return frozen_; }

 private:
  // What arrived of a sector in one revolution.
  struct Pass {
    uint16_t columns = 0;
    uint16_t looks = 0;
    uint16_t covered = 0;
    uint16_t repeated = 0;
    uint16_t beams = 0;        // beams that should return, on level ground ...
    uint16_t came = 0;         // ... and those that did
    uint16_t known_beams = 0;  // the same by the map
    uint16_t known_came = 0;
  };
  struct Sector {
    uint64_t look_ns = 0;    // 0: never
    uint64_t column_ns = 0;  // of the newest column, a look or not
    uint16_t columns = 0;    // per revolution, within the window
    uint16_t frame_id = 0;
    bool is_masked = false;
    bool is_proven = false;   // what should come back from there did, when last it was known
    uint8_t known_beams = 0;  // of all from the lowest up, those that should meet something known
    int16_t last_id = -1;     // of its columns; -1: none
    SightCause cause = SightCause::kNone;  // of the last whole pass
    Pass pass;
    Pass last;
  };
  struct Seen {  // of one column
    int returns = 0;
    int at_window = 0;
    int beams = 0;
    int came = 0;
    int known_beams = 0;
    int known_came = 0;
    uint32_t digest = 0;
  };

  void Forget();
  Seen LookAt(const LidarColumn& column, int sector) const;
  bool IsRepeated(const LidarColumn& column, const Seen& seen);
  static void JudgeProof(Sector& sector);
  void EndPass(Sector& sector, uint64_t time_ns);
  void MeasureRevolution(const LidarColumn& column, uint64_t time_ns);
  void LaySectors(const SafetyParams& safety, const BeamModel& model, int first, int last);
  void ExpectGround(const BeamModel& model);
  float FallOf(const BeamModel& model, int last_id, int row) const;
  bool IsEmpty(const Sector& sector, const Seen& seen) const;
  int SectorAt(Vec2 point_body) const;
  void LookAlong(int sector, uint64_t now_ns, SightLook& oldest) const;
  SightCause CauseOf(const Sector& sector, uint64_t now_ns) const;

  bool configured_ = false;
  int32_t beams_ = 0;
  int32_t columns_ = 0;  // per revolution
  int32_t fired_ = 0;    // of these, how many fire
  int32_t columns_per_packet_ = 1;
  int32_t sectors_ = 0;
  uint32_t window_mm_ = 0;  // anything nearer is at the window
  uint64_t limit_ns_ = 0;
  Vec3 sensor_body_;
  float least_fall_ = 0.0f;  // of a beam that meets level ground within kNear_m
  Transform3 body_from_sensor_;
  uint8_t rank_[kMaxBeams] = {};  // of a row, from the lowest beam up
  uint64_t newest_ns_ = 0;
  uint64_t revolution_ns_ = 0;
  uint64_t column_ns_ = 0;  // of the previous column ...
  uint32_t column_digest_ = 0;
  int32_t column_id_ = -1;
  float column_offset_rad_ = 0.0f;
  uint64_t step_ns_ = 0;  // to it from the column before it
  int32_t covered_ = 0;
  int32_t frozen_ = 0;
  uint64_t faulty_since_ns_ = 0;  // 0: no fault
  Sector sector_[kMaxSectors];
  uint64_t meets_ground_[kMaxSectors][2] = {};  // one bit per row
  uint8_t sector_of_[kMaxColumnsPerRevolution] = {};
  // Digests of the column ranges of the last two revolutions.
  uint32_t digest_[2][kMaxColumnsPerRevolution] = {};
};
static_assert(std::is_trivially_copyable_v<SightWatch>);
static_assert(sizeof(SightWatch) <= 32 * 1024);

}  // namespace hardpack
