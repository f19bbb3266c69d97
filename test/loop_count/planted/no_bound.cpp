// SPDX-License-Identifier: Apache-2.0
// A loop without HP_LOOP_BOUND: the counting build must refuse it. HP_PLANTED_FINE makes it right.
#include "core/base/loop_bound.h"

int Sum(const int (&numbers)[4]) {
  int sum = 0;
#if defined(HP_PLANTED_FINE)
  HP_LOOP_BOUND(4)
#endif
  for (const int number : numbers) sum += number;
  return sum;
}
