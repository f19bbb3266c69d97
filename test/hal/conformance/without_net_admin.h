// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/capability.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace hardpack {

// Without CAP_NET_ADMIN in this thread, and those it starts, for as long as it lives. Nothing to do
// for an ordinary user.
class WithoutNetAdmin {
 public:
  WithoutNetAdmin() {
    syscall(SYS_capget, &header_, before_);
    __user_cap_data_struct data[2] = {before_[0], before_[1]};
    data[0].effective &= ~(1u << CAP_NET_ADMIN);
    syscall(SYS_capset, &header_, data);
  }
  WithoutNetAdmin(const WithoutNetAdmin&) = delete;
  WithoutNetAdmin& operator=(const WithoutNetAdmin&) = delete;
  ~WithoutNetAdmin() { syscall(SYS_capset, &header_, before_); }

 private:
  __user_cap_header_struct header_{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct before_[2] = {};
};

}  // namespace hardpack
