// SPDX-License-Identifier: Apache-2.0
// Any frames and demands, in ticks, as the drives' bus. Each byte is one step: a frame made of the
// bytes behind it, an answer to the last question (so that the bring-up gets on), or a tick.

#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "hal/sevcon/sevcon.h"

using hardpack::CanBatch;
using hardpack::CanFrame;
using hardpack::sevcon::DriveDemand;
using hardpack::sevcon::DrivePair;
using hardpack::sevcon::Side;

namespace {

constexpr uint32_t kIds[16] = {0x000, 0x080, 0x082, 0x083, 0x182, 0x183, 0x202, 0x582,
                               0x583, 0x603, 0x700, 0x701, 0x702, 0x703, 0x18f, 0x602};

void Require(bool condition) {
  if (!condition) std::abort();
}

struct Input {
  const uint8_t* data;
  size_t size;
  uint8_t Next() {
    if (size == 0) return 0;
    --size;
    return *data++;
  }
};

CanFrame AnyFrame(Input& input) {
  CanFrame frame;
  const uint8_t head = input.Next();
  frame.id = kIds[head % 16];
  frame.size = head < 0x80 ? (frame.id >= 0x700 ? uint8_t{1} : uint8_t{8}) : input.Next() % 12;
  frame.extended = head % 64 == 63;
  frame.remote = head % 64 == 31;
  for (int i = 0; i < frame.size && i < 8; ++i) frame.data[i] = input.Next();
  return frame;
}

// What the drive would have to say for the bring-up to go on.
uint32_t Wanted(int index, int subindex, uint32_t node) {
  switch (index << 8 | subindex) {
    case 0x101801:
      return 0x1e;
    case 0x100500:
      return 0x80;
    case 0x101601:
      return 0x0001012c;
    case 0x101700:
      return 100;
    case 0x140001:
      return 0x200 + node;
    case 0x140002:
      return 255;
    case 0x180001:
      return 0x180 + node;
    case 0x180002:
      return 1;
    case 0x160000:
    case 0x1a0000:
    case 0x606000:
    case 0x606100:
      return 3;
    case 0x160001:
      return 0x60400010;
    case 0x160002:
      return 0x60ff0020;
    case 0x160003:
      return 0x60720010;
    case 0x1a0001:
      return 0x60410010;
    case 0x1a0002:
      return 0x606c0020;
    case 0x1a0003:
      return 0x60770010;
    case 0x511000:
      return 5;
    case 0x590200:
      return 2;
    case 0x608000:
      return 6000;
    default:
      return 0;
  }
}

CanFrame GoodAnswer(const CanFrame& question) {
  CanFrame answer = question;
  answer.id -= 0x80;
  const bool read = question.data[0] == 0x40;
  answer.data[0] = read ? 0x42 : 0x60;
  const int index = question.data[1] | question.data[2] << 8;
  const uint32_t value = read ? Wanted(index, question.data[3], question.id & 0x7fu) : 0;
  for (int i = 0; i < 4; ++i) answer.data[4 + i] = static_cast<uint8_t>(value >> (8 * i));
  return answer;
}

void CheckSent(const DrivePair& pair, const CanBatch& out) {
  Require(out.size() <= DrivePair::kMaxFramesPerTick);
  for (const CanFrame& frame : out) {
    Require(IsValid(frame));
    const bool commands = frame.id == 0x202 || frame.id == 0x203;
    if (!commands) continue;
    Require(frame.size == 8);
    const bool moves = (frame.data[2] | frame.data[3] | frame.data[4] | frame.data[5]) != 0;
    Require(!moves || (pair.enabled() && pair.ready() && !pair.foreign_sender()));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Input input{data, size};
  DrivePair pair;
  Require(pair.Configure(hardpack::DriveParams{}) == hardpack::Status::kOk);
  uint64_t now_ns = 0;
  DriveDemand demand;
  CanFrame questions[2];
  bool asked[2] = {false, false};
  while (input.size > 0) {
    const uint8_t step = input.Next();
    if (step < 0x40) {
      pair.TakeFrame(AnyFrame(input), now_ns);
    } else if (step < 0x60) {
      demand.enable = step % 2 == 1;
      demand.reset_faults = step % 8 == 6;
      demand.wheels = {static_cast<float>(step) - 80.0f, 3.0f};
    } else {
      now_ns += step == 0xff ? 1'000'000'000u : 10'000'000u;
      for (int i = 0; i < 2; ++i) {
        if (asked[i] && (step & (1 << i)) != 0) pair.TakeFrame(GoodAnswer(questions[i]), now_ns);
        asked[i] = false;
      }
      CanBatch out;
      pair.Tick(now_ns, demand, out);
      CheckSent(pair, out);
      for (const CanFrame& frame : out) {
        if (frame.id != 0x602 && frame.id != 0x603) continue;
        questions[frame.id - 0x602] = frame;
        asked[frame.id - 0x602] = true;
      }
    }
  }
  static_cast<void>(pair.report(Side::kLeft));
  return 0;
}
