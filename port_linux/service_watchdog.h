// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "hal/watchdog.h"
#include "port_linux/file_descriptor.h"
#include "port_linux/open_outcome.h"

namespace hardpack {

// The service manager's side of the watchdog, following systemd's sd_notify(3) and
// sd_watchdog_enabled(3): text datagrams to the socket in NOTIFY_SOCKET. A refused datagram is
// retried with the next Feed.
class ServiceWatchdog final : public Watchdog {
 public:
  // Reads what the service manager told this process, once at start-up. Without NOTIFY_SOCKET there
  // is no watchdog, which is not a failure; kInvalidArgument: a variable makes no sense;
  // kSystemError.
  OpenOutcome Open();

  void Ready() override;
  void Feed(uint64_t now_ns) override;
  void Stopping() override;
  uint64_t fed() const override { return fed_; }

  // The longest interval the manager accepts; 0: it does not watch.
  uint64_t period_ns() const { return period_ns_; }

 private:
  OpenOutcome Connect(const std::string& path);
  bool Tell(std::string_view text);

  FileDescriptor socket_;
  uint64_t period_ns_ = 0;
  uint64_t next_ns_ = 0;
  uint64_t fed_ = 0;
  bool ready_owed_ = false;
};

}  // namespace hardpack
