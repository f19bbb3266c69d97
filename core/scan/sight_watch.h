// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/onboard_parameters.h"
#include "config/parameters.h"
#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"

// When the lidar last looked in which direction, and whether what it sends is a look at all
// (docs/safety.md, "Blindness"). It follows columns that were taken; it does not stop the vehicle
// (core/safety/supervisor.h does) and classes no return. Ours.
//
// The directions around the vehicle are sectors as wide as a packet of the lidar. A sector has been
// looked along when at least a quarter of its columns came that are looks. A column is none
//   empty    where fewer than a quarter of the beams came back that would meet the ground on which
//            the vehicle stands within kNear_m; beams towards the sky are not asked for
//   covered  where most of its beams end nearer than the usable range: at the window
//   frozen   where its ranges are, each of them, those of one of the two revolutions before or of
//            the column before: measured ranges never repeat
// A mount that lets no beam meet the ground within kNear_m gives only what comes or does not.
//
// One packet that is lost now and then leaves one sector old: so a sector counts as old as the
// younger of itself and its younger neighbour, or as half its own age if that is more. With one
// packet in ten lost and a limit of 0.42 s at 10 revolutions a second that is beyond the limit once
// in two days of driving.

namespace hardpack {

enum class SightCause : uint8_t { kNone = 0, kSilent, kEmpty, kCovered, kFrozen };

// How long ago a stretch of the way was looked along: the oldest of its directions.
struct SightLook {
  uint64_t time_ns = UINT64_MAX;         // 0: never; UINT64_MAX: nothing was asked for
  SightCause cause = SightCause::kNone;  // why not since
};

class SightWatch {
 public:
  static constexpr int kMaxSectors = 128;
  static constexpr int kLeastSectors = 16;
  static constexpr float kNear_m = 10.0f;
  // With fewer returns a column may be like another one by chance.
  static constexpr int kLeastReturns = 4;
  // So many sectors' share of all of them, covered or frozen, are a fault wherever they are.
  static constexpr int kFaultyShare = 16;

  // Forgets everything. first, last: the sensor's window of measurement ids, both ends included.
  // kParameterOutOfRange; kInvalidArgument: an empty model, a window or a packet that is none.
  // Cost: kMaxColumnsPerRevolution angles; kMaxSectors x kMaxBeams directions.
  Status Configure(const LidarMountParams& mount, const SafetyParams& safety,
                   const BeamModel& model, int columns_per_packet, int first, int last);

  // A column that the map has taken. One that is not the model's changes nothing. Cost: its beams.
  void Take(const LidarColumn& column, uint64_t time_ns);

  // Makes `oldest` the oldest of itself and of the sectors from that of `right` anticlockwise to
  // that of `left`, points of the body frame; where `left` lies clockwise of `right` the other way
  // round. Points at the sensor, and those that are not finite, ask for all of them. Cost: the
  // sectors between.
  void LookBetween(Vec2 right, Vec2 left, uint64_t now_ns, SightLook& oldest) const;
  // The same of all sectors.
  void LookAround(uint64_t now_ns, SightLook& oldest) const;
  // The same of sectors that are covered or frozen, wherever, where they are too many, since when
  // they are. Constant cost.
  void LookAtFaults(SightLook& oldest) const;

  // Of any sector; 0: never.
  uint64_t newest_ns() const { return newest_ns_; }
  // As the stamps of two columns of a packet have it; 0: not known yet.
  uint64_t revolution_ns() const { return revolution_ns_; }
  int sectors() const { return sectors_; }

  // One of kShown parts of the circle, from straight behind anticlockwise, for the operator: what
  // came in its last revolutions of what was expected [0.1 %]. Without anything expected 1000.
  static constexpr int kShown = 16;
  struct Shares {
    uint16_t columns_permille = 1000;
    uint16_t returns_permille = 1000;  // of beams that would meet the ground
    SightCause cause = SightCause::kNone;
  };
  // Precondition: 0 <= part < kShown. Cost: kMaxSectors / kShown sectors.
  Shares SharesOf(int part, uint64_t now_ns) const;
  // Sectors outside the mask that have been older than limit_s, covered or frozen.
  int OldSectors(uint64_t now_ns, float limit_s) const;
  int covered_sectors() const { return covered_; }
  int frozen_sectors() const { return frozen_; }

 private:
  // What came of a sector in one revolution.
  struct Pass {
    uint16_t columns = 0;
    uint16_t looks = 0;
    uint16_t covered = 0;
    uint16_t repeated = 0;
    uint16_t beams = 0;  // that were expected back ...
    uint16_t came = 0;   // ... and came
  };
  struct Sector {
    uint64_t look_ns = 0;    // 0: never
    uint64_t column_ns = 0;  // of the newest column, a look or not
    uint16_t columns = 0;    // in a revolution, within the window
    uint16_t frame_id = 0;
    bool is_masked = false;
    SightCause cause = SightCause::kNone;  // of the last whole pass
    Pass pass;
    Pass last;
  };
  struct Seen {  // of one column
    int returns = 0;
    int at_window = 0;
    int beams = 0;
    int came = 0;
    uint32_t digest = 0;
  };

  void Forget();
  Seen LookAt(const LidarColumn& column, int sector) const;
  bool IsRepeated(const LidarColumn& column, const Seen& seen);
  void EndPass(Sector& sector, uint64_t time_ns);
  void MeasureRevolution(const LidarColumn& column, uint64_t time_ns);
  void LaySectors(const LidarMountParams& mount, const SafetyParams& safety, const BeamModel& model,
                  int first, int last);
  void ExpectGround(const LidarMountParams& mount, const BeamModel& model);
  int SectorAt(Vec2 point_body) const;
  void LookAlong(int sector, uint64_t now_ns, SightLook& oldest) const;
  SightCause CauseOf(const Sector& sector, uint64_t now_ns) const;

  bool configured_ = false;
  int32_t beams_ = 0;
  int32_t columns_ = 0;  // a revolution
  int32_t fired_ = 0;    // of those that come
  int32_t columns_per_packet_ = 1;
  int32_t sectors_ = 0;
  uint32_t window_mm_ = 0;  // nearer than this is at the window
  uint64_t limit_ns_ = 0;
  Vec2 sensor_body_;
  uint64_t newest_ns_ = 0;
  uint64_t revolution_ns_ = 0;
  uint64_t column_ns_ = 0;  // of the column before ...
  uint32_t column_digest_ = 0;
  int32_t column_id_ = -1;
  float column_offset_rad_ = 0.0f;
  uint64_t step_ns_ = 0;  // from the column before that one to it
  int32_t covered_ = 0;
  int32_t frozen_ = 0;
  uint64_t faulty_since_ns_ = 0;  // 0: not
  Sector sector_[kMaxSectors];
  uint64_t meets_ground_[kMaxSectors][2] = {};  // a bit a row
  uint8_t sector_of_[kMaxColumnsPerRevolution] = {};
  // Of the ranges of the columns of the last two revolutions.
  uint32_t digest_[2][kMaxColumnsPerRevolution] = {};
};
static_assert(std::is_trivially_copyable_v<SightWatch>);
static_assert(sizeof(SightWatch) <= 32 * 1024);

}  // namespace hardpack
