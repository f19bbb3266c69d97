// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/socket.h>
#include <time.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "hal/datagram_socket.h"
#include "port_linux/file_descriptor.h"
#include "port_linux/open_outcome.h"

namespace hardpack {

struct UdpSocketOptions {
  uint32_t bind_address = 0;                   // IPv4, host byte order; 0: every local one
  uint16_t port = 0;                           // ours; 0: one that the kernel chooses
  uint32_t sender_address = 0;                 // only this sender's datagrams are returned
  uint16_t sender_port = 0;                    // its only port; 0: any
  int receive_buffer_bytes = 4 * 1024 * 1024;  // as in sysctl net.core.rmem_max
  bool require_receive_buffer = true;          // less is a failure, not a warning
};

// A sensor's UDP socket over IPv4. About 1 MiB: not for the stack.
//
// It is not connected to the sender and has no filter in the kernel: either would keep foreign
// datagrams out of the buffer, and then they could not be counted (a filter's drops look like those
// of a full buffer), and a connected socket fails with the sender's ICMP errors. Floods are a
// matter for the firewall; here they use their share of a bounded batch, and show in `foreign`.
//
// lost_in_kernel is what the kernel reports with a received datagram: losses become known with the
// first datagram after them. receive_buffer_bytes is in the unit of the option, half of what the
// kernel accounts against it with the datagrams' headers and unused space.
class UdpSocket final : public DatagramSocket {
 public:
  UdpSocket();
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  // Once, at start-up; allocates. kInvalidArgument: no sender, a buffer size below 1, or the
  // address is not one of ours; kNotPermitted; kCapacityExceeded: the required buffer was not
  // granted; kSystemError: everything else, including a port in use. Nothing is received until it
  // succeeds.
  OpenOutcome Open(const UdpSocketOptions& options);

  std::span<const Datagram> Receive(int max) override;
  const DatagramCounters& counters() const override { return counters_; }

  uint16_t port() const { return port_; }  // ours; 0: not open

 private:
  struct Control {
    alignas(cmsghdr)
        std::array<std::byte, CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(uint32_t))> bytes;
  };
  OpenOutcome AskForBuffer(const UdpSocketOptions& options, const std::string& name);
  void Take(int index);

  FileDescriptor socket_;
  uint16_t port_ = 0;
  uint32_t sender_address_ = 0;
  uint16_t sender_port_ = 0;
  uint32_t kernel_drops_ = 0;  // as last reported, modulo 2^32
  DatagramCounters counters_;
  int given_ = 0;
  std::array<Datagram, kMaxBatch> datagrams_;  // [given_]

  // One of each per datagram.
  std::array<mmsghdr, kMaxBatch> messages_{};
  std::array<iovec, kMaxBatch> parts_{};
  std::array<sockaddr_storage, kMaxBatch> senders_{};
  std::array<Control, kMaxBatch> controls_{};
  std::array<std::array<uint8_t, kMaxDatagram_bytes>, kMaxBatch> buffers_{};
};

}  // namespace hardpack
