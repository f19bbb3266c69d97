// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/loop_bound.h"
#include "hal/onboard/vehicle_loop/vehicle_loop.h"

// The functions of BasicVehicleLoop, for the one source file that instantiates it for a vehicle.

namespace hardpack {

template <VehicleType Vehicle>
Status BasicVehicleLoop<Vehicle>::Configure(const Config& config) {
  configured_ = false;
  Forget();
  lidar_config_ = config.lidar;
  ins_.Reset();
  const OnboardParams& onboard = config.onboard;
  Status status = Graver(ins_time_.Configure(onboard.clock), lidar_time_.Configure(onboard.clock));
  if (IsUsable(status))
    status = drives_.Configure(config.planner.vehicle, Drives::ParamsOf(onboard));
  if (IsUsable(status)) status = lidar_.Configure(config.lidar);
  if (IsUsable(status)) status = Pilot::Configure(config, Lidar::LayoutOf(lidar_config_));
  if (IsUsable(status) && ConflictOf(config).name != nullptr) status = Status::kParameterOutOfRange;
  configured_ = IsUsable(status);
  return status;
}

// What a lidar sends in one period must fit into what a tick may class, and into the datagrams that
// a tick takes.
template <VehicleType Vehicle>
ParameterConflict BasicVehicleLoop<Vehicle>::ConflictOf(const Config& config) {
  const ParameterConflict first = FirstConflict(config.planner, config.perception, config.onboard);
  if (first.name != nullptr) return first;
  const TickParams& tick = config.onboard.tick;
  const int32_t most_per_s = Lidar::MostColumnsPerSecond(config.lidar);
  const int32_t columns_per_datagram = Lidar::LayoutOf(config.lidar).window.columns_per_datagram;
  const int32_t others =
      kMaxInsDatagrams + (config.perception.mapping.use_labels != 0 ? kMaxLabelDatagrams : 0);
  const int32_t datagrams = kMaxDatagramsPerTick - others;
  if (most_per_s * tick.period_ms > tick.directions * 1000) {
    return {"tick.directions", "tick.period_ms",
            "at least the columns that the lidar (lidar.metadata) sends in it"};
  }
  if (most_per_s * tick.period_ms > datagrams * columns_per_datagram * 1000) {
    return {"tick.period_ms", "lidar.metadata",
            "so short that a tick takes all packets that the lidar sends in it"};
  }
  return {};
}

template <VehicleType Vehicle>
Status BasicVehicleLoop<Vehicle>::Tick(const TickInput& input, TickOutput& output) {
  output.frames.Clear();
  output.has_answer = false;
  if (!configured_) return Status::kNotStarted;
  if (IsRefused(input)) {
    ++counters_.refused_ticks;
    return Status::kInvalidArgument;
  }
  if (counters_.ticks > 0) counters_.missed_ticks += input.index - index() - 1;
  ++counters_.ticks;
  BeginTick(input.index, input.now_ns);

  const DriveFeedback drives = Sense(input);
  Localise(drives.wheels);
  Map(input);
  Decide(input.command, drives, IsUp(input.bus), output);
  Send(Act(), output);

  PlanOn();
  AddToHash(output);
  return Status::kOk;
}

template <VehicleType Vehicle>
bool BasicVehicleLoop<Vehicle>::IsRefused(const TickInput& input) const {
  return (counters_.ticks > 0 && (input.index <= index() || input.now_ns <= now_ns())) ||
         input.datagrams.size() > kMaxDatagramsPerTick ||
         input.frames.size() > CanBus::kMaxFramesPerTick;
}

// Takes the data of the drives and the INS.
template <VehicleType Vehicle>
DriveFeedback BasicVehicleLoop<Vehicle>::Sense(const TickInput& input) {
  HP_LOOP_BOUND(CanBus::kMaxFramesPerTick)
  for (const CanFrame& frame : input.frames) drives_.TakeFrame(frame, now_ns());
  ins_.BeginTick(kMaxInsMessages);
  TakeDatagrams(input, InputSource::kIns);
  return drives_.State(now_ns());
}

// Takes the data of the lidar, and its labels.
template <VehicleType Vehicle>
void BasicVehicleLoop<Vehicle>::Map(const TickInput& input) {
  columns_left_ = config().onboard.tick.directions;
  labels_left_ = config().onboard.tick.directions;
  may_resume_ = true;
  TakeDatagrams(input, InputSource::kLabels);
  TakeDatagrams(input, InputSource::kLidar);
  FinishMap();
}

template <VehicleType Vehicle>
void BasicVehicleLoop<Vehicle>::Send(const DriveDemand& demand, TickOutput& output) {
  drives_.Tick(now_ns(), demand, output.frames);
}

template <VehicleType Vehicle>
void BasicVehicleLoop<Vehicle>::AddToHash(const TickOutput& output) {
  Pilot::AddToHash(output);
  HP_LOOP_BOUND(kMaxFramesOut)
  for (const CanFrame& frame : output.frames) {
    hash_.AddU32(frame.id);
    hash_.AddU8(frame.size);
    HP_LOOP_BOUND(kMaxCanData_bytes)
    for (int i = 0; i < frame.size && i < kMaxCanData_bytes; ++i) hash_.AddU8(frame.data[i]);
  }
}

template <VehicleType Vehicle>
void BasicVehicleLoop<Vehicle>::TakeDatagrams(const TickInput& input, InputSource source) {
  HP_LOOP_BOUND(kMaxDatagramsPerTick)
  for (const TickDatagram& datagram : input.datagrams) {
    if (datagram.source == source) TakeDatagram(datagram);
  }
}

template <VehicleType Vehicle>
void BasicVehicleLoop<Vehicle>::TakeDatagram(const TickDatagram& datagram) {
  const auto place = static_cast<size_t>(datagram.source);
  ++counters_.datagrams[place];
  Status status = Status::kOk;
  if (datagram.source == InputSource::kIns) status = TakeIns(datagram.bytes);
  if (datagram.source == InputSource::kLabels) status = TakeLabels(datagram.bytes);
  if (datagram.source == InputSource::kLidar) status = TakeLidar(datagram.bytes);
  if (!IsUsable(status)) ++counters_.refused_datagrams[place];
}

// A bridge cuts the stream anywhere: bytes before and after a message are counted by the parser and
// are no reason to refuse a datagram.
template <VehicleType Vehicle>
Status BasicVehicleLoop<Vehicle>::TakeIns(std::span<const uint8_t> bytes) {
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
      Pilot::TakeIns(ins_sample_, measured_ns);
    }
  }
  return rest.empty() ? Status::kOk : Status::kCapacityExceeded;
}

// Time of measurement in our clock; now if the message has no stamp; 0: its clock is unreliable,
// and the message may be from any time.
template <VehicleType Vehicle>
uint64_t BasicVehicleLoop<Vehicle>::MeasuredAt(const InsSample& sample) {
  if (!sample.has_timestamp) return now_ns();
  const Status observed = ins_time_.Observe(sample.timestamp_ns, now_ns(), MayFixClocks());
  const Result<uint64_t> time_ns = ins_time_.ToHost(sample.timestamp_ns);
  if (observed == Status::kInvalidArgument || ins_time_.suspect() || !time_ns.ok()) return 0;
  return time_ns.value() < now_ns() ? time_ns.value() : now_ns();
}

template <VehicleType Vehicle>
Status BasicVehicleLoop<Vehicle>::TakeLabels(std::span<const uint8_t> bytes) {
  labels::Header header;
  const BeamModel& model = mapper().model();
  const Status status =
      labels::CheckDatagram(bytes, model.beams, model.columns_per_revolution, header);
  if (!IsUsable(status)) return status;
  const int columns = header.columns < labels_left_ ? header.columns : labels_left_;
  labels_left_ -= columns;
  HP_LOOP_BOUND(labels::kMaxColumns)
  for (int i = 0; i < columns; ++i) TakeLabelColumn(header, bytes, i);
  return columns == header.columns ? Status::kOk : Status::kCapacityExceeded;
}

template <VehicleType Vehicle>
void BasicVehicleLoop<Vehicle>::TakeLabelColumn(const labels::Header& header,
                                                std::span<const uint8_t> bytes, int index) {
  if (IsUsable(labels::DecodeColumn(header, bytes, index, labels_))) Pilot::TakeLabels(labels_);
}

// The newest stamp of the datagram, which was delayed the least.
template <VehicleType Vehicle>
Status BasicVehicleLoop<Vehicle>::ObserveLidarClock(std::span<const uint8_t> bytes) {
  const Status decoded = lidar_.Decode(bytes, lidar_.columns() - 1, column_);
  if (!IsUsable(decoded)) return Status::kOk;  // an invalid column has no stamp
  const Status status = lidar_time_.Observe(column_.timestamp_ns, now_ns(), MayFixClocks());
  if (status == Status::kClockJumped) ++counters_.clock_jumps;
  return status;
}

// A sensor whose clock has restarted is assumed to be the same sensor in the same place: the
// operator sees the count, and has to arm again. Once per tick: two sensors that send alternately
// do not count as one that restarts.
template <VehicleType Vehicle>
Status BasicVehicleLoop<Vehicle>::CheckLidar(std::span<const uint8_t> bytes) {
  const Status status = lidar_.Check(bytes);
  if (status != Status::kSensorRestarted || !MayFixClocks() || !may_resume_) return status;
  may_resume_ = false;
  ++counters_.lidar_restarts;
  lidar_.Resume();
  lidar_time_.Reset();
  return lidar_.Check(bytes);
}

template <VehicleType Vehicle>
Status BasicVehicleLoop<Vehicle>::TakeLidar(std::span<const uint8_t> bytes) {
  Status status = CheckLidar(bytes);
  if (IsUsable(status)) status = ObserveLidarClock(bytes);
  if (!IsUsable(status)) return status;
  const int columns = lidar_.columns();
  HP_LOOP_BOUND(Lidar::kMaxColumns)
  for (int i = 0; i < columns; ++i) TakeLidarColumn(bytes, i);
  return Status::kOk;
}

template <VehicleType Vehicle>
void BasicVehicleLoop<Vehicle>::TakeLidarColumn(std::span<const uint8_t> bytes, int index) {
  if (columns_left_ == 0) return LoseColumn();
  --columns_left_;
  if (!IsUsable(lidar_.Decode(bytes, index, column_))) return;
  if (lidar_time_.suspect()) {
    ++counters_.suspect_columns;
    return;
  }
  const Result<uint64_t> time_ns = lidar_time_.ToHost(column_.timestamp_ns);
  if (!time_ns.ok()) return LoseColumn();
  TakeColumn(column_, time_ns.value());
}

}  // namespace hardpack
