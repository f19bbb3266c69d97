// SPDX-License-Identifier: Apache-2.0
void Planted() {
  char frame[700];  // beyond 512 even where a red zone takes the first 128
  for (char& byte : frame) byte = 1;
  asm volatile("" ::"r"(frame) : "memory");
}
