// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "hal/watchdog.h"
#include "port_linux/file_descriptor.h"
#include "port_linux/open_outcome.h"

namespace hardpack {

// The service manager's side of the watchdog, as systemd's sd_notify(3) and sd_watchdog_enabled(3)
// describe it: datagrams of text to the socket that NOTIFY_SOCKET names. A refused datagram is
// tried again with the next Feed.
class ServiceWatchdog final : public Watchdog {
 public:
  // What the service manager told this process, once at start-up. Without NOTIFY_SOCKET nobody
  // watches, which is no failure; kInvalidArgument: a variable makes no sense; kSystemError.
  OpenOutcome Open();

  void Ready() override;
  void Feed(uint64_t now_ns) override;
  void Stopping() override;
  uint64_t fed() const override { return fed_; }

  // How often the manager wants to be told at the least; 0: it does not watch.
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
