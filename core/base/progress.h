// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace hardpack {

// What Step(units) of a resumable stage says. Every planning stage has the same shape:
//   Begin(inputs)      checks its inputs, resets the stage; bounded, cheap
//   Step(units)        does at most that many units of work (a row, an expansion, a perturbation)
//   result()           valid once Step has returned kDone
// A stage holds no pointer to its inputs: what Begin was given is given to each Step again,
// unchanged, so that the whole state stays trivially copyable.
enum class [[nodiscard]] Progress : uint8_t{kBusy, kDone};

}  // namespace hardpack
