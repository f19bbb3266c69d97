// SPDX-License-Identifier: Apache-2.0
void Planted(int size) {
  void* frame = __builtin_alloca(static_cast<unsigned>(size));
  asm volatile("" ::"r"(frame) : "memory");
}
