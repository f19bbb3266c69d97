// SPDX-License-Identifier: Apache-2.0
// The same with the other kind of loop.
#include "core/base/loop_bound.h"

int Sum(const int (&numbers)[4]) {
  int sum = 0;
  int i = 0;
#if defined(HP_PLANTED_FINE)
  HP_LOOP_BOUND(4)
#endif
  while (i < 4) sum += numbers[i++];
  return sum;
}
