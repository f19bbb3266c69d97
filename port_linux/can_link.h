// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "port_linux/file_descriptor.h"
#include "port_linux/link_message.h"
#include "port_linux/open_outcome.h"

namespace hardpack {

// The network interface below a CAN socket: watched through rtnetlink notifications, and taken down
// and up again on request, which empties the kernel's queue and takes a controller out of bus-off.
//
// The kernel carries out a request within the call that makes it, under a lock that others hold for
// milliseconds. So a separate thread makes the calls, and the answers reach the owner through the
// same socket as the notifications: Poll never waits. The same thread rebinds the CAN socket when
// the interface was removed and another one of that name has appeared.
class CanLink {
 public:
  CanLink() = default;
  CanLink(const CanLink&) = delete;
  CanLink& operator=(const CanLink&) = delete;
  ~CanLink();

  // Finds the interface. At start-up; may wait. kInterfaceDown: there is none of that name;
  // kUnsupported: it is not a CAN interface; kTimedOut, kSystemError.
  OpenOutcome Open(const std::string& name);

  // Its properties, as last reported.
  const LinkInfo& info() const { return info_; }

  // Whether a restart would be permitted. At start-up, after Open; may wait.
  bool AskPermission();

  // Starts the thread. `can_socket` is bound to the interface and outlives this object.
  void Watch(int can_socket);

  // The rest is for the owner of the tick, after Watch; none of it waits.

  // Processes notifications; a bounded number of messages.
  void Poll();

  // An interface of that name exists.
  bool present() const { return present_; }
  // Frames can be sent and received.
  bool usable() const { return present_ && bound_ && info_.up && info_.carrier; }
  // Exists, and the administrator has set it up.
  bool up() const { return present_ && bound_ && info_.up; }
  // The controller is in bus-off, as the driver reports.
  bool bus_off() const { return up() && info_.bus_off && !info_.carrier; }
  // How often it has gone down, other than by a restart.
  uint64_t downs() const { return downs_; }

  enum class Restart : uint8_t { kNone, kRunning, kDone, kRefused };
  // Down and up again. Precondition: none is running.
  void BeginRestart();
  Restart restart() const { return restart_; }

 private:
  static constexpr int kMaxMessages = 16;  // datagrams read by one Poll
  static constexpr uint32_t kRestartBit = 1, kBindBit = 2, kQueryBit = 4, kStopBit = 8;

  void Work();
  void Ask(uint32_t work);
  bool WaitForAnswer(uint32_t sequence, int& code);
  bool ReceiveOnce();
  void TakeMessage(const NetlinkMessage& message);
  void TakeLink(uint16_t type, const LinkInfo& link);
  void Leave();
  void TakeAnswer(uint32_t sequence, int code);

  FileDescriptor netlink_;
  std::string name_;
  std::vector<uint8_t> query_;
  LinkInfo info_;
  bool present_ = false;
  bool bound_ = false;
  uint64_t downs_ = 0;
  Restart restart_ = Restart::kNone;
  uint32_t sequence_ = 0;  // of the last request
  int answer_ = -1;        // its result: an errno, 0: done, -1: none yet
  int down_answer_ = 0;
  alignas(8) std::array<uint8_t, 32768> buffer_;

  // Shared with the thread.
  std::atomic<uint32_t> work_ = 0;
  std::atomic<uint32_t> restart_sequence_ = 0;
  std::atomic<uint32_t> failed_sequence_ = 0;  // of a restart that could not be requested
  std::atomic<int> index_ = 0;                 // to restart or to bind
  std::atomic<int> bound_index_ = 0;           // the CAN socket is bound to
  int can_socket_ = -1;
  std::thread thread_;
};

}  // namespace hardpack
