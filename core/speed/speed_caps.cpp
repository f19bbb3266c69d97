// SPDX-License-Identifier: Apache-2.0
#include "core/speed/speed_caps.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"

namespace hardpack {
namespace {

constexpr float kFar_m = SpeedCaps::kFar_m;
constexpr float kSample_m = 0.5f * kCellSize_m;
constexpr float kHalfCellDiagonal_m = 0.5f * kCellDiagonal_m;
// From the middle of what is seen of somebody to their surface.
constexpr float kWalkerBody_m = 0.25f;
// At most, of somebody who sets off or turns round.
constexpr float kSetsOff_mps2 = 2.5f;

// How far somebody may walk while the vehicle stops from its highest speed.
float WalkWhileStopping(const SpeedParams& params) {
  return params.person_speed_mps * StoppingTime(params, params.max_speed_mps);
}

// How far ahead a person can matter: beyond, the vehicle can stop first from any speed, however
// they come (PersonSpeedCap's rule).
float ReachAhead(const SpeedParams& params, const VehicleParams& vehicle) {
  return StoppingDistance(params, params.max_speed_mps) + WalkWhileStopping(params) +
         params.person_margin_m + Max(LeadingEdgeOf(vehicle, false), LeadingEdgeOf(vehicle, true));
}

// And how far aside.
float ReachAside(const SpeedParams& params, const Footprint& footprint) {
  return Min(WalkWhileStopping(params) + params.person_margin_m + footprint.disc_radius_m +
                 kHalfCellDiagonal_m,
             kFar_m);
}

// The speed at which what the vehicle is beside its path by is room_m; see the header.
float RoomSpeedCap(const SpeedParams& params, float room_m, float bend_per_m) {
  const float left_m = room_m - params.track_error_m;
  if (!(left_m > 0.0f)) return params.least_room_mps;
  const float linear_s = params.track_error_s;
  const float square = params.track_error_s2 * bend_per_m;
  // a v^2 + b v = c: v = 2 c / (b + sqrt(b^2 + 4 a c)), which holds for a = 0 too.
  const float root = Sqrt(linear_s * linear_s + 4.0f * square * left_m);
  const float divisor = linear_s + root;
  const float cap_mps = 2.0f * left_m > params.max_speed_mps * divisor ? params.max_speed_mps
                                                                       : 2.0f * left_m / divisor;
  return Max(cap_mps, Min(params.least_room_mps, params.max_speed_mps));
}

}  // namespace

void SpeedCaps::Begin(const GridWindow& window, const SpeedParams& params,
                      const VehicleParams& vehicle, const WorldPath& path, float speed_mps,
                      const Lookouts& lookouts, const Walkers* walkers, float too_steep_m) {
  points_ = path.size();
  speed_mps_ = speed_mps;
  footprint_ = FootprintOf(vehicle);
  reach_m_ = ReachAside(params, footprint_);
  Vec2 low = {path[0].x_m, path[0].y_m};
  Vec2 high = low;
  along_m_[0] = 0.0f;
  person2_m2_[0] = Squared(kFar_m);
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int k = 1; k < points_; ++k) {
    const float driven_m = PlanarModel::Inverse(path[k - 1], path[k]).dr_m;
    along_m_[k] = along_m_[k - 1] + Abs(driven_m);
    reversed_[k - 1] = driven_m < 0.0f && HasLength(driven_m);
    person2_m2_[k] = Squared(kFar_m);
    low = {Min(low.x_m, path[k].x_m), Min(low.y_m, path[k].y_m)};
    high = {Max(high.x_m, path[k].x_m), Max(high.y_m, path[k].y_m)};
  }
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < points_; ++k) {
    x_m_[k] = path[k].x_m;
    y_m_[k] = path[k].y_m;
    cap_mps_[k] = ReactionSpeedCap(params, along_m_[points_ - 1] - along_m_[k]);
    cause_[k] = CapCause::kPathEnd;
  }
  reversed_[points_ - 1] = points_ > 1 && reversed_[points_ - 2];
  FindBends(path);
  too_steep_m_ = too_steep_m;
  BeginToLook(lookouts);
  walkers_.Clear();
  if (walkers != nullptr) walkers_ = *walkers;
  uses_cells_ = walkers == nullptr || walkers->full();
  walker_ = 0;
  hidden_creep_mps_ = params.hidden_creep_mps;
  max_unseen_m_ = params.max_unseen_m;
  brows_.Begin(lookouts.climb, params.max_unseen_m);
  growth_speed_mps_ = params.growth_speed_mps;
  unseen_margin_m_ = params.unseen_margin_m;
  max_reverse_mps_ = params.max_reverse_mps;
  const float room_m = footprint_.disc_radius_m + kHalfCellDiagonal_m + params.narrow_room_m;
  room2_cells2_ = Squared(room_m * kCellsPerMeter);
  narrow_ = false;
  low_ = window.Nearest(CellAt({low.x_m - reach_m_, low.y_m - reach_m_}));
  high_ = window.Nearest(CellAt({high.x_m + reach_m_, high.y_m + reach_m_}));
  row_ = low_.y;
  column_ = low_.x;
  zone_ = 0;
  zone_point_ = 0;
  point_ = 0;
}

void SpeedCaps::BeginToLook(const Lookouts& lookouts) {
  lookouts_ = lookouts;
  chord_ = 0;
  sample_ = 0;
  track_ = 0;
  look_ = Look{};
  observed_m_ = kFar_m;
  HP_LOOP_BOUND(kTracks)
  for (int track = 0; track < kTracks; ++track) {
    seen_m_[track] = 0.0f;
    gap_from_m_[track] = 0.0f;
  }
}

// Not inlined, as IsHiddenAt.
[[gnu::noinline]] void SpeedCaps::LookForBrows(const Costmap& map, const Terrain& terrain,
                                               const VehicleParams& vehicle) {
  float aside_m[kTracks];
  HP_LOOP_BOUND(kTracks)
  for (int track = 0; track < kTracks; ++track) aside_m[track] = kAside[track] * vehicle.width_m;
  brows_.Step(map, terrain, {x_m_, y_m_, along_m_, reversed_, points_}, aside_m);
}

Progress SpeedCaps::Step(const Costmap& map, const SpeedParams& params,
                         const VehicleParams& vehicle, const WorldPath& path, int units,
                         const AreaSet* areas, const Terrain* terrain) {
  HP_LOOP_BOUND(kMaxUnits)
  for (int unit = 0; unit < units && point_ < points_; ++unit) {
    if (walker_ < walkers_.size()) {
      FileWalker(walkers_[walker_++], params);
    } else if (terrain != nullptr && !brows_.is_done()) {
      LookForBrows(map, *terrain, vehicle);
    } else if (chord_ < points_) {
      LookAlong(map, vehicle, path);
    } else if (uses_cells_ && row_ <= high_.y) {
      if (SearchRow(map)) {
        column_ = low_.x;
        ++row_;
      }
    } else if (SkipToZone(areas)) {
      CapInZone(*areas, params, path);
    } else {
      const float free_m = observed_m_ - AheadOf_m(point_) - along_m_[point_];
      Lower(point_, ReactionSpeedCap(params, free_m), CapCause::kUnseenGround);
      const float gentle_m = too_steep_m_ - AheadOf_m(point_) - along_m_[point_];
      Lower(point_, ReactionSpeedCap(params, gentle_m), CapCause::kSteepGround);
      const int hard2_cells2 = NearestHard2(map, path[point_]);
      if (hard2_cells2 < kMaxDistance2_cells2 &&
          static_cast<float>(hard2_cells2) <= room2_cells2_) {
        narrow_ = true;
        Lower(point_, params.min_speed_mps, CapCause::kLittleRoom);
      }
      room_m_[point_] = RoomFor(hard2_cells2);
      Lower(point_, RoomSpeedCap(params, room_m_[point_], BendAt(point_)), CapCause::kLittleRoom);
      if (reversed_[point_]) Lower(point_, max_reverse_mps_, CapCause::kReverse);
      CapForPersonAt(point_, params, vehicle);
      ++point_;
    }
  }
  return point_ < points_ ? Progress::kBusy : Progress::kDone;
}

void SpeedCaps::StandFrom(int point) {
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = point; k < points_; ++k) {
    const bool stands_before = k > point && cap_mps_[k - 1] <= 0.0f;
    if (stands_before) Lower(k, 0.0f, cause_[k - 1]);
    if (cap_mps_[k] <= kStanding_mps) Lower(k, 0.0f, cause_[k]);
  }
}

// Both ends included; 0: no limit.
void SpeedCaps::LimitBetween(int first, int last, float most_mps) {
  if (!(most_mps > 0.0f)) return;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = first; k <= last; ++k) Lower(k, most_mps, CapCause::kLegLimit);
}

void SpeedCaps::LimitLegs(const WorldPath& path, const Route& route, float reach_m) {
  int from = 0;
  HP_LOOP_BOUND(kMaxVias)
  for (const Via& via : route.vias) {
    const int at = PassingPoint(path, from, via.position_odom, reach_m);
    // The via may lie behind the point that is nearest to it.
    const bool has_next = at >= 0 && at + 1 < points_;
    LimitBetween(from, has_next ? at + 1 : points_ - 1, via.speed_mps);
    if (at < 0) return;
    from = at;
  }
  LimitBetween(from, points_ - 1, route.goal_speed_mps);
}

void SpeedCaps::Lower(int point, float cap_mps, CapCause cause) {
  if (cap_mps >= cap_mps_[point]) return;
  cap_mps_[point] = cap_mps;
  cause_[point] = cause;
}

// At the next place of a chord, or what is left of its tracks; behind the last point, and where a
// stretch in reverse ends, straight on, as far as the ground has to be observed before the edge of
// the vehicle that goes first.
void SpeedCaps::LookAlong(const Costmap& map, const VehicleParams& vehicle, const WorldPath& path) {
  const int point = chord_;
  const Pose2& from = path[point];
  const bool is_beyond = point + 1 == points_ || HasOverhang(point);
  const int behind = point > 0 ? point - 1 : 0;  // whose chord leads there
  const float length_m = is_beyond ? AheadOf_m(behind) : along_m_[point + 1] - along_m_[point];
  const bool ends_before = track_ == 0 && observed_m_ < kFar_m;
  if (ends_before || !HasLength(length_m)) return EndChord();
  const SinCosPair heading = SinCos(from.theta_rad);
  const float direction_of = reversed_[behind] ? -1.0f : 1.0f;
  Vec2 direction = {direction_of * heading.cos, direction_of * heading.sin};
  if (!is_beyond) {
    direction = {(path[point + 1].x_m - from.x_m) / length_m,
                 (path[point + 1].y_m - from.y_m) / length_m};
  }
  const Vec2 aside = {-vehicle.width_m * direction.y_m, vehicle.width_m * direction.x_m};
  const int samples = ClampInt(FloorToInt(Min(length_m / kSample_m, 1.0e6f)) + 1, 1, kMaxSamples);
  const float step_m = length_m / static_cast<float>(samples);
  const float on_m = step_m * static_cast<float>(sample_ + 1);
  const Vec2 place = {from.x_m + on_m * direction.x_m, from.y_m + on_m * direction.y_m};
  const float along_m = along_m_[point] + on_m;
  if (!LookAt(map, place, aside, along_m, step_m)) return;
  if (look_.grows) SlowDownIn(point);
  if (look_.is_hidden) CreepOver(look_.hidden_m, along_m);
  look_ = Look{};
  track_ = 0;
  if (++sample_ < samples) return;
  if (HasOverhang(point)) EndOverhang();
  EndChord();
}

// Whether a stretch in reverse ends at this point.
bool SpeedCaps::HasOverhang(int chord) const {
  const bool stands =
      chord > 0 && chord + 1 < points_ && !HasLength(along_m_[chord + 1] - along_m_[chord]);
  return stands && reversed_[chord - 1];
}

// The path leads on from where the vehicle turned back, not from beyond.
void SpeedCaps::EndOverhang() {
  const float along_m = along_m_[chord_];
  HP_LOOP_BOUND(kTracks)
  for (int track = 0; track < kTracks; ++track) {
    seen_m_[track] = Min(seen_m_[track], along_m);
    gap_from_m_[track] = Min(gap_from_m_[track], along_m);
  }
}

void SpeedCaps::EndChord() {
  ++chord_;
  sample_ = 0;
}

// From where the front is before such a stretch to where the rear has left it.
void SpeedCaps::CreepOver(float from_m, float to_m) {
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < points_; ++k) {
    const bool is_over =
        along_m_[k] + AheadOf_m(k) >= from_m && along_m_[k] - TrailingEdge_m(k) <= to_m;
    if (is_over) Lower(k, hidden_creep_mps_, CapCause::kHiddenGround);
  }
}

// The vehicle's front is in it before its middle is.
void SpeedCaps::SlowDownIn(int point) {
  const int next = point + 1 < points_ ? point + 1 : point;
  Lower(point, growth_speed_mps_, CapCause::kGrowth);
  Lower(next, growth_speed_mps_, CapCause::kGrowth);
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = point - 1; k >= 0 && along_m_[point] - along_m_[k] < LeadingEdge_m(k); --k) {
    Lower(k, growth_speed_mps_, CapCause::kGrowth);
  }
}

// On its tracks, up to the first that is not observed there: asking why costs as much as all of the
// rest. False: there are more.
bool SpeedCaps::LookAt(const Costmap& map, Vec2 place, Vec2 aside, float along_m, float step_m) {
  const auto cell_on = [&](int track) {
    const float side = kAside[track];
    return CellAt({place.x_m + side * aside.x_m, place.y_m + side * aside.y_m});
  };
  HP_LOOP_BOUND(kTracks)
  for (; track_ < kTracks; ++track_) {
    const Cell cell = cell_on(track_);
    const uint8_t flags =
        map.window.Contains(cell) ? map.flags[map.window.Index(cell)] : uint8_t{0};
    look_.grows = look_.grows || (flags & Costmap::kGrowth) != 0;
    if ((flags & Costmap::kObserved) == 0) break;
    seen_m_[track_] = along_m;
    gap_from_m_[track_] = along_m;
  }
  if (track_ == kTracks) return true;
  LookAtUnseen(IsHiddenAt(map, cell_on(track_), along_m), along_m, step_m);
  return ++track_ == kTracks;
}

void SpeedCaps::LookAtUnseen(bool is_hidden, float along_m, float step_m) {
  if (along_m > kCreepAhead_m && brows_.brow(track_).Hides(along_m)) {
    observed_m_ = Min(observed_m_, kCreepAhead_m);
    return;
  }
  if (is_hidden) gap_from_m_[track_] += step_m;
  if (along_m - gap_from_m_[track_] > max_unseen_m_) {
    observed_m_ = Min(observed_m_, seen_m_[track_]);
  } else if (along_m - seen_m_[track_] > max_unseen_m_) {
    look_.is_hidden = true;
    look_.hidden_m = Min(look_.hidden_m, seen_m_[track_]);
  }
}

// Not inlined: the loops of its lines are called from one place.
[[gnu::noinline]] bool SpeedCaps::IsHiddenAt(const Costmap& map, Cell cell, float along_m) const {
  if (!(hidden_creep_mps_ > 0.0f) || along_m > kCreepAhead_m) return false;
  return brows_.brow(track_).Hides(along_m) || IsHidden(map, lookouts_, cell);
}

// The least squared distance [cells^2] from the cells under the discs' middles to a hard one;
// kMaxDistance2_cells2: the map does not tell any from what is further.
int SpeedCaps::NearestHard2(const Costmap& map, const Pose2& pose) const {
  const SinCosPair heading = SinCos(pose.theta_rad);
  int nearest2_cells2 = kMaxDistance2_cells2;
  HP_LOOP_BOUND(Footprint::kMaxDiscs)
  for (int disc = 0; disc < footprint_.discs; ++disc) {
    const float ahead_m = footprint_.DiscAhead(disc);
    const Cell cell = CellAt({pose.x_m + ahead_m * heading.cos, pose.y_m + ahead_m * heading.sin});
    if (!map.window.Contains(cell)) continue;
    const int distance2_cells2 = map.hard_distance2[map.window.Index(cell)];
    if (distance2_cells2 < nearest2_cells2) nearest2_cells2 = distance2_cells2;
  }
  return nearest2_cells2;
}

// Distances are those of the cells' centres, which is what half a cell is for.
float SpeedCaps::RoomFor(int hard2_cells2) const {
  if (hard2_cells2 >= kMaxDistance2_cells2) return kFarRoom_m;
  const float room_m = Sqrt(static_cast<float>(hard2_cells2)) * kCellSize_m -
                       footprint_.disc_radius_m - 0.5f * kCellSize_m;
  return Clamp(room_m, 0.0f, kFarRoom_m);
}

// Between chords, as the speed planner takes it; a turn on the spot is none.
void SpeedCaps::FindBends(const WorldPath& path) {
  bend_per_m_[0] = 0.0f;
  bend_per_m_[points_ - 1] = 0.0f;
  HP_LOOP_BOUND(kMaxPathPoints - 2)
  for (int k = 1; k + 1 < points_; ++k) {
    const float before_m = along_m_[k] - along_m_[k - 1];
    const float behind_m = along_m_[k + 1] - along_m_[k];
    const float turn_rad = WrapAngle(path[k].theta_rad - path[k - 1].theta_rad);
    bend_per_m_[k] = Abs(CurvatureBetween(turn_rad, before_m, behind_m));
  }
}

float SpeedCaps::BendAt(int point) const {
  float most_per_m = bend_per_m_[point];
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = point - 1; k >= 0 && along_m_[point] - along_m_[k] <= kBendBehind_m; --k) {
    most_per_m = Max(most_per_m, bend_per_m_[k]);
  }
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = point + 1; k < points_ && along_m_[k] - along_m_[point] <= kBendAhead_m; ++k) {
    most_per_m = Max(most_per_m, bend_per_m_[k]);
  }
  return most_per_m;
}

// False: there were many cells of people, and the row is to be searched on. Not inlined, as
// FilePerson: its calls are counted (config/timing.toml).
[[gnu::noinline]] bool SpeedCaps::SearchRow(const Costmap& map) {
  const uint8_t* flags = &map.flags[map.window.Index({low_.x, row_})];
  int filed = 0;
  HP_LOOP_BOUND(kMapSize_cells)
  for (; column_ <= high_.x; ++column_) {
    if ((flags[column_ - low_.x] & Costmap::kPerson) == 0) continue;
    if (filed == kMaxPersonCells) return false;
    ++filed;
    FilePerson(CellCenter({column_, row_}));
  }
  return true;
}

// With the points that are nearest to a walker, and those where they can be before they are beside
// them.
[[gnu::noinline]] void SpeedCaps::FileWalker(const Walker& walker, const SpeedParams& params) {
  const float walk_mps = params.person_speed_mps;
  float* distance2 = distance2_m2_ + 1;
  float* late = late_m_ + 1;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < points_; ++k) {
    const Vec2 way = {x_m_[k] - walker.place_odom.x_m, y_m_[k] - walker.place_odom.y_m};
    const float way2_m2 = Squared(way.x_m) + Squared(way.y_m);
    const float way_m = Max(Sqrt(way2_m2), kWalkerBody_m);
    const float along_mps =
        (way.x_m * walker.velocity_mps.x_m + way.y_m * walker.velocity_mps.y_m) / way_m;
    const float towards_mps = Clamp(along_mps + walker.doubt_mps, -walk_mps, walk_mps);
    distance2[k] = way2_m2;
    late[k] = way_m - kWalkerBody_m + Squared(walk_mps - towards_mps) / (2.0f * kSetsOff_mps2);
  }
  distance2[-1] = distance2[0];
  distance2[points_] = distance2[points_ - 1];
  late[-1] = late[0];
  late[points_] = late[points_ - 1];
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < points_; ++k) {
    const bool is_nearest = (distance2[k] <= distance2[k - 1]) & (distance2[k] <= distance2[k + 1]);
    const bool is_first = (late[k] <= late[k - 1]) & (late[k] <= late[k + 1]);
    const float nearer_m2 = Min(person2_m2_[k], Squared(Max(late[k], 0.0f)));
    person2_m2_[k] = is_nearest || is_first ? nearer_m2 : person2_m2_[k];
  }
}

// With every point that is no further away than its neighbours: a path may go by more than once.
// Two loops without branches, for several points at a time: a crowd has many cells.
[[gnu::noinline]] void SpeedCaps::FilePerson(Vec2 person_odom) {
  float* distance2 = distance2_m2_ + 1;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < points_; ++k) {
    distance2[k] = Squared(person_odom.x_m - x_m_[k]) + Squared(person_odom.y_m - y_m_[k]);
  }
  distance2[-1] = distance2[0];
  distance2[points_] = distance2[points_ - 1];
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < points_; ++k) {
    const float here_m2 = distance2[k];
    const float known_m2 = person2_m2_[k];
    const float nearer_m2 = Min(known_m2, here_m2);
    const bool is_nearest = (here_m2 <= distance2[k - 1]) & (here_m2 <= distance2[k + 1]);
    person2_m2_[k] = is_nearest ? nearer_m2 : known_m2;
  }
}

// On to the next speed zone that is left to be looked at. False: there is none.
bool SpeedCaps::SkipToZone(const AreaSet* areas) {
  if (areas == nullptr) return false;
  HP_LOOP_BOUND(kMaxAreas)
  while (zone_ < areas->size() && (*areas)[zone_].kind != AreaKind::kSpeedZone) ++zone_;
  return zone_ < areas->size();
}

void SpeedCaps::CapInZone(const AreaSet& areas, const SpeedParams& params, const WorldPath& path) {
  const int k = zone_point_;
  const float before_m = k > 0 ? along_m_[k] - along_m_[k - 1] : 0.0f;
  const float behind_m = k + 1 < points_ ? along_m_[k + 1] - along_m_[k] : 0.0f;
  const float ends_m = Max(before_m, behind_m) + kZoneAhead_m;
  if (areas.IsInZone(zone_, footprint_, path[k], ends_m, params.track_error_m)) {
    Lower(k, areas[zone_].speed_mps, CapCause::kSpeedZone);
  }
  if (++zone_point_ < points_) return;
  zone_point_ = 0;
  ++zone_;
}

void SpeedCaps::CapForPersonAt(int point, const SpeedParams& params, const VehicleParams& vehicle) {
  if (person2_m2_[point] >= Squared(reach_m_)) return;
  const float lateral_m = Sqrt(person2_m2_[point]) - kHalfCellDiagonal_m - footprint_.disc_radius_m;
  const float ahead_m = ReachAhead(params, vehicle);
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < points_; ++k) {
    const float to_person_m = along_m_[point] - along_m_[k];
    if (to_person_m > ahead_m) continue;
    const float cap_mps =
        PersonSpeedCap(params, vehicle, to_person_m, lateral_m, speed_mps_, reversed_[k]);
    Lower(k, cap_mps, CapCause::kPerson);
  }
}

}  // namespace hardpack
