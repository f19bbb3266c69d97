// SPDX-License-Identifier: Apache-2.0
#include "test/rails/inline_loop.h"

int SumBelowTwice(int n) {
  return 2 * SumBelow(n);
}
