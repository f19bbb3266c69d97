// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/can.h>
#include <sys/socket.h>
#include <time.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "hal/can_bus.h"
#include "port_linux/can_link.h"
#include "port_linux/can_send_queue.h"
#include "port_linux/file_descriptor.h"
#include "port_linux/open_outcome.h"

namespace hardpack {

struct SocketCanOptions {
  bool restart = true;        // the interface may be taken down and up again
  uint32_t bit_rate_bps = 0;  // required if the interface reports it; 0: any
  int receive_buffer_bytes = 1024 * 1024;
};

// CanBus on a SocketCAN raw socket. Compensates for what the kernel lacks:
//
//   The kernel's queue cannot be recalled. At most kMaxUnconfirmed frames are in it, counted by
//   their echoes; the rest wait here and expire. A frame in it that is CanSendQueue::kStaleAfter_ns
//   past its deadline would do harm when a broken bus comes back, so the interface is taken down
//   and up again, which empties the queue.
//   A controller in bus-off stays there. The same restart takes it out, and drops queued frames.
//   A bus that fails again at once must not be hammered: after a restart nothing is sent for
//   kFirstSilence_ns, twice as long each time, at most kLastSilence_ns, until a frame has been
//   confirmed.
//
// A restart needs CAP_NET_ADMIN. Without it (Open says so), or if the options forbid it: after
// bus-off, sending waits until the kernel (restart-ms) or somebody else restarts the controller, up
// to kMaxUnconfirmed old frames may then still be sent, and frames that are never confirmed block
// those after them; each such case is counted in system_errors.
//
// Frames lost in the socket's buffer may have been our own echoes. So after a loss the outstanding
// frames count as sent, but not as confirmed: accepted is then greater than confirmed + expired +
// in flight, otherwise equal.
class SocketCanBus final : public CanBus {
 public:
  static constexpr uint64_t kFirstSilence_ns = 100'000'000;
  static constexpr uint64_t kLastSilence_ns = 1'600'000'000;

  SocketCanBus();
  SocketCanBus(const SocketCanBus&) = delete;
  SocketCanBus& operator=(const SocketCanBus&) = delete;

  // Once, at start-up; allocates and may wait. An interface that is down is opened, with a warning.
  // kInterfaceDown: there is none of that name; kUnsupported: it is not a CAN interface, or the
  // kernel has no SocketCAN; kNotPermitted; kWrongDevice: another bit rate; kTimedOut,
  // kSystemError.
  OpenOutcome Open(const std::string& interface, const SocketCanOptions& options);

  void Advance(uint64_t now_ns) override;
  Status Send(const CanFrame& frame, uint64_t deadline_ns) override;
  Status Receive(CanFrame& frame) override;
  CanBusState state() const override;
  const CanBusCounters& counters() const override { return counters_; }

  // Whether it would restart the interface.
  bool may_restart() const { return may_restart_; }
  // A restart is in progress: some 50 ms, in a separate thread.
  bool restarting() const { return restarting_; }
  // As reported by the interface; 0: unknown.
  uint32_t bit_rate_bps() const { return link_.info().bit_rate_bps; }

 private:
  static constexpr int kBatch = 32;
  // Messages read by one Advance: the frames of a tick, and as many echoes and error frames.
  static constexpr int kMaxReads = 2 * kMaxFramesPerTick;

  struct Control {
    alignas(cmsghdr)
        std::array<std::byte, CMSG_SPACE(sizeof(uint32_t)) + CMSG_SPACE(sizeof(timespec))> bytes;
  };

  OpenOutcome OpenSocket(const std::string& interface, const SocketCanOptions& options);
  Status Refuse(Status status);
  void Expire(int frames);
  bool Read();
  uint64_t TakeControl(const msghdr& header);
  void TakeLosses(uint32_t drops);
  void TakeFrame(const canfd_frame& wire, unsigned size, int flags, uint64_t received_ns);
  void TakeErrorFrame(const canfd_frame& wire);
  Status HandOver();
  void DropAll();
  void EnterBusOff();
  void FollowLink();
  void FollowRestart();
  void BeginRestart();
  void DropStale();

  FileDescriptor socket_;
  CanLink link_;  // its thread uses the socket until it ends
  CanSendQueue queue_;
  CanBusCounters counters_;
  bool may_restart_ = false;
  uint64_t now_ns_ = 0;
  uint32_t kernel_drops_ = 0;       // as last reported, modulo 2^32
  int64_t wall_minus_ours_ns_ = 0;  // the kernel stamps with the wall clock; as of this Advance

  CanBusState error_state_ = CanBusState::kActive;
  bool bus_off_ = false;
  bool kernel_said_bus_off_ = false;  // by the interface's state, in this bus-off
  bool restarting_ = false;
  bool restarted_ = false;      // since the bus-off began
  bool owes_up_ = false;        // we took the interface down and could not bring it up again
  bool stale_counted_ = false;  // not permitted to drop them, already reported
  uint64_t silent_until_ns_ = 0;
  uint64_t silence_ns_ = kFirstSilence_ns;
  uint64_t downs_seen_ = 0;

  int received_first_ = 0;
  int received_count_ = 0;
  std::array<CanFrame, kMaxFramesPerTick> received_;  // ring

  // One of each per frame read.
  std::array<mmsghdr, kBatch> messages_{};
  std::array<iovec, kBatch> parts_{};
  std::array<Control, kBatch> controls_{};
  std::array<canfd_frame, kBatch> wires_{};
};

}  // namespace hardpack
