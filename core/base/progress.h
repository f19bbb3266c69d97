// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace hardpack {

// The result of Step(units) of a resumable stage. Every planning stage has the same shape:
//   Begin(inputs)      checks its inputs, resets the stage; bounded, cheap
//   Step(units)        does at most that many units of work (a row, an expansion, a perturbation)
//   result()           valid once Step has returned kDone
// A stage holds no pointer to its inputs: the caller passes the inputs of Begin to each Step again,
// unchanged, so that the whole state stays trivially copyable.
enum class [[nodiscard]] Progress : uint8_t{kBusy, kDone};

}  // namespace hardpack
