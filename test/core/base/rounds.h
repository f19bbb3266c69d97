// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace hardpack {

/// How often a test repeats what it draws by a seed: `all` times, and `few` where every loop is
/// counted (test/loop_count), with sanitizers mostly: there a round takes fifty times as long, and
/// what it is about, loops and memory, a few rounds show as well. Bounds on what all rounds
/// together must reach follow in the same way.
template <typename T>
constexpr T Rounds([[maybe_unused]] T all, [[maybe_unused]] T few) {
#if defined(HP_COUNT_LOOPS_OF_TESTS)
  return few;
#else
  return all;
#endif
}

}  // namespace hardpack
