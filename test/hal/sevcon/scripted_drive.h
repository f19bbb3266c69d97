// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "hal/can_frame.h"

// A drive as a CANopen node, from the standards' side (CiA 301, CiA 402) and with the access rules
// of the Gen4's published EDS; nothing of hal/sevcon is used. Small: no ramps of physics, states
// change at once. A test breaks it where it wants to.

namespace hardpack::sevcon {

class ScriptedDrive {
 public:
  struct Object {
    int size = 4;
    uint32_t value = 0;
    bool writable = false;  // with a login, see needs_*
    bool pre_operational_only = false;
  };
  using Address = std::pair<int, int>;

  explicit ScriptedDrive(int node_id) : node(node_id) {
    const auto id = static_cast<uint32_t>(node);
    Set(0x1005, 0, 4, 0x40000080, true, true);
    Set(0x1016, 1, 4, 0, true);
    for (int sub = 2; sub <= 7; ++sub) Set(0x1016, sub, 4, 0, true);
    Set(0x1017, 0, 2, 500, true);
    Set(0x1018, 1, 4, 0x1e);
    Set(0x1018, 2, 4, 0x07055037);
    Set(0x1400, 1, 4, 0x200 + id);
    Set(0x1400, 2, 1, 255);
    Set(0x1600, 0, 1, 3);
    Set(0x1600, 1, 4, 0x60400010);
    Set(0x1600, 2, 4, 0x60ff0020);
    Set(0x1600, 3, 4, 0x60720010);
    Set(0x1800, 1, 4, 0x40000180 + id);
    Set(0x1800, 2, 1, 1);
    Set(0x1800, 5, 2, 0);
    Set(0x1a00, 0, 1, 3);
    Set(0x1a00, 1, 4, 0x60410010);
    Set(0x1a00, 2, 4, 0x606c0020);
    Set(0x1a00, 3, 4, 0x60770010);
    Set(0x2800, 0, 1, 0, true);
    Set(0x5000, 1, 1, 0);
    Set(0x5000, 2, 2, 0);
    Set(0x5000, 3, 2, 0);
    Set(0x5100, 1, 2, 800);     // 50 V
    Set(0x5100, 2, 2, 0xff60);  // -10 A
    Set(0x5100, 3, 2, 784);     // 49 V
    Set(0x5100, 4, 1, 0xec);    // -20 degC
    Set(0x5110, 0, 1, 0);
    Set(0x5310, 0, 2, 0);
    Set(0x5902, 0, 1, 0, true, true);
    Set(0x6060, 0, 1, 4, true, true);
    Set(0x6061, 0, 1, 4);
    Set(0x606c, 0, 4, 0);
    Set(0x6080, 0, 4, 6000, true);
    Set(0x6083, 0, 4, 0x7fff, true);
  }

  // As a drive that an earlier session has set up (with the default parameters).
  void SetUp() {
    objects[{0x1005, 0}].value = 0x80;
    objects[{0x1016, 1}].value = 1u << 16 | 300u;
    objects[{0x1017, 0}].value = 100;
    objects[{0x5902, 0}].value = 2;
    objects[{0x6060, 0}].value = objects[{0x6061, 0}].value = 3;
  }

  void Set(int index, int sub, int size, uint32_t value, bool writable = false,
           bool pre_operational_only = false) {
    objects[{index, sub}] = {size, value, writable, pre_operational_only};
  }

  void Take(const CanFrame& frame, uint64_t now_ns) {
    if (!powered || frame.extended || frame.remote) return;
    const auto id = static_cast<uint32_t>(node);
    if (frame.id == 0 && frame.size == 2 && (frame.data[1] == node || frame.data[1] == 0)) {
      const bool starts = frame.data[0] == 0x01 && !refuses_start;
      if (starts && nmt != 0x05) heard_command = false;
      if (starts) nmt = 0x05;
      if (frame.data[0] == 0x80) nmt = 0x7f;
    } else if (frame.id == 0x600 + id && frame.size == 8 && nmt != 0x04) {
      TakeSdo(frame);
    } else if (frame.id == 0x200 + id && frame.size == 8 && nmt == 0x05) {
      command_ns = now_ns;
      heard_command = true;
      TakeControlword(static_cast<uint16_t>(Number(frame, 0, 2)));
      target_rpm = static_cast<int32_t>(Number(frame, 2, 4));
    } else if (frame.id == 0x080 && frame.size == 0) {
      Report();
    }
  }

  // Once a tick of 10 ms.
  void Step(uint64_t now_ns) {
    if (!powered) return;
    if (nmt == 0x05 && heard_command && objects[{0x5902, 0}].value != 0 &&
        now_ns - command_ns > 200'000'000 && !fault) {
      RaiseFault(0x8130);
    }
    const int wanted_rpm = Enabled() ? (runs_backward ? -target_rpm : target_rpm) : 0;
    const int step_rpm = std::clamp(wanted_rpm - speed_rpm, -max_step_rpm, max_step_rpm);
    if (!stuck) speed_rpm += step_rpm;
    objects[{0x606c, 0}].value = static_cast<uint32_t>(speed_rpm);
    const uint32_t period_ms = objects[{0x1017, 0}].value;
    if (period_ms > 0 && now_ns - heartbeat_ns >= period_ms * 1'000'000u) {
      heartbeat_ns = now_ns;
      if (!no_heartbeat) SendHeartbeat(nmt);
    }
  }

  void Reboot(bool says_so = true) {
    nmt = 0x7f;
    fault = switched_on = ready = enabled = heard_command = false;
    target_rpm = 0;
    objects[{0x5000, 1}].value = 0;
    if (says_so) SendHeartbeat(0);
  }
  void RaiseFault(uint16_t code) {
    fault = true;
    enabled = switched_on = ready = false;
    SendEmergency(code);
  }
  void SendEmergency(uint16_t code) {
    CanFrame frame = Frame(0x080, 8);
    Put(frame, 0, 2, code);
    frame.data[2] = code == 0 ? 0x00 : 0x01;
    Put(frame, 3, 2, 0x45c3);
    outbox.push_back(frame);
  }
  bool Enabled() const { return enabled && !fault; }
  uint16_t Statusword() const {
    if (fault) return 0x0208;
    if (enabled) return 0x0237;
    if (switched_on) return 0x0233;
    if (ready) return 0x0231;
    return 0x0250;
  }

  const int node;
  std::map<Address, Object> objects;
  std::vector<CanFrame> outbox;
  std::vector<CanFrame> asked;  // every SDO question that came

  bool powered = true;
  bool doubled = false;  // somebody else sends its reports too
  uint8_t nmt = 0x7f;
  bool fault = false, switched_on = false, ready = false, enabled = false;
  bool fault_can_be_reset = true;
  int target_rpm = 0;
  int speed_rpm = 0;
  int max_step_rpm = 20;  // in a tick
  uint32_t needed_access = 4;
  uint32_t user = 0, password = 0;  // give access 4

  // What is broken.
  std::map<int, uint32_t> aborts;  // index: code
  std::set<int> unanswered;        // indices
  std::set<int> kept;              // indices whose writing changes nothing
  bool no_heartbeat = false;
  bool no_reports = false;
  bool refuses_start = false;
  bool refuses_enable = false;
  bool runs_backward = false;
  bool stuck = false;
  bool answers_wrong_size = false;

 private:
  static uint32_t Number(const CanFrame& frame, int first, int bytes) {
    uint32_t number = 0;
    for (int i = bytes - 1; i >= 0; --i) number = number << 8 | frame.data[first + i];
    return number;
  }
  static void Put(CanFrame& frame, int first, int bytes, uint32_t number) {
    for (int i = 0; i < bytes && first + i < 8; ++i, number >>= 8) {
      frame.data[first + i] = static_cast<uint8_t>(number & 0xff);
    }
  }
  CanFrame Frame(uint32_t base, uint8_t size) const {
    CanFrame frame;
    frame.id = base + static_cast<uint32_t>(node);
    frame.size = size;
    return frame;
  }
  void SendHeartbeat(uint8_t state) {
    CanFrame frame = Frame(0x700, 1);
    frame.data[0] = state;
    outbox.push_back(frame);
  }
  void Report() {
    const uint32_t type = objects[{0x1800, 2}].value;
    if (nmt != 0x05 || no_reports || ++syncs % (type <= 240 ? type : 1) != 0) return;
    CanFrame frame = Frame(0x180, 8);
    Put(frame, 0, 2, Statusword());
    Put(frame, 2, 4, static_cast<uint32_t>(speed_rpm));
    Put(frame, 6, 2, static_cast<uint32_t>(Enabled() ? 123 : 0));
    outbox.push_back(frame);
  }

  void TakeControlword(uint16_t word) {
    const bool resets = (word & 0x80) != 0 && !reset_bit;
    reset_bit = (word & 0x80) != 0;
    if (fault) {
      if (resets && fault_can_be_reset) fault = false;
      return;
    }
    if ((word & 0x02) == 0 || (word & 0x04) == 0) {  // disable voltage, quick stop
      ready = switched_on = enabled = false;
    } else if ((word & 0x01) == 0) {  // shutdown
      ready = true;
      switched_on = enabled = false;
    } else if ((word & 0x08) == 0) {  // switch on
      switched_on = ready;
      enabled = false;
    } else if (switched_on && !refuses_enable) {
      enabled = true;
    }
  }

  void Abort(int index, int sub, uint32_t code, uint32_t reason = 0) {
    if (code == 0x08000000) objects[{0x5310, 0}].value = reason;
    CanFrame frame = Frame(0x580, 8);
    frame.data[0] = 0x80;
    Put(frame, 1, 2, static_cast<uint32_t>(index));
    frame.data[3] = static_cast<uint8_t>(sub);
    Put(frame, 4, 4, code);
    outbox.push_back(frame);
  }

  void TakeSdo(const CanFrame& question) {
    asked.push_back(question);
    const int index = static_cast<int>(Number(question, 1, 2));
    const int sub = question.data[3];
    if (unanswered.contains(index)) return;
    if (aborts.contains(index)) return Abort(index, sub, aborts[index], 99);
    const bool index_is_there = std::any_of(objects.begin(), objects.end(), [&](const auto& each) {
      return each.first.first == index;
    });
    if (!index_is_there) return Abort(index, sub, 0x06020000);
    const auto found = objects.find({index, sub});
    if (found == objects.end()) return Abort(index, sub, 0x06090011);
    if (index == 0x5110) found->second.value = nmt;
    CanFrame answer = Frame(0x580, 8);
    Put(answer, 1, 2, static_cast<uint32_t>(index));
    answer.data[3] = static_cast<uint8_t>(sub);
    if (question.data[0] == 0x40) {
      const int size = answers_wrong_size ? found->second.size % 4 + 1 : found->second.size;
      answer.data[0] = static_cast<uint8_t>(0x43 | (4 - size) << 2);
      Put(answer, 4, size, found->second.value);
    } else {
      const int size = 4 - (question.data[0] >> 2 & 3);
      if (size != found->second.size) return Abort(index, sub, 0x06070010);
      if (!Write(index, sub, found->second, Number(question, 4, size))) return;
      answer.data[0] = 0x60;
    }
    outbox.push_back(answer);
  }

  bool Write(int index, int sub, Object& object, uint32_t value) {
    if (index == 0x5000 && sub != 1) {
      object.value = value;
      if (sub == 2) {
        const bool right = value == password && objects[{0x5000, 3}].value == user;
        objects[{0x5000, 1}].value = right ? 4 : 0;
      }
      return true;
    }
    if (!object.writable) return Abort(index, sub, 0x06010002), false;
    if (objects[{0x5000, 1}].value < needed_access) return Abort(index, sub, 0x08000000, 8), false;
    if (object.pre_operational_only && nmt != 0x7f) {
      return Abort(index, sub, 0x08000000, 4), false;
    }
    if (kept.contains(index)) return true;
    object.value = value;
    if (index == 0x2800) nmt = value != 0 ? 0x7f : 0x05;
    if (index == 0x6060) objects[{0x6061, 0}].value = value;
    return true;
  }

  uint32_t syncs = 0;
  bool reset_bit = false;
  bool heard_command = false;
  uint64_t command_ns = 0;
  uint64_t heartbeat_ns = 0;
};

}  // namespace hardpack::sevcon
