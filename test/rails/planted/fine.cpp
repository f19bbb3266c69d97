// SPDX-License-Identifier: Apache-2.0
// Compiles under the rules of core: what its neighbours fail for is their violation alone.
#include "core/base/math.h"

float Planted(float value) {
  char frame[256];
  for (char& byte : frame) byte = static_cast<char>(value);
  asm volatile("" ::"r"(frame) : "memory");
  return hardpack::Sqrt(value);
}
