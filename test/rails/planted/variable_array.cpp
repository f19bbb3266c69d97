// SPDX-License-Identifier: Apache-2.0
void Planted(int size) {
  char frame[size];
  asm volatile("" ::"r"(frame) : "memory");
}
