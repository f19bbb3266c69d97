// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "port_linux/files/read_outcome.h"

// A part of an experiment's seeds, so that several processes or machines share its work.

namespace hardpack::experiment {

struct Shard {
  int64_t number = 1;  // 1 .. count
  int64_t count = 1;

  // Every seed belongs to exactly one shard.
  bool Has(uint64_t seed) const {
    return seed % static_cast<uint64_t>(count) == static_cast<uint64_t>(number - 1);
  }
};

// Parses "2/8". kInvalidArgument: anything else.
ReadOutcome ParseShard(const std::string& text, Shard& shard);

}  // namespace hardpack::experiment
