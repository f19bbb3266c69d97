// SPDX-License-Identifier: Apache-2.0
#include "test/rails/inline_loop.h"

int SumBelowTwice(int n);

int main(int arguments, char**) {
  return SumBelowTwice(arguments) == 2 * SumBelow(arguments) ? 0 : 1;
}
