// SPDX-License-Identifier: Apache-2.0
// The four functions that compilers call where they please (C++ [intro.compliance] leaves them to a
// freestanding implementation), where no C library is linked. A byte at a time, so that the bounds
// of what calls them hold with any library that is no slower.
#include <stddef.h>
#include <stdint.h>

extern "C" {

void* memcpy(void* to, const void* from, size_t bytes) {
  volatile uint8_t* target = static_cast<uint8_t*>(to);
  const uint8_t* source = static_cast<const uint8_t*>(from);
  for (size_t i = 0; i < bytes; ++i) target[i] = source[i];
  return to;
}

void* memmove(void* to, const void* from, size_t bytes) {
  if (to <= from) return memcpy(to, from, bytes);
  volatile uint8_t* target = static_cast<uint8_t*>(to);
  const uint8_t* source = static_cast<const uint8_t*>(from);
  for (size_t i = bytes; i > 0; --i) target[i - 1] = source[i - 1];
  return to;
}

void* memset(void* to, int value, size_t bytes) {
  volatile uint8_t* target = static_cast<uint8_t*>(to);
  for (size_t i = 0; i < bytes; ++i) target[i] = static_cast<uint8_t>(value);
  return to;
}

int memcmp(const void* a, const void* b, size_t bytes) {
  const volatile uint8_t* first = static_cast<const uint8_t*>(a);
  const uint8_t* second = static_cast<const uint8_t*>(b);
  for (size_t i = 0; i < bytes; ++i) {
    if (first[i] != second[i]) return first[i] < second[i] ? -1 : 1;
  }
  return 0;
}

}  // extern "C"
