// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hardpack::sim {

// The low `size` bytes of a number, lowest first.
template <typename Unsigned>
void Put(std::vector<uint8_t>& bytes, Unsigned value, size_t size = sizeof(Unsigned)) {
  for (size_t i = 0; i < size; ++i) {
    bytes.push_back(static_cast<uint8_t>(uint64_t{value} >> (8 * i)));
  }
}

}  // namespace hardpack::sim
