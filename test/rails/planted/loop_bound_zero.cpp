// SPDX-License-Identifier: Apache-2.0
#include "core/base/loop_bound.h"

int Planted(int n) {
  int sum = 0;
  HP_LOOP_BOUND(0)
  for (int i = 0; i < n; ++i) sum += sum ^ i;
  return sum;
}
