// SPDX-License-Identifier: Apache-2.0
// Any bytes as a drive: a script of operations on a Mapper and on costmap builds beside it. After
// every operation the books of the ring are checked, after every build the map and the grid. A
// second mapper, new before every Configure, takes the same script: what Configure leaves behind of
// earlier scripts would show as a difference.
//   byte 0  whether there is a second mapper
//   byte 1  operations between two checks of all columns
//   then Configure's bytes, then operations: a byte that names it (Drive::Step), its arguments.
//   Past the end of the bytes every argument is 0.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <type_traits>
#include <vector>

#include "core/autonomy/mapper.h"
#include "core/costmap/costmap.h"
#include "core/scan/scan.h"
#include "test/fuzz/mapper_script.h"
#include "test/loop_count/counted_beams.h"

namespace hardpack {
namespace {

bool IsOneOf(Status status, std::initializer_list<Status> documented) {
  for (const Status known : documented) {
    if (status == known) return true;
  }
  return false;
}

bool Same(const MapperCounters& a, const MapperCounters& b) {
  static_assert(std::has_unique_object_representations_v<MapperCounters>);
  return std::memcmp(&a, &b, sizeof a) == 0;
}

// The mapper of all scripts, one that is as `fresh` before every Configure, and `fresh` itself.
struct Stages {
  Mapper mapper;
  Mapper twin;
  Mapper fresh;
  CostmapBuilder builder;
};

class Drive {
 public:
  Drive(Script& script, Stages& stages)
      : script_(script),
        stages_(stages),
        mapper_(stages.mapper),
        twin_(stages.twin),
        builder_(stages.builder) {
    has_twin_ = script.Byte() % 2 == 1;
    check_every_ = 1 + script.Byte() % 32;
    Configure();
  }

  void Run() {
    constexpr int kMostSteps = 200;
    for (int step = 0; step < kMostSteps && !script_.ended() && work_ < kMostWork; ++step) {
      Step();
      CheckCounters();
      if (step % check_every_ == 0) CheckColumns();
    }
    CheckColumns();
    EndBuild();
    if (mapper_.started()) Finish();
    CheckGrid(mapper_.heights());
    if (has_twin_) CheckTwin();
  }

 private:
  static constexpr int kMostWork = 1 << 15;  // returns looked at
  static constexpr int kMostBuilds = 1;
  static constexpr int kMostConfigures = 3;

  void Step() {
    switch (script_.Byte() % 16) {
      case 0:
      case 1:
      case 2:
        return GiveColumns();
      case 3:
        return GiveStrangeColumn();
      case 4:
        return GivePoses();
      case 5:
        return GiveStrangePose();
      case 6:
      case 7:
        return GiveLabels();
      case 8:
        return GiveStrangeLabels();
      case 9:
        return Advance(now_ns_ + script_.Byte() * 2'000'000u);
      case 10:
        return Advance(script_.Eight());
      case 11:
        return BeginBuild();
      case 12:
        return EndBuild();
      case 13:
        return Leap();
      case 14:
        return script_.Byte() % 4 == 0 ? Finish() : GiveColumns();
      default:
        return script_.Byte() % 4 == 0 ? Configure() : GivePoses();
    }
  }

  void Configure() {
    if (configures_++ >= kMostConfigures) return;
    EndBuild();
    CountedBeams::Set(kMaxBeams);
    MakeSetup(script_, setup_);
    const Setup& s = setup_;
    const Status done =
        mapper_.Configure(s.params, s.rule, s.table, s.model, s.window_first, s.window_last);
    Require(IsOneOf(done, {Status::kOk, Status::kParameterOutOfRange, Status::kInvalidArgument,
                           Status::kCapacityExceeded}));
    Require(mapper_.started() == IsUsable(done));
    if (IsUsable(done)) CountedBeams::Set(s.model.beams);
    if (has_twin_) {
      twin_ = stages_.fresh;
      Require(twin_.Configure(s.params, s.rule, s.table, s.model, s.window_first, s.window_last) ==
              done);
    }
    constexpr uint64_t kStarts_ns[] = {1'000'000'000, 0, uint64_t{1} << 63,
                                       UINT64_MAX - 400'000'000};
    now_ns_ = kStarts_ns[script_.Byte() % std::size(kStarts_ns)];
    x_m_ = script_.Byte() < 250 ? 0.0f : 838800.0f;
    dropped_ = 0;
    seen_.assign(static_cast<size_t>(mapper_.ring().slots()), Seen{});
    GivePose(Here());
  }

  uint32_t Columns() const {
    const int32_t columns = setup_.model.columns_per_revolution;
    return columns > 0 ? static_cast<uint32_t>(columns) : 1;
  }

  StampedPose Here() const {
    StampedPose pose;
    pose.time_ns = now_ns_;
    pose.position = {x_m_, 0.3f * x_m_, z_m_};
    pose.yaw_rad = yaw_rad_;
    return pose;
  }

  void GivePoses() {
    const int count = 1 + script_.Byte() % 8;
    const float step_m = 0.002f * static_cast<float>(static_cast<int8_t>(script_.Byte()));
    const float turn_rad = 0.001f * static_cast<float>(static_cast<int8_t>(script_.Byte()));
    for (int i = 0; i < count; ++i) {
      now_ns_ += kTick_ns;
      x_m_ += step_m;
      yaw_rad_ += turn_rad;
      GivePose(Here());
    }
  }

  void GiveStrangePose() {
    StampedPose pose = Here();
    const uint8_t what = script_.Byte();
    if ((what & 1) != 0) z_m_ += 0.05f * static_cast<float>(static_cast<int8_t>(script_.Byte()));
    if ((what & 2) != 0) x_m_ += static_cast<float>(static_cast<int8_t>(script_.Byte()));
    if ((what & 4) == 0) now_ns_ += script_.Byte() * 1'000'000u;
    if ((what & 3) != 0) pose = Here();
    if ((what & 8) != 0)
      pose.time_ns =
          now_ns_ + static_cast<uint64_t>(static_cast<int8_t>(script_.Byte())) * 1'000'000u;
    if ((what & 16) != 0) pose.position.x_m = script_.Any();
    if ((what & 32) != 0) pose.position.z_m = script_.Any();
    if ((what & 64) != 0) pose.roll_rad = pose.pitch_rad = script_.Any();
    if ((what & 128) != 0) pose.time_ns = script_.Eight();
    GivePose(pose);
  }

  void GivePose(const StampedPose& pose) {
    const uint32_t pending = Pending();
    const bool held = mapper_.ring().newest_sequence() >= 0;
    const Status taken = mapper_.AddPose(pose);
    Require(mapper_.started() ? IsOneOf(taken, {Status::kOk, Status::kNotFinite,
                                                Status::kInvalidArgument, Status::kDuplicate})
                              : taken == Status::kNotStarted);
    // A jump of the position, or too many of the height, empty the map and the way to it.
    if (held && mapper_.ring().newest_sequence() < 0) dropped_ += pending;
    if (IsUsable(taken)) {
      Require(mapper_.poses().newest().time_ns == pose.time_ns);
      const Vec2 place = {pose.position.x_m, pose.position.y_m};
      Require(mapper_.heights().window() == GridWindow::CenteredAt(place));
      Require(mapper_.heights().At(CellAt(place)).ground);
    }
    if (has_twin_) Require(twin_.AddPose(pose) == taken);
  }

  // A stretch of columns, in order with steps, some of them late.
  void GiveColumns() {
    const int count = 1 + script_.Byte() % 128;
    const uint8_t how = script_.Byte();
    const uint32_t step = how % 8 == 7 ? script_.Byte() : 1 + (how % 8 == 6);
    const uint32_t back = (how & 8) != 0 ? script_.Two() : 0;
    const uint32_t column_ns = (how & 16) != 0 ? script_.Four() % 50'000'000u : 50'000u;
    const uint8_t scene = script_.Byte();
    Noise noise(script_.Byte());
    const uint32_t columns = Columns();
    for (int i = 0; i < count && work_ < kMostWork; ++i) {
      index_ += step;
      const uint64_t index = index_ - back;
      column_.frame_id = static_cast<uint16_t>(index / columns);
      column_.measurement_id = static_cast<uint16_t>(index % columns);
      column_.valid = true;
      column_.beams = setup_.model.beams;
      FillRanges(scene, noise);
      now_ns_ += column_ns;
      GiveColumn(now_ns_);
      if (i % 64 == 63) GivePose(Here());
    }
  }

  // Level ground under the sensor, and things on it.
  void FillRanges(uint8_t scene, Noise& noise) {
    column_.returns = 1 + (scene & 1);
    const uint32_t wall_mm = 1500 + 100 * (noise.Next() % (1 + scene));
    for (int row = 0; row < setup_.model.beams; ++row) {
      const float fall = -setup_.model.sin_altitude[row];
      uint32_t range_mm = fall > 0.02f ? static_cast<uint32_t>(1320.0f / fall) : 0;
      const uint32_t kind = noise.Next() % 64;
      const bool wall = (scene & 2) != 0 && (range_mm == 0 || range_mm > wall_mm);
      if (wall) range_mm = wall_mm + noise.Next() % 200;
      if ((scene & 4) != 0) range_mm = noise.Next() % 40'000;
      if (kind == 0) range_mm = noise.Next();
      if (kind == 1) range_mm = 0;
      column_.range_mm[row] = range_mm;
      column_.second_range_mm[row] = noise.Next() % 50'000;
    }
  }

  void GiveStrangeColumn() {
    const uint8_t what = script_.Byte();
    if ((what & 1) != 0) column_.frame_id = script_.Two();
    if ((what & 2) != 0) column_.measurement_id = script_.Two();
    if ((what & 4) != 0) column_.valid = script_.Byte() % 2 == 0;
    if ((what & 8) != 0) column_.beams = static_cast<int32_t>(script_.Four());
    if ((what & 16) != 0) column_.returns = static_cast<int32_t>(script_.Four());
    if ((what & 32) != 0) column_.range_mm[script_.Byte() % kMaxBeams] = script_.Four();
    if ((what & 64) != 0)
      column_.frame_id = static_cast<uint16_t>(column_.frame_id + script_.Byte());
    GiveColumn((what & 128) != 0 ? script_.Eight() : now_ns_);
    column_.beams = setup_.model.beams;
  }

  void GiveColumn(uint64_t time_ns) {
    const int64_t newest = mapper_.ring().newest_sequence();
    const Status taken = mapper_.AddColumn(column_, time_ns);
    Require(mapper_.started()
                ? IsOneOf(taken, {Status::kOk, Status::kNoPose, Status::kSensorRestarted,
                                  Status::kColumnInvalid, Status::kBadColumn, Status::kDuplicate,
                                  Status::kLate})
                : taken == Status::kNotStarted);
    if (has_twin_) Require(twin_.AddColumn(column_, time_ns) == taken);
    if (taken != Status::kOk) return;
    Accepted("columns");
    const Result<int64_t> sequence =
        mapper_.ring().SequenceOf(column_.frame_id, column_.measurement_id);
    Require(sequence.ok() && mapper_.ring().Holds(sequence.value()));
    // After a gap there is much to look at.
    const int64_t directions = sequence.value() - newest;
    work_ += mapper_.ring().beams() * static_cast<int>(directions < 1     ? 1
                                                       : directions < 100 ? directions
                                                                          : 100);
  }

  // Of the last columns, from `age` ago on.
  void GiveLabels() {
    const int count = 1 + script_.Byte() % 128;
    const uint32_t age = script_.Two();
    const uint8_t code = script_.Byte();
    Noise noise(code);
    const uint32_t columns = Columns();
    for (int i = 0; i < count; ++i) {
      ColumnLabels labels;
      const uint64_t index = index_ - age + static_cast<uint32_t>(i);
      labels.frame_id = static_cast<uint16_t>(index / columns);
      labels.measurement_id = static_cast<uint16_t>(index % columns);
      labels.beams = setup_.model.beams;
      for (uint8_t& label : labels.label) {
        label = code < 40 ? code : static_cast<uint8_t>(noise.Next() % 34);
      }
      GiveLabelled(labels);
    }
  }

  void GiveStrangeLabels() {
    ColumnLabels labels;
    const uint8_t what = script_.Byte();
    labels.frame_id = (what & 1) != 0 ? script_.Two() : column_.frame_id;
    labels.measurement_id = (what & 2) != 0 ? script_.Two() : column_.measurement_id;
    labels.beams = (what & 4) != 0 ? static_cast<int32_t>(script_.Four()) : setup_.model.beams;
    for (uint8_t& label : labels.label) label = what;
    GiveLabelled(labels);
  }

  void GiveLabelled(const ColumnLabels& labels) {
    work_ += 16;
    const Status taken = mapper_.AddLabels(labels);
    Require(mapper_.started()
                ? IsOneOf(taken, {Status::kOk, Status::kInvalidArgument, Status::kBadColumn,
                                  Status::kDuplicate, Status::kLate})
                : taken == Status::kNotStarted);
    if (has_twin_) Require(twin_.AddLabels(labels) == taken);
    if (taken != Status::kOk) return;
    Accepted("labels");
    const ScanRing& ring = mapper_.ring();
    const int slot = ring.SlotOf(ring.SequenceOf(labels.frame_id, labels.measurement_id).value());
    Require(ring.column(slot).labelled);
    Require(ring.column(slot).state != ColumnState::kAbsent);
    if (ring.column(slot).state != ColumnState::kFolded) return;
    for (int row = 0; row < ring.beams(); ++row) {
      Cell cell;
      if (PersonAt(slot, row, cell)) Require(mapper_.heights().At(cell).person);
    }
  }

  // Whether a return is a person's, on the map and not above the clearance; and its cell.
  bool PersonAt(int slot, int row, Cell& cell) const {
    const ScanColumn& column = mapper_.ring().column(slot);
    const PackedReturn packed = mapper_.ring().at(slot, row);
    if (packed.range_mm() == 0 || packed.return_class() != ReturnClass::kPerson) return false;
    const float clearance_cm = setup_.rule.clearance_height_m * 100.0f;
    const bool overhead = setup_.rule.obstacle_rule != ObstacleRule::kInCell &&
                          packed.height_known() &&
                          static_cast<float>(packed.height_cm()) > clearance_cm - 1.0f;
    const SinCosPair encoder = EncoderSinCos(setup_.model, column.measurement_id);
    const Vec3 point =
        column.odom_from_sensor.Apply(PointInSensor(setup_.model, encoder, row, packed.range_mm()));
    Require(IsFinite(point.x_m) && IsFinite(point.y_m) && IsFinite(point.z_m));
    cell = CellAt({point.x_m, point.y_m});
    return !overhead && mapper_.heights().window().Contains(cell);
  }

  void Advance(uint64_t now_ns) {
    mapper_.Advance(now_ns);
    if (has_twin_) twin_.Advance(now_ns);
  }

  // Time without measurements, and a gap in the counting.
  void Leap() {
    const uint8_t what = script_.Byte();
    const uint32_t columns = Columns();
    if ((what & 1) != 0) now_ns_ += script_.Four();
    if ((what & 2) != 0) index_ += script_.Two();
    if ((what & 4) != 0) index_ += uint64_t{script_.Two()} * columns;
    if ((what & 8) != 0) index_ += uint64_t{script_.Byte() % 100u} * columns;
    if ((what & 16) != 0) index_ = script_.Eight() % (uint64_t{1} << 62);
  }

  void Finish() {
    mapper_.Finish();
    if (has_twin_) twin_.Finish();
    Require(!mapper_.started() || Pending() == 0);
  }

  // The heights of a build, in pieces: the rest of the script goes on in between.
  void BeginBuild() {
    if (!mapper_.started()) return;
    const int units = script_.Byte() * 8;
    if (!building_) {
      if (builds_++ >= kMostBuilds) return;
      Require(builder_.Begin(mapper_.heights(), setup_.rule) == Status::kOk);
      fold_count_ = mapper_.fold_count();
      building_ = true;
    }
    static_cast<void>(builder_.StepHeights(mapper_.heights(), units));
  }

  void EndBuild() {
    if (!building_) return;
    building_ = false;
    Require(builder_.StepHeights(mapper_.heights(), CostmapBuilder::kHeightUnits) ==
            Progress::kDone);
    const ScanRing& ring = mapper_.ring();
    for (int slot = 0; slot < ring.slots(); ++slot) {
      mapper_.MarkPending(slot, fold_count_, builder_);
    }
    const uint8_t portion = script_.Byte();
    if (portion != 0) static_cast<void>(builder_.StepCells(portion));
    Require(builder_.StepCells(CostmapBuilder::kCellUnits) == Progress::kDone);
    CheckMap(builder_.result());
    for (int slot = 0; slot < ring.slots(); ++slot) CheckPersons(slot);
  }

  void CheckPersons(int slot) const {
    const ScanColumn& column = mapper_.ring().column(slot);
    const bool classed = column.state == ColumnState::kClassed;
    const bool folded_since = column.state == ColumnState::kFolded &&
                              static_cast<int32_t>(column.fold_count - fold_count_) >= 0;
    if (!classed && !folded_since) return;
    const Costmap& map = builder_.result();
    for (int row = 0; row < mapper_.ring().beams(); ++row) {
      Cell cell;
      if (!PersonAt(slot, row, cell) || !map.window.Contains(cell)) continue;
      Require((map.flags[map.window.Index(cell)] & Costmap::kPerson) != 0);
    }
  }

  uint32_t Pending() const {
    uint32_t pending = 0;
    for (int slot = 0; slot < mapper_.ring().slots(); ++slot) {
      const ColumnState state = mapper_.ring().column(slot).state;
      pending += state == ColumnState::kRaw || state == ColumnState::kClassed ? 1 : 0;
    }
    return pending;
  }

  // Every column that was filed is folded, on its way, or was dropped with the map.
  void CheckCounters() const {
    if (!mapper_.started()) return;
    const MapperCounters& counters = mapper_.counters();
    const uint32_t folded = counters.folded_with_labels + counters.folded_without_labels;
    Require(folded == mapper_.fold_count());
    Require(folded + Pending() + dropped_ == mapper_.ring().counters().columns);
  }

  // A column's way leads forward only, and a slot's next column has a greater number.
  void CheckColumns() {
    const ScanRing& ring = mapper_.ring();
    Require(static_cast<size_t>(ring.slots()) == seen_.size());
    for (int slot = 0; slot < ring.slots(); ++slot) {
      const ScanColumn& column = ring.column(slot);
      Seen& seen = seen_[static_cast<size_t>(slot)];
      if (column.sequence < 0) continue;
      Require(column.sequence % ring.slots() == slot && column.sequence <= ring.newest_sequence());
      Require(column.state != ColumnState::kAbsent);
      if (column.sequence == seen.sequence) {
        Require(column.state >= seen.state && column.labelled >= seen.labelled);
      } else {
        Require(column.sequence > seen.sequence);
      }
      seen = {column.sequence, column.state, column.labelled};
    }
  }

  void CheckTwin() const {
    Require(mapper_.started() == twin_.started());
    if (!mapper_.started()) return;
    Require(Same(mapper_.counters(), twin_.counters()));
    const GridWindow& window = mapper_.heights().window();
    Require(window == twin_.heights().window());
    for (int index = 0; index < kMapCells; ++index) {
      const Cell cell = window.FromIndex(index);
      const HeightGrid::CellHeights a = mapper_.heights().At(cell);
      const HeightGrid::CellHeights b = twin_.heights().At(cell);
      Require(a.lowest_cm == b.lowest_cm && a.lowest_hard_cm == b.lowest_hard_cm &&
              a.highest_hard_cm == b.highest_hard_cm && a.highest_soft_cm == b.highest_soft_cm &&
              a.ground == b.ground && a.person == b.person);
    }
  }

  struct Seen {
    int64_t sequence = -1;
    ColumnState state = ColumnState::kAbsent;
    bool labelled = false;
  };

  Script& script_;
  Stages& stages_;
  Mapper& mapper_;
  Mapper& twin_;
  CostmapBuilder& builder_;
  bool has_twin_ = false;
  bool building_ = false;
  int check_every_ = 1;
  int work_ = 0;
  int builds_ = 0;
  int configures_ = 0;
  uint32_t fold_count_ = 0;
  uint32_t dropped_ = 0;
  uint64_t index_ = uint64_t{1} << 20;
  uint64_t now_ns_ = 0;
  float x_m_ = 0.0f;
  float z_m_ = 0.0f;
  float yaw_rad_ = 0.0f;
  Setup setup_;
  LidarColumn column_;
  std::vector<Seen> seen_;
};

}  // namespace
}  // namespace hardpack

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const auto stages = std::make_unique<hardpack::Stages>();
  hardpack::Script script(data, size);
  hardpack::Drive(script, *stages).Run();
  return 0;
}
