// SPDX-License-Identifier: Apache-2.0
#include "core/scan/sight_watch.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/base/units.h"
#include "core/base/validate.h"
#include "core/scan/scan.h"

namespace hardpack {
namespace {

// Of the columns of a sector, and of the beams that would meet the ground: so many are one look.
constexpr int kShareOfLook = 4;
// Between two columns of a sensor that is worth measuring, and how far apart they are at least.
constexpr uint64_t kLongestStep_ns = 1'000'000;
constexpr float kLeastStep_columns = 0.25f;

// value modulo size, for -size <= value < 2 size.
int Wrapped(int value, int size) {
  if (value < 0) return value + size;
  return value < size ? value : value - size;
}

// From [-pi, pi] to a sector, the first straight behind.
int SectorOf(float angle_rad, int sectors) {
  const float share = (angle_rad + kPi) / kTwoPi;
  return Wrapped(ClampInt(FloorToInt(share * static_cast<float>(sectors)), 0, sectors), sectors);
}

uint64_t Limit_ns(float limit_s) {
  return static_cast<uint64_t>(RoundToInt(limit_s * kMillisecondsPerSecond)) * 1'000'000u;
}

// Where a beam at the level would point in the sensor frame.
Vec3 LevelDirection(const BeamModel& model, int measurement_id) {
  const float* r = model.sensor_from_lidar.rotation;
  const float cos = model.cos_encoder[measurement_id];
  const float sin = model.sin_encoder[measurement_id];
  return {r[0] * cos + r[1] * sin, r[3] * cos + r[4] * sin, r[6] * cos + r[7] * sin};
}

Vec3 Turned(const Transform3& transform, const Vec3& v) {
  const float* r = transform.rotation;
  return {r[0] * v.x_m + r[1] * v.y_m + r[2] * v.z_m, r[3] * v.x_m + r[4] * v.y_m + r[5] * v.z_m,
          r[6] * v.x_m + r[7] * v.y_m + r[8] * v.z_m};
}

uint16_t Permille(int part, int whole) {
  if (whole <= 0) return 1000;
  return static_cast<uint16_t>(ClampInt(part * 1000 / whole, 0, 1000));
}

}  // namespace

Status SightWatch::Configure(const LidarMountParams& mount, const SafetyParams& safety,
                             const BeamModel& model, int columns_per_packet, int first, int last) {
  Forget();
  if (FirstInvalidParameter(safety) != nullptr) return Status::kParameterOutOfRange;
  const int columns = model.columns_per_revolution;
  const bool is_window = first >= 0 && first < columns && last >= 0 && last < columns;
  if (model.beams <= 0 || columns < kLeastSectors || columns_per_packet <= 0 || !is_window) {
    return Status::kInvalidArgument;
  }
  beams_ = model.beams;
  columns_ = columns;
  fired_ = model.fired_per_revolution;
  columns_per_packet_ = columns_per_packet;
  sectors_ = ClampInt(columns / columns_per_packet, kLeastSectors, kMaxSectors);
  window_mm_ = static_cast<uint32_t>(RoundToInt(mount.min_range_m * kMillisecondsPerSecond));
  limit_ns_ = Limit_ns(safety.max_look_age_s);
  body_from_sensor_ = BodyFromSensor(mount);
  sensor_body_ = body_from_sensor_.Apply(model.sensor_from_lidar.translation);
  least_fall_ = sensor_body_.z_m / kNear_m;
  LaySectors(safety, model, first, last);
  ExpectGround(model);
  configured_ = true;
  return Status::kOk;
}

// Member by member: as a whole it is too large for the stack.
void SightWatch::Forget() {
  configured_ = false;
  newest_ns_ = 0;
  revolution_ns_ = 0;
  column_ns_ = 0;
  column_digest_ = 0;
  column_id_ = -1;
  column_offset_rad_ = 0.0f;
  step_ns_ = 0;
  least_fall_ = 0.0f;
  covered_ = 0;
  frozen_ = 0;
  faulty_since_ns_ = 0;
  HP_LOOP_BOUND(kMaxSectors)
  for (int i = 0; i < kMaxSectors; ++i) {
    Sector& sector = sector_[i];
    sector.look_ns = 0;
    sector.column_ns = 0;
    sector.columns = 0;
    sector.frame_id = 0;
    sector.is_masked = false;
    sector.is_proven = false;
    sector.known_beams = 0;
    sector.last_id = -1;
    sector.cause = SightCause::kNone;
    sector.pass = Pass{};
    sector.last = Pass{};
    meets_ground_[i][0] = 0;
    meets_ground_[i][1] = 0;
  }
  HP_LOOP_BOUND(kMaxColumnsPerRevolution)
  for (int id = 0; id < kMaxColumnsPerRevolution; ++id) {
    sector_of_[id] = 0;
    digest_[0][id] = 0;
    digest_[1][id] = 0;
  }
}

void SightWatch::LaySectors(const SafetyParams& safety, const BeamModel& model, int first,
                            int last) {
  HP_LOOP_BOUND(kMaxColumnsPerRevolution)
  for (int id = 0; id < columns_; ++id) {
    const Vec3 direction = Turned(body_from_sensor_, LevelDirection(model, id));
    const int sector = SectorOf(Atan2(direction.y_m, direction.x_m), sectors_);
    sector_of_[id] = static_cast<uint8_t>(sector);
    const bool in_window = first <= last ? id >= first && id <= last : id >= first || id <= last;
    if (in_window) ++sector_[sector].columns;
  }
  if (safety.sight_mask_from_rad == safety.sight_mask_to_rad) return;
  const int from = SectorOf(WrapAngle(safety.sight_mask_from_rad), sectors_);
  const int to = SectorOf(WrapAngle(safety.sight_mask_to_rad), sectors_);
  const int count = Wrapped(to - from, sectors_) + 1;
  HP_LOOP_BOUND(kMaxSectors)
  for (int i = 0; i < count; ++i) sector_[Wrapped(from + i, sectors_)].is_masked = true;
}

// The rows that would meet the plane on which the vehicle stands, by the last column of each
// sector.
void SightWatch::ExpectGround(const BeamModel& model) {
  HP_LOOP_BOUND(kMaxColumnsPerRevolution)
  for (int id = 0; id < columns_; ++id) {
    Sector& sector = sector_[sector_of_[id]];
    if (sector_of_[Wrapped(id + 1, columns_)] != sector_of_[id]) {
      sector.last_id = static_cast<int16_t>(id);
    }
  }
  HP_LOOP_BOUND(kMaxSectors)
  for (int index = 0; index < sectors_; ++index) {
    const int last_id = sector_[index].last_id;
    if (last_id < 0) continue;
    HP_LOOP_BOUND(kMaxBeams)
    for (int row = 0; row < beams_; ++row) {
      if (!(FallOf(model, last_id, row) >= least_fall_)) continue;
      meets_ground_[index][row / 64] |= uint64_t{1} << (static_cast<uint32_t>(row) % 64u);
    }
  }
  HP_LOOP_BOUND(kMaxBeams)
  for (int rank = 0; rank < beams_; ++rank) {
    rank_[model.by_altitude[rank]] = static_cast<uint8_t>(rank);
  }
}

// How much a beam falls per metre along the body's plane; for one that does not, less than any.
float SightWatch::FallOf(const BeamModel& model, int last_id, int row) const {
  constexpr uint32_t kFar_mm = 100'000;
  const Vec3 far =
      body_from_sensor_.Apply(PointInSensor(model, EncoderSinCos(model, last_id), row, kFar_mm));
  const float fall_m = sensor_body_.z_m - far.z_m;
  const float x_m = far.x_m - sensor_body_.x_m;
  const float y_m = far.y_m - sensor_body_.y_m;
  const float level2_m2 = x_m * x_m + y_m * y_m;
  constexpr float kDoesNotFall = -1.0e6f;
  if (!(fall_m > 0.0f) || !(level2_m2 > 0.0f)) return kDoesNotFall;
  return fall_m / Sqrt(level2_m2);
}

// Of beams from the lowest up, each falls less than the one before, but for their own azimuths on a
// mount that leans: the first that falls too little is found by halves.
void SightWatch::ExpectKnown(int index, float least_fall, const BeamModel& model) {
  if (!configured_ || model.beams != beams_) return;
  Sector& sector = sector_[index];
  if (sector.last_id < 0) return;
  const float least = Max(least_fall, least_fall_);
  int beams = 0;
  static_assert(kMaxBeams <= 128);
  HP_LOOP_BOUND(8)
  for (int step = 128; step > 0; step /= 2) {
    const int more = beams + step;
    const bool falls =
        more <= beams_ && FallOf(model, sector.last_id, model.by_altitude[more - 1]) >= least;
    if (falls) beams = more;
  }
  sector.known_beams = static_cast<uint8_t>(beams);
}

Vec2 SightWatch::DirectionOf(int sector) const {
  const float turns = (static_cast<float>(sector) + 0.5f) / static_cast<float>(sectors_);
  const SinCosPair angle = SinCos(turns * kTwoPi - kPi);
  return {angle.cos, angle.sin};
}

SightWatch::Seen SightWatch::LookAt(const LidarColumn& column, int sector) const {
  Seen seen;
  seen.digest = 2166136261u;
  const int known_beams = sector_[sector].known_beams;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int row = 0; row < beams_; ++row) {
    const uint32_t range_mm = NearestRange(column, row);
    seen.digest = (seen.digest ^ range_mm) * 16777619u;
    const bool returned = range_mm != 0;
    const bool is_at_window = returned && range_mm < window_mm_;
    const uint64_t bits = meets_ground_[sector][row / 64];
    const bool meets = (bits >> (static_cast<uint32_t>(row) % 64u) & 1u) != 0;
    const bool meets_known = rank_[row] < known_beams;
    const bool comes = returned && !is_at_window;
    seen.returns += returned ? 1 : 0;
    seen.at_window += is_at_window ? 1 : 0;
    seen.beams += meets ? 1 : 0;
    seen.came += meets && comes ? 1 : 0;
    seen.known_beams += meets_known ? 1 : 0;
    seen.known_came += meets_known && comes ? 1 : 0;
  }
  return seen;
}

// So few of its beams came back that it is not a look.
bool SightWatch::IsEmpty(const Sector& sector, const Seen& seen) const {
  const bool is_level = seen.came * kShareOfLook >= seen.beams;
  if (is_level) return false;
  if (seen.known_beams < kLeastKnown) return !sector.is_proven;
  return seen.known_came * kShareOfLook < seen.known_beams;
}

bool SightWatch::IsRepeated(const LidarColumn& column, const Seen& seen) {
  const int id = column.measurement_id;
  const bool repeats = seen.returns >= kLeastReturns &&
                       (seen.digest == digest_[0][id] || seen.digest == digest_[1][id] ||
                        seen.digest == column_digest_);
  digest_[1][id] = digest_[0][id];
  digest_[0][id] = seen.digest;
  column_digest_ = seen.digest;
  return repeats;
}

// A sensor's stamps are even within a packet; between two the offset to our clock may have moved.
// Columns that are off their places are more or less than one apart, and begin a packet anywhere:
// such a sensor fires in even steps, and the one between two packets tells by being none.
void SightWatch::MeasureRevolution(const LidarColumn& column, uint64_t time_ns) {
  const bool follows = column.measurement_id == column_id_ + 1 && time_ns > column_ns_ &&
                       column.measurement_id % columns_per_packet_ != 0;
  const bool is_placed = column_offset_rad_ == 0.0f && column.azimuth_offset_rad == 0.0f;
  const uint64_t step_ns = time_ns - column_ns_;
  if (follows && is_placed) {
    revolution_ns_ = step_ns * static_cast<uint64_t>(columns_);
  } else if (!is_placed) {
    const bool is_even = 8 * step_ns <= 9 * step_ns_ && 8 * step_ns >= 7 * step_ns_;
    if (follows && is_even && step_ns <= kLongestStep_ns) {
      const auto columns = static_cast<float>(columns_);
      const float further_rad = column_offset_rad_ - column.azimuth_offset_rad;
      const float apart = Max(1.0f + further_rad * columns / kTwoPi, kLeastStep_columns);
      const auto turned_ns = static_cast<float>(static_cast<uint32_t>(step_ns)) * columns / apart;
      revolution_ns_ = static_cast<uint64_t>(RoundToInt(turned_ns));
    }
  }
  step_ns_ = step_ns;
  column_id_ = column.measurement_id;
  column_ns_ = time_ns;
  column_offset_rad_ = column.azimuth_offset_rad;
}

// Not inlined: its calls are counted (config/timing.toml).
[[gnu::noinline]] void SightWatch::Take(const LidarColumn& column, uint64_t time_ns) {
  if (!configured_ || column.beams != beams_ || column.measurement_id >= columns_) return;
  MeasureRevolution(column, time_ns);
  const int index = sector_of_[column.measurement_id];
  Sector& sector = sector_[index];
  if (column.frame_id != sector.frame_id || sector.column_ns == 0) {
    EndPass(sector, time_ns);
    sector.frame_id = column.frame_id;
  }
  const Seen seen = LookAt(column, index);
  const bool is_repeated = IsRepeated(column, seen);
  const bool is_covered = seen.at_window * 2 > beams_;
  const bool is_empty = IsEmpty(sector, seen);
  Pass& pass = sector.pass;
  ++pass.columns;
  pass.covered = static_cast<uint16_t>(pass.covered + (is_covered ? 1 : 0));
  pass.repeated = static_cast<uint16_t>(pass.repeated + (is_repeated ? 1 : 0));
  pass.beams = static_cast<uint16_t>(pass.beams + seen.beams);
  pass.came = static_cast<uint16_t>(pass.came + seen.came);
  pass.known_beams = static_cast<uint16_t>(pass.known_beams + seen.known_beams);
  pass.known_came = static_cast<uint16_t>(pass.known_came + seen.known_came);
  sector.column_ns = time_ns;
  if (is_repeated || is_covered || is_empty) return;
  ++pass.looks;
  if (pass.looks * kShareOfLook < sector.columns) return;
  if (time_ns > sector.look_ns) sector.look_ns = time_ns;
  if (time_ns > newest_ns_) newest_ns_ = time_ns;
}

// Of a pass that has ended. A frozen image was a look when it was new.
void SightWatch::JudgeProof(Sector& sector) {
  const Pass& pass = sector.pass;
  const bool is_level = pass.beams > 0 && pass.came * kShareOfLook >= pass.beams;
  const bool is_known = pass.known_beams >= kLeastKnown * pass.columns;
  if (is_level) {
    sector.is_proven = true;
  } else if (is_known) {
    sector.is_proven = pass.known_came * kShareOfLook >= pass.known_beams;
  }
}

void SightWatch::EndPass(Sector& sector, uint64_t time_ns) {
  const Pass& pass = sector.pass;
  SightCause cause = SightCause::kNone;
  if (pass.columns == 0) return;
  if (pass.repeated * 2 > pass.columns) {
    cause = SightCause::kFrozen;
  } else if (pass.covered * 2 > pass.columns) {
    cause = SightCause::kCovered;
  } else if (pass.columns * kShareOfLook < sector.columns) {
    cause = SightCause::kSilent;
  } else if (pass.looks * kShareOfLook < sector.columns) {
    cause = SightCause::kEmpty;
  }
  if (!sector.is_masked) {
    const auto count = [](bool is, bool was) { return (is ? 1 : 0) - (was ? 1 : 0); };
    covered_ += count(cause == SightCause::kCovered, sector.cause == SightCause::kCovered);
    frozen_ += count(cause == SightCause::kFrozen, sector.cause == SightCause::kFrozen);
  }
  JudgeProof(sector);
  const bool is_faulty = (covered_ + frozen_) * kFaultyShare >= sectors_;
  if (is_faulty && faulty_since_ns_ == 0) faulty_since_ns_ = time_ns;
  if (!is_faulty) faulty_since_ns_ = 0;
  sector.cause = cause;
  sector.last = pass;
  sector.pass = Pass{};
}

// Of two revolutions of a sensor that is so slow none may be missed: it is never fresh enough. Not
// inlined: the loops around it could be merged into one, whose bound is then not to be found.
[[gnu::noinline]] void SightWatch::LookAlong(int index, uint64_t now_ns, SightLook& oldest) const {
  const Sector& sector = sector_[index];
  if (sector.is_masked) return;
  const uint64_t before_ns = sector_[Wrapped(index - 1, sectors_)].look_ns;
  const uint64_t after_ns = sector_[Wrapped(index + 1, sectors_)].look_ns;
  const uint64_t beside_ns = before_ns > after_ns ? before_ns : after_ns;
  const uint64_t own_ns = sector.look_ns;
  const uint64_t pair_ns = own_ns > beside_ns ? own_ns : beside_ns;
  const uint64_t half_ns = own_ns < now_ns ? now_ns - (now_ns - own_ns) / 2 : own_ns;
  uint64_t look_ns = pair_ns < half_ns ? pair_ns : half_ns;
  const bool is_slow = revolution_ns_ > 0 && 2 * revolution_ns_ > limit_ns_;
  if (own_ns == 0 || is_slow) look_ns = 0;
  if (look_ns >= oldest.time_ns) return;
  oldest.time_ns = look_ns;
  oldest.cause = CauseOf(sector, now_ns);
}

// Of a sector that is old.
SightCause SightWatch::CauseOf(const Sector& sector, uint64_t now_ns) const {
  const uint64_t silent_ns = sector.column_ns < now_ns ? now_ns - sector.column_ns : 0;
  if (sector.column_ns == 0 || 2 * silent_ns > limit_ns_) return SightCause::kSilent;
  return sector.cause;
}

int SightWatch::SectorAt(Vec2 point_body) const {
  const float y_m = point_body.y_m - sensor_body_.y_m;
  const float x_m = point_body.x_m - sensor_body_.x_m;
  return SectorOf(Atan2(y_m, x_m), sectors_);
}

void SightWatch::LookBetween(Vec2 right, Vec2 left, uint64_t now_ns, SightLook& oldest) const {
  if (!configured_) {
    oldest.time_ns = 0;
    return;
  }
  if (!IsFinite(right) || !IsFinite(left)) return LookAround(now_ns, oldest);
  const int a = SectorAt(right);
  const int b = SectorAt(left);
  const int turn = Wrapped(b - a, sectors_);
  const bool is_reversed = 2 * turn > sectors_;
  const int from = is_reversed ? b : a;
  const int count = is_reversed ? sectors_ - turn : turn;
  HP_LOOP_BOUND(kMaxSectors / 2 + 1)
  for (int i = 0; i <= count; ++i) LookAlong(Wrapped(from + i, sectors_), now_ns, oldest);
}

void SightWatch::LookAround(uint64_t now_ns, SightLook& oldest) const {
  if (!configured_) oldest.time_ns = 0;
  HP_LOOP_BOUND(kMaxSectors)
  for (int i = 0; i < sectors_; ++i) LookAlong(i, now_ns, oldest);
}

void SightWatch::LookAtFaults(SightLook& oldest) const {
  if (faulty_since_ns_ == 0 || faulty_since_ns_ >= oldest.time_ns) return;
  oldest.time_ns = faulty_since_ns_;
  oldest.cause = frozen_ > covered_ ? SightCause::kFrozen : SightCause::kCovered;
}

SightWatch::Shares SightWatch::SharesOf(int part, uint64_t now_ns) const {
  Shares shares;
  const int first = part * sectors_ / kShown;
  const int end = (part + 1) * sectors_ / kShown;
  int expected = 0;
  int columns = 0;
  int beams = 0;
  int came = 0;
  HP_LOOP_BOUND(kMaxSectors / kShown)
  for (int i = first; i < end; ++i) {
    const Sector& sector = sector_[i];
    expected += sector.columns;
    const SightCause cause = CauseOf(sector, now_ns);
    if (cause > shares.cause && !sector.is_masked && sector.columns > 0) shares.cause = cause;
    if (cause == SightCause::kSilent && sector.column_ns + limit_ns_ < now_ns) continue;
    columns += sector.last.columns;
    const bool is_known = sector.last.known_beams >= kLeastKnown * sector.last.columns;
    beams += is_known ? sector.last.known_beams : sector.last.beams;
    came += is_known ? sector.last.known_came : sector.last.came;
  }
  const bool leaves_out = fired_ < columns_;
  shares.columns_permille = Permille(columns, leaves_out ? expected * fired_ / columns_ : expected);
  shares.returns_permille = Permille(came, beams);
  return shares;
}

int SightWatch::OldSectors(uint64_t now_ns, float limit_s) const {
  const uint64_t limit_ns = Limit_ns(limit_s);
  int old = 0;
  HP_LOOP_BOUND(kMaxSectors)
  for (int i = 0; i < sectors_; ++i) {
    if (sector_[i].is_masked) continue;
    SightLook look;
    LookAlong(i, now_ns, look);
    if (look.time_ns == 0 || look.time_ns + limit_ns < now_ns) ++old;
  }
  return old;
}

}  // namespace hardpack
