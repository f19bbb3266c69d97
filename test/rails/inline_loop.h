// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/loop_bound.h"

// A loop in an inline function: every object that uses it has a copy, with a loop record, and the
// linker keeps one of the copies. The records of the others must go with them.
inline int SumBelow(int n) {
  int sum = 0;
  HP_LOOP_BOUND(1000)
  for (int i = 0; i < n; ++i) sum += sum ^ i;
  return sum;
}
