// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <type_traits>

#include "test/decision/report.h"

namespace hardpack::decision {

// Memory for one big object, which is constructed anew, on top of the platform's fresh memory, for
// each scenario. Instances are static and go to .bss.psram: where the platform has a section of
// that name it is the large external memory, elsewhere it is .bss like any other.
template <typename T>
class Storage {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  T& Construct() {
    for (std::byte& byte : bytes_) byte = std::byte{kFreshMemory};
    return *new (bytes_) T;
  }

 private:
  alignas(T) std::byte bytes_[sizeof(T)];
};

}  // namespace hardpack::decision

#define HP_BIG_MEMORY __attribute__((section(".bss.psram")))
