// SPDX-License-Identifier: Apache-2.0
void Planted() {
  char frame[600];
  for (char& byte : frame) byte = 1;
  asm volatile("" ::"r"(frame) : "memory");
}
