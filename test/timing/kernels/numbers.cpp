// SPDX-License-Identifier: Apache-2.0
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "test/timing/kernels/kernels.h"

// Matrices, filters, transforms and arithmetic.

namespace hardpack::timing::kernels {

constexpr int kOrder = 16;

[[gnu::noinline]] void MatrixProduct() {
  HP_LOOP_BOUND(kOrder)
  for (int row = 0; row < kOrder; ++row) {
    HP_LOOP_BOUND(kOrder)
    for (int column = 0; column < kOrder; ++column) {
      int32_t sum = 0;
      HP_LOOP_BOUND(kOrder)
      for (int k = 0; k < kOrder; ++k) {
        sum += in[row * kOrder + k] * in[512 + k * kOrder + column];
      }
      out[row * kOrder + column] = sum;
    }
  }
}

[[gnu::noinline]] void Transpose() {
  HP_LOOP_BOUND(kOrder)
  for (int row = 0; row < kOrder; ++row) {
    HP_LOOP_BOUND(kOrder)
    for (int column = 0; column < kOrder; ++column) {
      out[column * kOrder + row] = in[row * kOrder + column];
    }
  }
}

[[gnu::noinline]] void FirFilter() {
  constexpr int kTaps = 32;
  constexpr int kSamples = 256;
  HP_LOOP_BOUND(kSamples)
  for (int sample = 0; sample < kSamples; ++sample) {
    float sum = 0.0f;
    HP_LOOP_BOUND(kTaps)
    for (int tap = 0; tap < kTaps; ++tap) sum += real_in[sample + tap] * real_in[900 + tap];
    real_out[sample] = sum;
  }
}

// A biquad, direct form I.
[[gnu::noinline]] void IirFilter() {
  float x1 = 0.0f;
  float x2 = 0.0f;
  float y1 = 0.0f;
  float y2 = 0.0f;
  HP_LOOP_BOUND(512)
  for (int k = 0; k < 512; ++k) {
    const float x = real_in[k];
    const float y = 0.2f * x + 0.4f * x1 + 0.2f * x2 + 0.5f * y1 - 0.3f * y2;
    x2 = x1;
    x1 = x;
    y2 = y1;
    y1 = y;
    real_out[k] = y;
  }
}

// Of 8 x 8 numbers, by rows and then by columns; real_in[64 ..] is the matrix of the transform.
[[gnu::noinline]] void DiscreteCosineTransform() {
  constexpr int kSide = 8;
  HP_LOOP_BOUND(2)
  for (int pass = 0; pass < 2; ++pass) {
    const float* from = pass == 0 ? real_in : real_out + 64;
    float* to = pass == 0 ? real_out + 64 : real_out;
    HP_LOOP_BOUND(kSide)
    for (int line = 0; line < kSide; ++line) {
      HP_LOOP_BOUND(kSide)
      for (int u = 0; u < kSide; ++u) {
        float sum = 0.0f;
        HP_LOOP_BOUND(kSide)
        for (int k = 0; k < kSide; ++k) sum += from[line * kSide + k] * real_in[64 + u * kSide + k];
        to[u * kSide + line] = sum;
      }
    }
  }
}

// Radix 2, in place, decimation in frequency: real_out[0 ..] real, [64 ..] imaginary; the twiddles
// are real_in[0 ..] and [64 ..]. In each stage the blocks share half as many butterflies as there
// are numbers.
[[gnu::noinline]] void FastFourierTransform() {
  constexpr int kSize = 64;
  constexpr int kStages = 6;
  HP_LOOP_BOUND(kSize)
  for (int k = 0; k < kSize; ++k) {
    real_out[k] = real_in[128 + k];
    real_out[kSize + k] = 0.0f;
  }
  int half = kSize / 2;
  HP_LOOP_BOUND_INNER(kStages, kSize - 1)
  for (int stage = 0; stage < kStages; ++stage, half /= 2) {
    HP_LOOP_BOUND_INNER(kSize / 2, kSize / 2)
    for (int block = 0; block < kSize; block += 2 * half) {
      HP_LOOP_BOUND(kSize / 2)
      for (int k = block; k < block + half; ++k) {
        const float re = real_out[k] - real_out[k + half];
        const float im = real_out[kSize + k] - real_out[kSize + k + half];
        real_out[k] += real_out[k + half];
        real_out[kSize + k] += real_out[kSize + k + half];
        const float w_re = real_in[(k - block) << stage];
        const float w_im = real_in[kSize + ((k - block) << stage)];
        real_out[k + half] = re * w_re - im * w_im;
        real_out[kSize + k + half] = re * w_im + im * w_re;
      }
    }
  }
}

[[gnu::noinline]] void Convolution() {
  constexpr int kSide = 24;
  HP_LOOP_BOUND(kSide - 2)
  for (int y = 1; y < kSide - 1; ++y) {
    HP_LOOP_BOUND(kSide - 2)
    for (int x = 1; x < kSide - 1; ++x) {
      int32_t sum = 0;
      HP_LOOP_BOUND(3)
      for (int dy = -1; dy <= 1; ++dy) {
        HP_LOOP_BOUND(3)
        for (int dx = -1; dx <= 1; ++dx) {
          sum += in[(y + dy) * kSide + x + dx] * in[900 + (dy + 1) * 3 + dx + 1];
        }
      }
      out[y * kSide + x] = sum;
    }
  }
}

constexpr int kUnknowns = 12;
constexpr int kPairs = kUnknowns * (kUnknowns - 1) / 2;

void FillDominant() {
  FillRandom();
  for (int k = 0; k < kUnknowns; ++k) real_in[k * kUnknowns + k] = 30.0f;
}

// Gauss, without pivoting, in place in real_in: triangular loops.
[[gnu::noinline]] void LuDecomposition() {
  HP_LOOP_BOUND_INNER(kUnknowns - 1, kPairs)
  for (int k = 0; k < kUnknowns - 1; ++k) {
    HP_LOOP_BOUND(kUnknowns - 1)
    for (int row = k + 1; row < kUnknowns; ++row) {
      const float factor = real_in[row * kUnknowns + k] / real_in[k * kUnknowns + k];
      real_in[row * kUnknowns + k] = factor;
      HP_LOOP_BOUND(kUnknowns - 1)
      for (int column = k + 1; column < kUnknowns; ++column) {
        real_in[row * kUnknowns + column] -= factor * real_in[k * kUnknowns + column];
      }
    }
  }
}

// x = b behind the diagonal of L, by rows.
[[gnu::noinline]] void ForwardSubstitution() {
  HP_LOOP_BOUND_INNER(kUnknowns, kPairs)
  for (int row = 0; row < kUnknowns; ++row) {
    float sum = real_in[512 + row];
    HP_LOOP_BOUND(kUnknowns - 1)
    for (int column = 0; column < row; ++column) {
      sum -= real_in[row * kUnknowns + column] * real_out[column];
    }
    real_out[row] = sum / real_in[row * kUnknowns + row];
  }
}

[[gnu::noinline]] void NewtonSquareRoots() {
  HP_LOOP_BOUND(64)
  for (int k = 0; k < 64; ++k) {
    const float value = Abs(real_in[k]) + 1.0f;
    float root = value;
    HP_LOOP_BOUND(6)
    for (int step = 0; step < 6; ++step) root = 0.5f * (root + value / root);
    real_out[k] = root;
  }
}

[[gnu::noinline]] void Polynomial() {
  HP_LOOP_BOUND(128)
  for (int k = 0; k < 128; ++k) {
    float value = 0.0f;
    HP_LOOP_BOUND(10)
    for (int power = 0; power < 10; ++power) value = value * real_in[k] + real_in[512 + power];
    real_out[k] = value;
  }
}

[[gnu::noinline]] void Fibonacci() {
  uint32_t last = 0;
  uint32_t next = 1;
  HP_LOOP_BOUND(40)
  for (int k = 0; k < 40; ++k) {
    const uint32_t sum = last + next;
    last = next;
    next = sum;
    out[k] = static_cast<int32_t>(sum);
  }
}

// A nest in which each loop runs as often as the one around it has.
[[gnu::noinline]] void TriangularNest() {
  constexpr int kSide = 16;
  int32_t sum = 0;
  HP_LOOP_BOUND_INNER(kSide, kSide * (kSide + 1) / 2)
  for (int i = 0; i < kSide; ++i) {
    HP_LOOP_BOUND(kSide)
    for (int j = 0; j <= i; ++j) sum += in[i] * in[j] ^ sum;
  }
  out[0] = sum;
}

void FillFibonacci() {
  in[0] = 1836311903;
  in[1] = 1134903170;
}

// Of two numbers below 2^31: the most steps that two of Fibonacci's take (Lame).
[[gnu::noinline]] void GreatestCommonDivisor() {
  auto a = static_cast<uint32_t>(in[0]);
  auto b = static_cast<uint32_t>(in[1]);
  HP_LOOP_BOUND(44)
  while (b != 0) {
    const uint32_t rest = a % b;
    a = b;
    b = rest;
  }
  out[0] = static_cast<int32_t>(a);
}

void FillOnes() {
  for (int32_t& number : in) number = -1;
}

[[gnu::noinline]] void ModularPower() {
  constexpr uint32_t kModulus = 65521;
  uint32_t base = static_cast<uint32_t>(in[0]) % kModulus;
  uint32_t power = static_cast<uint32_t>(in[1]) & 0xffffu;
  uint32_t result = 1;
  HP_LOOP_BOUND(16)
  while (power != 0) {
    if ((power & 1u) != 0) result = result * base % kModulus;
    base = base * base % kModulus;
    power >>= 1;
  }
  out[0] = static_cast<int32_t>(result);
}

[[gnu::noinline]] void CountBits() {
  int32_t count = 0;
  HP_LOOP_BOUND(64)
  for (int k = 0; k < 64; ++k) {
    auto word = static_cast<uint32_t>(in[k]);
    HP_LOOP_BOUND(32)
    while (word != 0) {
      word &= word - 1;
      ++count;
    }
  }
  out[0] = count;
}

const Kernel kNumberKernels[] = {
    {"MatrixProduct", FillRandom, MatrixProduct},
    {"Transpose", FillRandom, Transpose},
    {"FirFilter", FillRandom, FirFilter},
    {"IirFilter", FillRandom, IirFilter},
    {"DiscreteCosineTransform", FillRandom, DiscreteCosineTransform},
    {"FastFourierTransform", FillRandom, FastFourierTransform},
    {"Convolution", FillRandom, Convolution},
    {"LuDecomposition", FillDominant, LuDecomposition},
    {"ForwardSubstitution", FillDominant, ForwardSubstitution},
    {"NewtonSquareRoots", FillRandom, NewtonSquareRoots},
    {"Polynomial", FillRandom, Polynomial},
    {"Fibonacci", FillRandom, Fibonacci},
    {"TriangularNest", FillRandom, TriangularNest},
    {"GreatestCommonDivisor", FillFibonacci, GreatestCommonDivisor},
    {"ModularPower", FillOnes, ModularPower},
    {"CountBits", FillOnes, CountBits},
    {},
};

}  // namespace hardpack::timing::kernels
