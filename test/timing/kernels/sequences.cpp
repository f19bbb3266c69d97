// SPDX-License-Identifier: Apache-2.0
#include "core/base/loop_bound.h"
#include "test/timing/kernels/kernels.h"

// Sorts, searches, checksums and state machines.

namespace hardpack::timing::kernels {

constexpr int kItems = 64;
constexpr int kItemPairs = kItems * (kItems - 1) / 2;

void Swap(int32_t& a, int32_t& b) {
  const int32_t kept = a;
  a = b;
  b = kept;
}

[[gnu::noinline]] void InsertionSort() {
  HP_LOOP_BOUND_INNER(kItems - 1, kItemPairs)
  for (int k = 1; k < kItems; ++k) {
    const int32_t item = in[k];
    int place = k;
    HP_LOOP_BOUND(kItems - 1)
    while (place > 0 && in[place - 1] > item) {
      in[place] = in[place - 1];
      --place;
    }
    in[place] = item;
  }
}

[[gnu::noinline]] void BubbleSort() {
  HP_LOOP_BOUND_INNER(kItems - 1, kItemPairs)
  for (int last = kItems - 1; last > 0; --last) {
    HP_LOOP_BOUND(kItems - 1)
    for (int k = 0; k < last; ++k) {
      if (in[k] > in[k + 1]) Swap(in[k], in[k + 1]);
    }
  }
}

[[gnu::noinline]] void SelectionSort() {
  HP_LOOP_BOUND_INNER(kItems - 1, kItemPairs)
  for (int first = 0; first < kItems - 1; ++first) {
    int least = first;
    HP_LOOP_BOUND(kItems - 1)
    for (int k = first + 1; k < kItems; ++k) {
      if (in[k] < in[least]) least = k;
    }
    Swap(in[first], in[least]);
  }
}

// From the bottom up, between `in` and `out`.
[[gnu::noinline]] void MergeSort() {
  int32_t* from = in;
  int32_t* to = out;
  HP_LOOP_BOUND_INNER(6, kItems - 1)
  for (int width = 1; width < kItems; width *= 2) {
    HP_LOOP_BOUND_INNER(kItems / 2, kItems)
    for (int first = 0; first < kItems; first += 2 * width) {
      int left = first;
      int right = first + width;
      HP_LOOP_BOUND(kItems)
      for (int k = first; k < first + 2 * width; ++k) {
        const bool takes_left =
            left < first + width && (right == first + 2 * width || from[left] <= from[right]);
        to[k] = takes_left ? from[left] : from[right];
        if (takes_left) {
          ++left;
        } else {
          ++right;
        }
      }
    }
    int32_t* const kept = from;
    from = to;
    to = kept;
  }
}

void SiftDown(int root, int size) {
  HP_LOOP_BOUND(6)
  while (2 * root + 1 < size) {
    int child = 2 * root + 1;
    if (child + 1 < size && in[child + 1] > in[child]) ++child;
    if (in[root] >= in[child]) return;
    Swap(in[root], in[child]);
    root = child;
  }
}

[[gnu::noinline]] void HeapSort() {
  HP_LOOP_BOUND(kItems / 2)
  for (int root = kItems / 2 - 1; root >= 0; --root) SiftDown(root, kItems);
  HP_LOOP_BOUND(kItems - 1)
  for (int size = kItems - 1; size > 0; --size) {
    Swap(in[0], in[size]);
    SiftDown(0, size);
  }
}

// Lomuto's partition, and an ascending input: each leaves one item fewer.
[[gnu::noinline]] void QuickSort() {
  int32_t* const lows = out;  // of what is left to be sorted
  int32_t* const highs = out + kItems;
  int count = 1;
  lows[0] = 0;
  highs[0] = kItems - 1;
  HP_LOOP_BOUND_INNER(kItems - 1, kItemPairs)
  while (count > 0) {
    --count;
    const int low = lows[count];
    const int high = highs[count];
    int middle = low;
    HP_LOOP_BOUND(kItems - 1)
    for (int k = low; k < high; ++k) {
      if (in[k] <= in[high]) Swap(in[k], in[middle++]);
    }
    Swap(in[middle], in[high]);
    if (low < middle - 1) {
      lows[count] = low;
      highs[count++] = middle - 1;
    }
    if (middle + 1 < high) {
      lows[count] = middle + 1;
      highs[count++] = high;
    }
  }
}

[[gnu::noinline]] void BinarySearch() {
  HP_LOOP_BOUND(64)
  for (int query = 0; query < 64; ++query) {
    int low = 0;
    int high = 1023;
    HP_LOOP_BOUND(10)
    while (low < high) {
      const int middle = (low + high) / 2;
      if (in[middle] < 1023) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    out[query] = low;
  }
}

void FillEqual() {
  for (int32_t& number : in) number = 'a';
  in[1023] = 'b';
}

// In 256 characters for 8, of which all but the last agree everywhere.
[[gnu::noinline]] void StringSearch() {
  constexpr int kText = 256;
  constexpr int kPattern = 8;
  out[0] = -1;
  HP_LOOP_BOUND(kText - kPattern + 1)
  for (int at = 0; at <= kText - kPattern; ++at) {
    int same = 0;
    HP_LOOP_BOUND(kPattern)
    while (same < kPattern && in[at + same] == in[1024 - kPattern + same]) ++same;
    if (same == kPattern) out[0] = at;
  }
}

// What Knuth, Morris and Pratt compute first: all steps back together are no more than those ahead.
[[gnu::noinline]] void PrefixFunction() {
  out[0] = 0;
  HP_LOOP_BOUND_INNER(kItems - 1, kItems - 1)
  for (int k = 1; k < kItems; ++k) {
    int length = out[k - 1];
    HP_LOOP_BOUND(kItems - 1)
    while (length > 0 && in[1024 - kItems + length] != in[1024 - kItems + k]) {
      length = out[length - 1];
    }
    if (in[1024 - kItems + length] == in[1024 - kItems + k]) ++length;
    out[k] = length;
  }
}

[[gnu::noinline]] void CrcByBits() {
  uint32_t crc = ~0u;
  HP_LOOP_BOUND(128)
  for (int k = 0; k < 128; ++k) {
    crc ^= static_cast<uint32_t>(in[k]) & 0xffu;
    HP_LOOP_BOUND(8)
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1u) != 0 ? 0xedb88320u : 0u);
  }
  out[0] = static_cast<int32_t>(~crc);
}

[[gnu::noinline]] void CrcByTable() {
  uint32_t crc = ~0u;
  HP_LOOP_BOUND(512)
  for (int k = 0; k < 512; ++k) {
    const uint32_t index = (crc ^ static_cast<uint32_t>(in[k])) & 0xffu;
    crc = crc >> 8 ^ static_cast<uint32_t>(in[512 + index]);
  }
  out[0] = static_cast<int32_t>(~crc);
}

// 32 rounds of XTEA on 32 blocks.
[[gnu::noinline]] void Cipher() {
  HP_LOOP_BOUND(32)
  for (int block = 0; block < 32; ++block) {
    auto a = static_cast<uint32_t>(in[2 * block]);
    auto b = static_cast<uint32_t>(in[2 * block + 1]);
    uint32_t sum = 0;
    HP_LOOP_BOUND(32)
    for (int round = 0; round < 32; ++round) {
      a += ((b << 4 ^ b >> 5) + b) ^ (sum + static_cast<uint32_t>(in[100 + (sum & 3u)]));
      sum += 0x9e3779b9u;
      b += ((a << 4 ^ a >> 5) + a) ^ (sum + static_cast<uint32_t>(in[100 + (sum >> 11 & 3u)]));
    }
    out[2 * block] = static_cast<int32_t>(a);
    out[2 * block + 1] = static_cast<int32_t>(b);
  }
}

// Counts words, numbers and comments in characters.
[[gnu::noinline]] void StateMachine() {
  enum State { kNone, kWord, kNumber, kComment };
  State state = kNone;
  int32_t count[4] = {};
  HP_LOOP_BOUND(512)
  for (int k = 0; k < 512; ++k) {
    const int32_t character = in[k] & 0x7f;
    const bool is_letter = character >= 'a' && character <= 'z';
    const bool is_digit = character >= '0' && character <= '9';
    State next = state;
    if (state == kComment) {
      next = character == '\n' ? kNone : kComment;
    } else if (character == '#') {
      next = kComment;
    } else if (is_letter) {
      next = kWord;
    } else if (is_digit) {
      next = state == kWord ? kWord : kNumber;
    } else {
      next = kNone;
    }
    if (next != state) ++count[next];
    state = next;
  }
  HP_LOOP_BOUND(4)
  for (int k = 0; k < 4; ++k) out[k] = count[k];
}

[[gnu::noinline]] void Histogram() {
  HP_LOOP_BOUND(64)
  for (int k = 0; k < 64; ++k) out[k] = 0;
  HP_LOOP_BOUND(1024)
  for (int k = 0; k < 1024; ++k) ++out[in[k] & 63];
}

[[gnu::noinline]] void RunLengths() {
  int runs = 0;
  HP_LOOP_BOUND_INNER(512, 512)
  for (int k = 0; k < 512;) {
    const int32_t first = in[k];
    int length = 0;
    HP_LOOP_BOUND(512)
    while (k < 512 && in[k] == first) {
      ++k;
      ++length;
    }
    out[2 * runs] = first;
    out[2 * runs + 1] = length;
    ++runs;
  }
}

constexpr int kSieve = 1000;

constexpr int Struck() {
  int struck = 0;
  for (int number = 2; number * number < kSieve; ++number) {
    bool is_prime = true;
    for (int divisor = 2; divisor < number; ++divisor) is_prime &= number % divisor != 0;
    if (!is_prime) continue;
    for (int multiple = number * number; multiple < kSieve; multiple += number) ++struck;
  }
  return struck;
}

[[gnu::noinline]] void Sieve() {
  HP_LOOP_BOUND(kSieve)
  for (int k = 0; k < kSieve; ++k) out[k] = 1;
  HP_LOOP_BOUND_INNER(30, Struck())
  for (int number = 2; number * number < kSieve; ++number) {
    if (out[number] == 0) continue;
    HP_LOOP_BOUND(kSieve / 2)
    for (int multiple = number * number; multiple < kSieve; multiple += number) out[multiple] = 0;
  }
}

const Kernel kSequenceKernels[] = {
    {"InsertionSort", FillDescending, InsertionSort},
    {"BubbleSort", FillDescending, BubbleSort},
    {"SelectionSort", FillDescending, SelectionSort},
    {"MergeSort", FillDescending, MergeSort},
    {"HeapSort", FillAscending, HeapSort},
    {"QuickSort", FillAscending, QuickSort},
    {"BinarySearch", FillAscending, BinarySearch},
    {"StringSearch", FillEqual, StringSearch},
    {"PrefixFunction", FillEqual, PrefixFunction},
    {"CrcByBits", FillRandom, CrcByBits},
    {"CrcByTable", FillRandom, CrcByTable},
    {"Cipher", FillRandom, Cipher},
    {"StateMachine", FillRandom, StateMachine},
    {"Histogram", FillRandom, Histogram},
    {"RunLengths", FillAscending, RunLengths},
    {"Sieve", FillAscending, Sieve},
    {},
};

}  // namespace hardpack::timing::kernels
