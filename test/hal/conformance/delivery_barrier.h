// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>

#include "port_linux/file_descriptor.h"

namespace hardpack {

// Waits until what was sent before, on any interface inside this machine, lies in its receivers'
// sockets. The kernel delivers in the order of sending, mostly before the sender's call returns; a
// busy one puts it off (ksoftirqd), for as long as it likes. So a datagram that is sent to itself
// over the loopback arrives behind whatever this processor owes.
class DeliveryBarrier {
 public:
  DeliveryBarrier() : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const timeval longest{.tv_sec = 10, .tv_usec = 0};
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    auto* const generic = reinterpret_cast<sockaddr*>(&address);
    socklen_t size = sizeof(address);
    ready_ = socket_.valid() && bind(socket_.get(), generic, size) == 0 &&
             getsockname(socket_.get(), generic, &size) == 0 &&
             connect(socket_.get(), generic, size) == 0 &&
             setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof(longest)) == 0;
  }

  // False: it did not come within ten seconds.
  bool Wait() {
    char mark = 0;
    return ready_ && send(socket_.get(), &mark, 1, 0) == 1 && recv(socket_.get(), &mark, 1, 0) == 1;
  }

 private:
  FileDescriptor socket_;
  bool ready_ = false;
};

}  // namespace hardpack
