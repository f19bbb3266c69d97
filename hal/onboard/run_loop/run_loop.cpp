// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/run_loop/run_loop.h"

#include "core/base/loop_bound.h"
#include "core/base/status.h"
#include "core/base/wide_int.h"

namespace hardpack {
namespace {

// Batches of what came before the first tick: more than any receive buffer holds.
constexpr int kMaxBacklog = 4096;
// Batches that a tick drops at most of what waits too long.
constexpr int kMaxWaiting = 64;
// Longer than it takes to make up for a late tick.
constexpr uint64_t kMaxBehind_ns = 100'000'000;

uint64_t Period_ns(const RunOptions& options) {
  constexpr uint64_t kNanosecondsPerMillisecond = 1'000'000;
  return static_cast<uint64_t>(options.period_ms) * kNanosecondsPerMillisecond;
}

// Datagrams that came off the socket, whoever sent them.
uint64_t SeenBy(const DatagramSocket& socket) {
  const DatagramCounters& counters = socket.counters();
  return counters.received + counters.foreign + counters.oversized;
}

// Takes what waits there, at most so many batches. Returns how many it would have given.
uint64_t Drop(DatagramSocket& socket, int batches) {
  uint64_t dropped = 0;
  HP_LOOP_BOUND(kMaxBacklog)
  for (int batch = 0; batch < batches; ++batch) {
    const uint64_t seen = SeenBy(socket);
    dropped += socket.Receive(DatagramSocket::kMaxBatch).size();
    if (SeenBy(socket) - seen < DatagramSocket::kMaxBatch) break;
  }
  return dropped;
}

}  // namespace

RunLoop::RunLoop(AnyVehicle& vehicle, const OnboardDevices& devices, const RunOptions& options)
    : vehicle_(vehicle), devices_(devices), options_(options) {
  constexpr size_t kMost = control::kTextBytes - 1;
  HP_LOOP_BOUND(kMost)
  for (size_t i = 0; i < kMost && i < options.version.size(); ++i) {
    program_.version[i] = options.version[i];
  }
  vehicle.CopyType(program_.vehicle);
  disarm_.kind = control::Kind::kDisarm;
  program_.realtime_scheduled = options.realtime_scheduled;
  program_.memory_locked = options.memory_locked;
}

// The sockets were opened before everything was set up. What has waited since then would be taken
// for having come just now: columns with stamps of long ago, and a lidar's clock that jumps as soon
// as one comes in time.
void RunLoop::Begin() {
  if (devices_.ins != nullptr) static_cast<void>(Drop(*devices_.ins, kMaxBacklog));
  if (devices_.labels != nullptr) static_cast<void>(Drop(*devices_.labels, kMaxBacklog));
  if (devices_.lidar != nullptr) static_cast<void>(Drop(*devices_.lidar, kMaxBacklog));
  due_ns_ = devices_.clock->Now_ns() + Period_ns(options_);
  if (devices_.watchdog != nullptr) devices_.watchdog->Ready();
}

bool RunLoop::Next(bool is_to_end) {
  devices_.clock->SleepUntil(due_ns_);
  const uint64_t now_ns = devices_.clock->Now_ns();
  const uint64_t skipped = NoteLateness(now_ns - due_ns_);
  due_ns_ += (skipped + 1) * Period_ns(options_);
  if (is_to_end && !ending_) {
    ending_ = true;
    ends_ns_ = now_ns + options_.max_stop_ns;
    if (devices_.watchdog != nullptr) devices_.watchdog->Stopping();
  }
  Tick(now_ns, skipped);
  return !ending_ || (!IsOff() && now_ns < ends_ns_);
}

// Returns how many ticks are missed by it.
uint64_t RunLoop::NoteLateness(uint64_t late_ns) {
  constexpr int32_t kThousand = 1000;
  const int64_t late_us = Divide(static_cast<int64_t>(late_ns), kThousand).quotient;
  const int64_t late_ms = Divide(late_us, kThousand).quotient;
  const auto skipped = static_cast<uint64_t>(Divide(late_ms, options_.period_ms).quotient);
  if (late_ns > program_.worst_late_ns) program_.worst_late_ns = late_ns;
  if (skipped > 0) {
    program_.missed_ticks += skipped;
    program_.last_missed_tick = index_ + skipped;
    program_.last_miss_late_ns = late_ns;
  }
  return skipped;
}

// The drives say so themselves: neither being told nor being asked to is it.
bool RunLoop::IsOff() const {
  return vehicle_.pilot().permission().motion == Motion::kOff && vehicle_.DrivesAreOff();
}

void RunLoop::Tick(uint64_t now_ns, uint64_t skipped) {
  if (first_ns_ == 0) first_ns_ = now_ns;
  index_ += skipped + 1;
  devices_.can->Advance(now_ns);
  TakeFrames();
  datagram_count_ = 0;
  input_.now_ns = now_ns;
  TakeDatagrams(devices_.ins, InputSource::kIns, TickLimits::kMaxInsDatagrams);
  TakeDatagrams(devices_.labels, InputSource::kLabels, TickLimits::kMaxLabelDatagrams);
  TakeDatagrams(devices_.lidar, InputSource::kLidar,
                TickLimits::kMaxDatagramsPerTick - datagram_count_);
  input_.index = index_;
  input_.bus = devices_.can->state();
  input_.frames = std::span(frames_).first(static_cast<size_t>(frame_count_));
  input_.datagrams = std::span(datagrams_).first(static_cast<size_t>(datagram_count_));
  input_.command = {};
  TakeMessage();

  flight_log::FlightLog* log = devices_.flight_log;
  if (log != nullptr) {
    const flight_log::TickArrivals arrivals = {
        std::span(arrivals_).first(static_cast<size_t>(datagram_count_)),
        has_command_ ? message_.user : 0u};
    log->BeginTick(input_, arrivals, vehicle_.state());
  }
  const Status status = vehicle_.Tick(input_, output_);
  const int refused = SendFrames();
  NoteDuration(now_ns);
  if (log != nullptr) {
    log->EndTick({index_, status, vehicle_.pilot().decision_hash(),
                  devices_.clock->Now_ns() - now_ns, refused},
                 output_);
  }
  AnswerCommand();
  if (devices_.watchdog != nullptr) {
    devices_.watchdog->Feed(now_ns);
    program_.watchdog_fed = devices_.watchdog->fed();
  }
}

void RunLoop::TakeFrames() {
  frame_count_ = 0;
  HP_LOOP_BOUND(CanBus::kMaxFramesPerTick)
  while (frame_count_ < CanBus::kMaxFramesPerTick &&
         IsUsable(devices_.can->Receive(frames_[frame_count_]))) {
    ++frame_count_;
  }
}

// What waits behind a batch that is full comes later than it could, and looks as if it had just
// come. While that is made up for, it does no harm; where it lasts, what waits is dropped, so that
// what is taken next is new.
void RunLoop::TakeDatagrams(DatagramSocket* socket, InputSource source, int max) {
  if (socket == nullptr) return;
  uint64_t& full_since_ns = full_since_ns_[static_cast<size_t>(source)];
  if (full_since_ns != 0 && input_.now_ns - full_since_ns >= kMaxBehind_ns) {
    program_.dropped_datagrams += Drop(*socket, kMaxWaiting);
    full_since_ns = 0;
  }
  const uint64_t seen = SeenBy(*socket);
  const std::span<const Datagram> taken = socket->Receive(max);
  if (SeenBy(*socket) - seen < static_cast<uint64_t>(max)) {
    full_since_ns = 0;
  } else if (full_since_ns == 0) {
    full_since_ns = input_.now_ns;
  }
  HP_LOOP_BOUND(DatagramSocket::kMaxBatch)
  for (const Datagram& datagram : taken) {
    datagrams_[datagram_count_] = {source, datagram.bytes};
    arrivals_[datagram_count_] = {datagram.kernel_time_ns,
                                  {datagram.sender_address, datagram.sender_port}};
    ++datagram_count_;
  }
}

// A command goes into the tick; a question changes nothing and is answered here.
void RunLoop::TakeMessage() {
  has_command_ = false;
  if (devices_.control != nullptr && devices_.control->Receive(message_)) {
    if (message_.header.kind == control::Kind::kGetStatus) {
      AnswerStatus();
    } else if (message_.header.kind == control::Kind::kGetParameters) {
      AnswerParameters();
    } else {
      TakeCommand();
    }
  }
  if (!ending_ || has_command_) return;
  int size_bytes = 0;
  static_cast<void>(control::Encode(disarm_, disarm_bytes_, size_bytes));
  input_.command = std::span(disarm_bytes_).first(static_cast<size_t>(size_bytes));
}

// While it ends the vehicle is being stopped and disarmed as it is: only an emergency stop asks for
// more.
void RunLoop::TakeCommand() {
  const control::Kind kind = message_.header.kind;
  if (!ending_ || kind == control::Kind::kEmergencyStop) {
    has_command_ = true;
    input_.command = message_.bytes;
    return;
  }
  const bool is_done = kind == control::Kind::kStop || kind == control::Kind::kDisarm;
  const control::Done done = {
      message_.header.sequence, is_done ? Status::kOk : Status::kNotPermitted,
      static_cast<uint8_t>(is_done ? StopReason::kNone : StopReason::kOperator)};
  int size_bytes = 0;
  if (IsUsable(control::Encode(done, answer_, size_bytes))) Answer(size_bytes);
}

void RunLoop::Answer(int size_bytes) {
  const std::span<const uint8_t> answer(answer_);
  devices_.control->Answer(message_.client, answer.first(static_cast<size_t>(size_bytes)));
}

void RunLoop::AnswerStatus() {
  Report(report_);
  int size_bytes = 0;
  const uint32_t sequence = message_.header.sequence;
  if (IsUsable(control::Encode(report_, sequence, answer_, size_bytes))) Answer(size_bytes);
}

void RunLoop::AnswerParameters() {
  control::Question question;
  if (!IsUsable(control::Decode(message_.bytes, question))) return;
  const std::span<const uint8_t> text = options_.parameters;
  const size_t offset = question.offset < text.size() ? question.offset : text.size();
  constexpr auto kMost = static_cast<size_t>(control::kMaxPartBytes);
  const std::span<const uint8_t> rest = text.subspan(offset);
  const control::ParametersPart part = {
      .sequence = question.sequence,
      .offset = static_cast<uint32_t>(offset),
      .whole_bytes = static_cast<uint32_t>(text.size()),
      .bytes = rest.first(rest.size() < kMost ? rest.size() : kMost)};
  int size_bytes = 0;
  if (IsUsable(control::Encode(part, answer_, size_bytes))) Answer(size_bytes);
}

void RunLoop::AnswerCommand() {
  if (!has_command_ || !output_.has_answer) return;
  const auto reason = static_cast<uint8_t>(output_.reason);
  int size_bytes = 0;
  if (IsUsable(control::Encode(control::Done{output_.sequence, output_.answer, reason}, answer_,
                               size_bytes))) {
    Answer(size_bytes);
  }
}

// The number that the bus did not accept: each is in the bus's counters, too.
int RunLoop::SendFrames() {
  int refused = 0;
  HP_LOOP_BOUND(kMaxFramesOut)
  for (const CanFrame& frame : output_.frames) {
    if (!IsUsable(devices_.can->Send(frame, input_.now_ns + options_.frame_age_ns))) ++refused;
  }
  return refused;
}

void RunLoop::NoteDuration(uint64_t now_ns) {
  const uint64_t duration_ns = devices_.clock->Now_ns() - now_ns;
  if (duration_ns <= program_.worst_tick_ns) return;
  program_.worst_tick_ns = duration_ns;
  program_.worst_tick_index = index_;
}

}  // namespace hardpack
