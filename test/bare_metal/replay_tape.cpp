// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>

#include "core/base/assert.h"
#include "core/base/status.h"
#include "hal/onboard/vehicle_loop/vehicle_loop.h"
#include "test/bare_metal/instruction_clock.h"
#include "test/bare_metal/print.h"
#include "test/bare_metal/semihosting.h"
#include "test/bare_metal/stack.h"
#include "test/bare_metal/tape.h"
#include "test/decision/storage.h"

// A recorded mission on a bare processor: VehicleLoop is given, tick by tick, the bytes of a tape
// (tape.h), and has to send the frames and to come to the decision hash that are on it. Prints what
// the ticks took. The command line is the tape's path. Exit code 1: decided otherwise; 2: no tape.

namespace hardpack::decision {

const uint8_t kFreshMemory = 0;

}  // namespace hardpack::decision

namespace hardpack::bare_metal {
namespace {

HP_BIG_MEMORY decision::Storage<VehicleLoop> loop_memory;
HP_BIG_MEMORY decision::Storage<VehicleConfig> config_memory;
HP_BIG_MEMORY uint8_t payload[kMaxTapePayload_bytes];
TickDatagram datagrams[VehicleLoop::kMaxDatagramsPerTick];
CanFrame frames_in[CanBus::kMaxFramesPerTick];
CanFrame frames_out[kMaxFramesOut];
TickOutput output;

[[noreturn]] void OnAssertion(const char* file, int line, const char* expression) {
  PrintNumber(file, static_cast<uint32_t>(line));
  PrintLine(expression);
  Exit(4);
}

[[noreturn]] void GiveUp(const char* why) {
  PrintLine(why);
  Exit(2);
}

// What follows of a tick behind its head.
class Payload {
 public:
  explicit Payload(std::span<const uint8_t> bytes) : rest_(bytes) {}

  std::span<const uint8_t> Take(size_t bytes) {
    if (bytes > rest_.size()) GiveUp("the tape's ticks are damaged");
    const std::span<const uint8_t> taken = rest_.first(bytes);
    rest_ = rest_.subspan(bytes);
    return taken;
  }

  template <typename T>
  void TakeInto(std::span<T> things) {
    const std::span<const uint8_t> bytes = Take(things.size_bytes());
    std::memcpy(things.data(), bytes.data(), bytes.size());
  }

 private:
  std::span<const uint8_t> rest_;
};

struct Counts {
  uint32_t ticks = 0;
  uint64_t instructions = 0;  // of all
  uint32_t most = 0;          // of one tick
  uint64_t most_index = 0;
};

void AddTo(Counts& counts, uint64_t index, uint32_t instructions) {
  ++counts.ticks;
  counts.instructions += instructions;
  if (instructions <= counts.most) return;
  counts.most = instructions;
  counts.most_index = index;
}

bool IsAsOnTape(const TapeTick& tick, Status status, const VehicleLoop& loop) {
  const auto frames = static_cast<size_t>(output.frames.size());
  return static_cast<uint16_t>(status) == tick.status && frames == tick.frames_out &&
         std::equal(output.frames.begin(), output.frames.end(), frames_out) &&
         loop.decision_hash() == tick.decision_hash;
}

struct Counted {
  Counts all;
  Counts without_goal;  // and so without planning
};

void ReplayTick(const TapeTick& tick, VehicleLoop& loop, Counted& counted) {
  Payload rest({payload, tick.payload_bytes});
  for (uint16_t i = 0; i < tick.datagrams; ++i) {
    TapeDatagram head;
    rest.TakeInto(std::span(&head, 1));
    datagrams[i] = {static_cast<InputSource>(head.source), rest.Take(head.bytes)};
  }
  rest.TakeInto(std::span(frames_in, tick.frames_in));
  const std::span<const uint8_t> command = rest.Take(tick.command_bytes);
  rest.TakeInto(std::span(frames_out, tick.frames_out));
  const TickInput input = {tick.index,
                           tick.now_ns,
                           static_cast<CanBusState>(tick.bus),
                           {datagrams, tick.datagrams},
                           {frames_in, tick.frames_in},
                           command};
  const bool had_goal = loop.goals() > 0;
  const uint32_t from = InstructionClock::Now();
  const Status status = loop.Tick(input, output);
  const uint32_t to = InstructionClock::Now();
  const uint32_t instructions = InstructionClock::InstructionsBetween(from, to);
  AddTo(counted.all, tick.index, instructions);
  if (!had_goal && loop.goals() == 0) AddTo(counted.without_goal, tick.index, instructions);
  if (IsAsOnTape(tick, status, loop)) return;
  PrintNumber("decided otherwise, tick", static_cast<uint32_t>(tick.index));
  Exit(1);
}

bool IsPossible(const TapeTick& tick) {
  return tick.datagrams <= VehicleLoop::kMaxDatagramsPerTick &&
         tick.frames_in <= CanBus::kMaxFramesPerTick && tick.frames_out <= kMaxFramesOut &&
         tick.payload_bytes <= sizeof(payload);
}

template <typename T>
void ReadInto(int32_t file, T& thing) {
  const std::span<uint8_t> bytes(reinterpret_cast<uint8_t*>(&thing), sizeof(T));
  if (!bare_metal::Read(file, bytes)) GiveUp("the tape ends too early");
}

// Returns the ticks that are on the tape.
uint32_t Begin(int32_t file, VehicleLoop& loop) {
  TapeHead head;
  ReadInto(file, head);
  if (head.magic != kTapeMagic) GiveUp("this is no tape");
  if (head.config_bytes != sizeof(VehicleConfig)) GiveUp("its configuration has another size");
  VehicleConfig& config = config_memory.Construct();
  ReadInto(file, config);
  const uint32_t from = InstructionClock::Now();
  const Status status = loop.Configure(config);
  const uint32_t to = InstructionClock::Now();
  if (!IsUsable(status)) GiveUp("its configuration is refused");
  PrintNumber("instructions_configure", InstructionClock::InstructionsBetween(from, to));
  return head.ticks;
}

}  // namespace

void ReplayTape() {
  static char path[1024];
  if (!GetCommandLine(path) || path[0] == '\0') GiveUp("no tape was named");
  const int32_t file = OpenToRead(path);
  if (file < 0) GiveUp("the tape cannot be opened");
  InstructionClock::Start();
  VehicleLoop& loop = loop_memory.Construct();
  const uint32_t ticks = Begin(file, loop);
  Counted counted;
  for (uint32_t i = 0; i < ticks; ++i) {
    TapeTick tick;
    ReadInto(file, tick);
    if (!IsPossible(tick)) GiveUp("the tape's ticks are damaged");
    if (!Read(file, {payload, tick.payload_bytes})) GiveUp("the tape ends too early");
    ReplayTick(tick, loop, counted);
  }
  const Counts& counts = counted.all;
  if (counts.ticks == 0) GiveUp("there is no tick on the tape");
  PrintNumber("ticks", counts.ticks);
  PrintHex("decision hash", loop.decision_hash());
  PrintNumber("rounds_of_planning", static_cast<uint32_t>(loop.counters().plans));
  // To a thousand: a division of 64 bits is a function of the compiler's library.
  const auto kibi = static_cast<uint32_t>(counts.instructions >> 10u);
  PrintNumber("instructions_mean_tick", (kibi / counts.ticks) << 10u);
  PrintNumber("instructions_worst_tick", counts.most);
  PrintNumber("worst_tick", static_cast<uint32_t>(counts.most_index));
  PrintNumber("instructions_worst_tick_without_planning", counted.without_goal.most);
  PrintNumber("stack_size_bytes", stack_size_bytes());
  PrintNumber("stack_peak_bytes", stack_peak_bytes());
}

}  // namespace hardpack::bare_metal

int main() {
  hardpack::SetAssertionHook(hardpack::bare_metal::OnAssertion);
  hardpack::bare_metal::ReplayTape();
  return 0;
}
