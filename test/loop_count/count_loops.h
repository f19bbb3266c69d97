// SPDX-License-Identifier: Apache-2.0
#pragma once

// Force-included before every source of the counting build: first the headers of others, then the
// keywords `for` and `while` with a tick of the counter that HP_LOOP_BOUND has just declared as
// hp_loop. In core and hal a loop without HP_LOOP_BOUND before it does not compile here, as there
// is no hp_loop (a loop inside another's body would take the outer one's:
// tools/proof/check_layers.py finds those).
//
// Tests (HP_COUNT_LOOPS_OF_TESTS) may have loops of their own without a bound: an hp_loop that
// counts nothing is there for them.

#if !defined(HP_COUNT_LOOPS)
#error "the counting build defines HP_COUNT_LOOPS"
#endif

// All headers that core and hal may use.
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <span>
#include <type_traits>

// Eigen's own loops are unrolled (core/odometry/covariance.cpp).
#include "core/base/assert.h"
#define eigen_assert(expression) HP_ASSERT(expression)
#include <Eigen/Core>

#if defined(HP_COUNT_LOOPS_OF_TESTS)
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <ostream>
#include <queue>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "gtest/gtest.h"

struct UncountedLoop {
  constexpr bool Tick() const { return true; }
};
inline constexpr UncountedLoop hp_loop;  // NOLINT: the name that HP_LOOP_BOUND gives its counter
#endif

// The body is the else branch, so that the tick comes before it whatever it is, and break and
// continue are the loop's own.
// It would put a space before the parameters, which would make them the body.
// clang-format off
#define for(...) for (__VA_ARGS__) if (hp_loop.Tick(); false) {} else
#define while(...) while ((__VA_ARGS__) && hp_loop.Tick())
// clang-format on
