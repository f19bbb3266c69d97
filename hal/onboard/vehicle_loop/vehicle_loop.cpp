// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/vehicle_loop/vehicle_loop.h"

#include "core/autonomy/assured_sight.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/units.h"
#include "core/base/validate.h"
#include "hal/labels/labels.h"

namespace hardpack {

Status VehicleLoop::Configure(const VehicleConfig& config) {
  configured_ = false;
  index_ = 0;
  now_ns_ = 0;
  lidar_ns_ = 0;
  ins_ns_ = 0;
  operator_ns_ = 0;
  before_ns_ = 0;
  tick_s_ = 0.0f;
  is_gap_ = false;
  is_located_ = false;
  config_ = config;
  wishes_ = {};
  goals_.Clear();
  goal_index_ = 0;
  newest_ins_ = {};
  ins_rate_ = {};
  ins_rate_ns_ = 0;
  ins_speed_mps_ = 0.0f;
  ins_speed_ns_ = 0;
  operator_press_ = 0;
  has_position_ = false;
  ins_.Reset();
  tracking_output_ = {};
  permission_ = {};
  hash_ = {};
  counters_ = {};
  const OnboardParams& onboard = config.onboard;
  const ouster::Metadata& lidar = config.lidar;
  Status status = Graver(ins_time_.Configure(onboard.clock), lidar_time_.Configure(onboard.clock));
  if (IsUsable(status)) status = drives_.Configure(onboard.drive);
  if (IsUsable(status)) status = lidar_packets_.Configure(lidar);
  if (IsUsable(status)) status = LimitSpeed();
  if (IsUsable(status)) status = replanner_.Configure(config_.planner);
  if (IsUsable(status)) {
    status = odometry_.Configure(config.planner.vehicle, onboard.odometry, onboard.ins);
  }
  if (IsUsable(status)) status = map_from_odom_.Configure(onboard.map_from_odom, onboard.ins);
  if (IsUsable(status)) {
    status = tracker_.Configure(config.planner.vehicle, config_.planner.speed, onboard.odometry,
                                onboard.dynamics, onboard.tracking);
  }
  if (IsUsable(status)) status = supervisor_.Configure(onboard.safety);
  if (IsUsable(status)) status = ConfigureSafety();
  if (IsUsable(status) && ConflictOf(config).name != nullptr) status = Status::kParameterOutOfRange;
  if (IsUsable(status)) status = ConfigureSight();
  configured_ = IsUsable(status);
  return status;
}

// What a lidar sends in one period has to fit into what a tick may class, and into the datagrams
// that it takes. The metadata do not say how fast it turns: 20 times a second, or with 2048 columns
// 10 times.
ParameterConflict VehicleLoop::ConflictOf(const VehicleConfig& config) {
  const ParameterConflict first = FirstConflict(config.planner, config.perception, config.onboard);
  if (first.name != nullptr) return first;
  constexpr int32_t kMaxColumns_per_s = 2048 * 10;
  const TickParams& tick = config.onboard.tick;
  const int32_t columns_per_s = config.lidar.columns_per_frame * 20;
  const int32_t most_per_s = columns_per_s < kMaxColumns_per_s ? columns_per_s : kMaxColumns_per_s;
  const int32_t columns_per_packet = config.lidar.columns_per_packet;
  const int32_t others =
      kMaxInsDatagrams + (config.perception.mapping.use_labels != 0 ? kMaxLabelDatagrams : 0);
  const int32_t packets = kMaxDatagramsPerTick - others;
  if (most_per_s * tick.period_ms > tick.directions * 1000) {
    return {"tick.directions", "tick.period_ms",
            "at least the columns that the lidar (lidar.metadata) sends in it"};
  }
  if (most_per_s * tick.period_ms > packets * columns_per_packet * 1000) {
    return {"tick.period_ms", "lidar.metadata",
            "so short that a tick takes all packets that the lidar sends in it"};
  }
  return {};
}

// No faster than it sees what is low.
Status VehicleLoop::LimitSpeed() {
  if (FirstInvalidParameter(config_.planner) != nullptr) return Status::kParameterOutOfRange;
  const ouster::Metadata& lidar = config_.lidar;
  const auto beams = static_cast<size_t>(lidar.beams);
  const Status status = MakeBeamModel(
      {lidar.beam_altitude_deg, beams}, {lidar.beam_azimuth_deg, beams}, lidar.columns_per_frame,
      lidar.lidar_origin_to_beam_origin_m, lidar.sensor_from_lidar, beam_model_);
  if (!IsUsable(status)) return status;
  return LimitToAssuredSight(beam_model_, config_.perception, config_.planner.vehicle,
                             config_.planner.speed);
}

// With an empty map.
Status VehicleLoop::ConfigureMapper() {
  return mapper_.Configure(config_.perception, config_.planner.costmap, config_.labels, beam_model_,
                           config_.lidar.column_window_first, config_.lidar.column_window_last);
}

Status VehicleLoop::Tick(const TickInput& input, TickOutput& output) {
  output.frames.Clear();
  output.has_answer = false;
  if (!configured_) return Status::kNotStarted;
  if (IsRefused(input)) {
    ++counters_.refused_ticks;
    return Status::kInvalidArgument;
  }
  tick_s_ = static_cast<float>(config_.onboard.tick.period_ms) / kMillisecondsPerSecond;
  if (counters_.ticks > 0) {
    counters_.missed_ticks += input.index - index_ - 1;
    tick_s_ = Min(SecondsBetween(now_ns_, input.now_ns), kLongestTick_s);
  }
  before_ns_ = counters_.ticks > 0 ? now_ns_ : input.now_ns;
  ++counters_.ticks;
  index_ = input.index;
  now_ns_ = input.now_ns;
  wishes_ = {};
  mapper_.BeginTick(config_.onboard.tick.directions);
  columns_left_ = config_.onboard.tick.directions;
  labels_left_ = config_.onboard.tick.directions;
  ins_.BeginTick(kMaxInsMessages);
  may_resume_ = true;

  TakeFrames(input);
  TakeDatagrams(input, InputSource::kIns);
  AddPose();
  TakeDatagrams(input, InputSource::kLabels);
  TakeDatagrams(input, InputSource::kLidar);
  mapper_.Advance(now_ns_);
  TestReturns(true);
  AdvanceMount();
  TakeCommand(input.command, output);
  FollowEarth();
  AdvanceGoal();
  UpdatePlanner();
  FollowPlan();
  WatchMotion();
  sweep_advice_ = JudgeSweep();
  permission_ = supervisor_.Judge(Situation(input));
  if (permission_.drop_goal) DropGoals();
  if (output.has_answer && IsUsable(output.answer)) {
    output.answer = permission_.wish_status;
    output.reason = permission_.reason;
    if (!IsUsable(output.answer)) ++counters_.refused_commands;
  }
  Move();
  Command(output);
  StepPlanner();
  AddToHash(output);
  return Status::kOk;
}

bool VehicleLoop::IsRefused(const TickInput& input) {
  return (counters_.ticks > 0 && (input.index <= index_ || input.now_ns <= now_ns_)) ||
         input.datagrams.size() > kMaxDatagramsPerTick ||
         input.frames.size() > CanBus::kMaxFramesPerTick;
}

void VehicleLoop::TakeFrames(const TickInput& input) {
  HP_LOOP_BOUND(CanBus::kMaxFramesPerTick)
  for (const CanFrame& frame : input.frames) drives_.TakeFrame(frame, now_ns_);
}

void VehicleLoop::TakeDatagrams(const TickInput& input, InputSource source) {
  const auto place = static_cast<size_t>(source);
  HP_LOOP_BOUND(kMaxDatagramsPerTick)
  for (const TickDatagram& datagram : input.datagrams) {
    if (datagram.source != source) continue;
    ++counters_.datagrams[place];
    Status status = Status::kOk;
    if (source == InputSource::kIns) status = TakeIns(datagram.bytes);
    if (source == InputSource::kLabels) status = TakeLabels(datagram.bytes);
    if (source == InputSource::kLidar) status = TakeLidar(datagram.bytes);
    if (!IsUsable(status)) ++counters_.refused_datagrams[place];
  }
}

// A bridge cuts the stream where it likes: what comes before and behind a message is counted by the
// parser, and no reason to refuse a datagram.
Status VehicleLoop::TakeIns(std::span<const uint8_t> bytes) {
  if (bytes.size() > kMaxInsDatagram_bytes) return Status::kOversized;
  std::span<const uint8_t> rest = bytes;
  HP_LOOP_BOUND(kMaxInsFeeds)
  for (int feed = 0; feed < kMaxInsFeeds && !rest.empty(); ++feed) {
    rest = rest.subspan(ins_.Feed(rest));
    HP_LOOP_BOUND(kMaxInsMessages)
    for (int message = 0; message < kMaxInsMessages; ++message) {
      if (!IsUsable(ins_.Next(ins_sample_))) break;
      const uint64_t measured_ns = MeasuredAt(ins_sample_);
      if (measured_ns == 0) {
        ++counters_.untimed_ins;
        continue;
      }
      if (IsUsable(odometry_.TakeIns(ins_sample_, measured_ns))) NoteIns(measured_ns);
    }
  }
  return rest.empty() ? Status::kOk : Status::kCapacityExceeded;
}

// In our clock; now where the message has no stamp; 0: its clock is not to be relied upon, and the
// message may be of any time.
uint64_t VehicleLoop::MeasuredAt(const InsSample& sample) {
  if (!sample.has_timestamp) return now_ns_;
  const bool may_fix_anew = supervisor_.mode() == Mode::kStandby;
  const Status observed = ins_time_.Observe(sample.timestamp_ns, now_ns_, may_fix_anew);
  const Result<uint64_t> time_ns = ins_time_.ToHost(sample.timestamp_ns);
  if (observed == Status::kInvalidArgument || ins_time_.suspect() || !time_ns.ok()) return 0;
  return time_ns.value() < now_ns_ ? time_ns.value() : now_ns_;
}

// What the sample that was just taken says besides.
void VehicleLoop::NoteIns(uint64_t measured_ns) {
  newest_ins_ = ins_sample_;
  if (measured_ns > ins_ns_) ins_ns_ = measured_ns;
  if (ins_sample_.has_angular_rate) {
    ins_rate_ = ins_sample_.angular_rate;
    ins_rate_ns_ = measured_ns;
  }
  const InsStatus& ins = ins_sample_.status;
  const bool vouches_for_speed = ins_sample_.has_velocity && ins_sample_.has_status &&
                                 ins.mode == InsMode::kTracking && ins.gnss_fix &&
                                 !ins.gnss_error && !ins.imu_error;
  if (vouches_for_speed) {
    const VelocityNed& velocity = ins_sample_.velocity_ned;
    ins_speed_mps_ =
        Sqrt(velocity.north_mps * velocity.north_mps + velocity.east_mps * velocity.east_mps);
    ins_speed_ns_ = measured_ns;
  }
  if (!ins_sample_.has_position) return;
  ins_position_ = ins_sample_;
  has_position_ = true;
}

Status VehicleLoop::TakeLabels(std::span<const uint8_t> bytes) {
  labels::Header header;
  const Status status =
      labels::CheckDatagram(bytes, config_.lidar.beams, config_.lidar.columns_per_frame, header);
  if (!IsUsable(status)) return status;
  HP_LOOP_BOUND(labels::kMaxColumns)
  for (int i = 0; i < header.columns; ++i) {
    if (labels_left_ == 0) return Status::kCapacityExceeded;
    --labels_left_;
    if (!IsUsable(labels::DecodeColumn(header, bytes, i, labels_))) continue;
    if (!IsUsable(mapper_.AddLabels(labels_))) ++counters_.refused_labels;
    TestReturns(false);
  }
  return Status::kOk;
}

// The newest stamp of the packet, which was delayed the least.
Status VehicleLoop::ObserveLidarClock(std::span<const uint8_t> bytes) {
  const ouster::PacketLayout& layout = lidar_packets_.layout();
  const Status decoded =
      ouster::DecodeColumn(layout, bytes, layout.columns_per_packet - 1, column_);
  if (!IsUsable(decoded)) return Status::kOk;  // what an invalid column says is no stamp
  const bool may_fix_anew = supervisor_.mode() == Mode::kStandby;
  const Status status = lidar_time_.Observe(column_.timestamp_ns, now_ns_, may_fix_anew);
  if (status == Status::kClockJumped) ++counters_.clock_jumps;
  return status;
}

Status VehicleLoop::TakeLidar(std::span<const uint8_t> bytes) {
  ouster::PacketHeader header;
  Status status = lidar_packets_.Check(bytes, header);
  if (status == Status::kSensorRestarted && supervisor_.mode() == Mode::kStandby && may_resume_) {
    // Its clock began anew. What the sensor is and where it sits is taken to be as it was: the
    // operator sees the count, and has to arm again. Once in a tick: two sensors that send by turns
    // are none that restarts.
    may_resume_ = false;
    ++counters_.lidar_restarts;
    lidar_packets_.Resume();
    lidar_time_.Reset();
    status = lidar_packets_.Check(bytes, header);
  }
  if (!IsUsable(status)) return status;
  status = ObserveLidarClock(bytes);
  if (!IsUsable(status)) return status;
  const ouster::PacketLayout& layout = lidar_packets_.layout();
  HP_LOOP_BOUND(ouster::kMaxColumnsPerPacket)
  for (int i = 0; i < layout.columns_per_packet; ++i) {
    if (columns_left_ == 0) {
      ++counters_.refused_columns;
      if (!goals_.empty()) reaction_.Lost();
      continue;
    }
    --columns_left_;
    if (!IsUsable(ouster::DecodeColumn(layout, bytes, i, column_))) continue;
    if (lidar_time_.suspect()) {
      ++counters_.suspect_columns;
      continue;
    }
    const Result<uint64_t> time_ns = lidar_time_.ToHost(column_.timestamp_ns);
    if (!time_ns.ok() || !IsUsable(mapper_.AddColumn(column_, time_ns.value()))) {
      ++counters_.refused_columns;
      if (!goals_.empty()) reaction_.Lost();
      continue;
    }
    if (time_ns.value() > lidar_ns_) lidar_ns_ = time_ns.value();
    sight_.Take(column_, time_ns.value());
    TestReturns(true);
  }
  return Status::kOk;
}

// The pose of this tick, ahead of the columns that were taken before it. Where the vehicle went in
// a gap nobody knows: what was mapped before it no longer has a place.
void VehicleLoop::AddPose() {
  const uint32_t gaps = odometry_.gaps();
  const WheelFeedback wheels = drives_.feedback(now_ns_);
  const Status moved = odometry_.Advance(now_ns_, wheels);
  is_gap_ = odometry_.gaps() != gaps;
  if (is_gap_) {
    ++counters_.odometry_gaps;
    replanner_.Forget();
    static_cast<void>(ConfigureMapper());  // as when it was configured: it cannot fail
    map_from_odom_.Restart();
  }
  const StampedPose& pose = odometry_.pose();
  const uint32_t jumps = mapper_.counters().position_jumps;
  static_cast<void>(mapper_.AddPose(pose));
  if (!is_gap_ && mapper_.counters().position_jumps != jumps) {
    // The ground around is as good as never looked at: it begins anew as after a gap, and the
    // vehicle stops, rather than that it stands on unseen ground for good.
    is_gap_ = true;
    ++counters_.odometry_jumps;
    replanner_.Forget();
    static_cast<void>(ConfigureMapper());
    static_cast<void>(mapper_.AddPose(pose));
    map_from_odom_.Restart();
  }
  if (is_gap_) {
    corridor_.Reset();
    sweep_.Reset();
    has_start_ = false;
  }
  if (!has_start_) {
    has_start_ = true;
    start_odom_ = {pose.position.x_m, pose.position.y_m, pose.yaw_rad};
  }
  sweep_.Advance({pose.position.x_m, pose.position.y_m});
  corridor_.Advance({pose.position.x_m, pose.position.y_m}, static_cast<uint32_t>(index_));
  LocateInMap(pose);
  const BodyMotion body = {.valid = moved == Status::kOk,
                           .speed_mps = odometry_.speed_mps(),
                           .yaw_rate_radps = odometry_.yaw_rate_radps()};
  static_cast<void>(tracker_.Predict(now_ns_, {pose.position.x_m, pose.position.y_m, pose.yaw_rad},
                                     wheels, body));
}

void VehicleLoop::LocateInMap(const StampedPose& pose) {
  const Pose2 pose_odom = {pose.position.x_m, pose.position.y_m, pose.yaw_rad};
  if (has_position_) {
    static_cast<void>(
        map_from_odom_.TakeIns(ins_position_, pose_odom, odometry_.driven_m(), now_ns_));
  }
  has_position_ = false;
  map_from_odom_.Advance(now_ns_, pose_odom);
}

void VehicleLoop::AddToHash(const TickOutput& output) {
  hash_.AddU64(index_);
  hash_.AddU8(static_cast<uint8_t>(permission_.mode));
  hash_.AddU8(static_cast<uint8_t>(permission_.reason));
  hash_.AddU8(static_cast<uint8_t>(permission_.motion));
  hash_.AddU8(output.has_answer ? static_cast<uint8_t>(output.answer) : uint8_t{0xff});
  hash_.AddFloat(odometry_.pose().position.x_m);
  hash_.AddFloat(odometry_.pose().position.y_m);
  hash_.AddFloat(odometry_.pose().yaw_rad);
  HP_LOOP_BOUND(kMaxFramesOut)
  for (const CanFrame& frame : output.frames) {
    hash_.AddU32(frame.id);
    hash_.AddU8(frame.size);
    HP_LOOP_BOUND(kMaxCanData_bytes)
    for (int i = 0; i < frame.size && i < kMaxCanData_bytes; ++i) hash_.AddU8(frame.data[i]);
  }
}

}  // namespace hardpack
