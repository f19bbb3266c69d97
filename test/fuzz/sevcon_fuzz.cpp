// SPDX-License-Identifier: Apache-2.0
// Any frames and demands, in ticks, as the drives' bus. Each byte is one step: a frame made of the
// bytes behind it, what is demanded, or a tick, before which either drive may answer the last
// question as it should (so that the bring-up gets on).

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>

#include "hal/sevcon/sevcon.h"
#include "test/fuzz/accepted.h"

using hardpack::CanBatch;
using hardpack::CanFrame;
using hardpack::DriveDemand;
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
    case 0x590200:
      return 2;
    case 0x608000:
      return 6000;
    default:
      return 0;
  }
}

// One that answers as the bring-up wants it: what was written is read again, and its state is the
// one that it was told last.
class Answerer {
 public:
  explicit Answerer(uint32_t node) : node_(node) {}

  void Take(const CanFrame& frame) {
    const bool is_mine = frame.data[1] == 0 || frame.data[1] == node_;
    if (frame.id == 0 && is_mine) is_operational_ = frame.data[0] == 1;
    if (frame.id != 0x600 + node_) return;
    question_ = frame;
    is_asked_ = true;
  }

  // To the last question, or to none: then, too, no other one waits.
  bool Answer(bool will, CanFrame& answer) {
    const bool does = is_asked_ && will;
    is_asked_ = false;
    if (!does) return false;
    answer = question_;
    answer.id -= 0x80;
    const int object = question_.data[1] << 8 | question_.data[2] << 16 | question_.data[3];
    const bool is_read = question_.data[0] == 0x40;
    answer.data[0] = is_read ? 0x42 : 0x60;
    uint32_t value = 0;
    for (int i = 0; i < 4; ++i) value |= static_cast<uint32_t>(question_.data[4 + i]) << (8 * i);
    if (!is_read) written_[object] = value;
    value = is_read ? Value(object) : 0;
    for (int i = 0; i < 4; ++i) answer.data[4 + i] = static_cast<uint8_t>(value >> (8 * i));
    return true;
  }

 private:
  uint32_t Value(int object) const {
    constexpr int kNmtState = 0x511000;
    if (object == kNmtState) return is_operational_ ? 5 : 127;
    const auto written = written_.find(object);
    return written != written_.end() ? written->second : Wanted(object >> 8, object & 0xff, node_);
  }

  uint32_t node_;
  bool is_operational_ = false;
  bool is_asked_ = false;
  CanFrame question_;
  std::map<int, uint32_t> written_;
};

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
  Answerer drives[2] = {Answerer(2), Answerer(3)};
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
        CanFrame answer;
        if (drives[i].Answer((step & (1 << i)) != 0, answer)) pair.TakeFrame(answer, now_ns);
      }
      CanBatch out;
      pair.Tick(now_ns, demand, out);
      CheckSent(pair, out);
      if (pair.ready()) hardpack::Accepted("ready");
      if (pair.enabled()) hardpack::Accepted("enabled");
      for (const CanFrame& frame : out) {
        for (Answerer& drive : drives) drive.Take(frame);
      }
    }
  }
  static_cast<void>(pair.report(Side::kLeft));
  return 0;
}
