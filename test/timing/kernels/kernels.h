// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// Small kernels of the kinds that timing benchmarks use, written from their textbook definitions,
// none of which the analyser of tools/proof/wcet was written for. Each runs on the input that takes
// it longest, as far as one is known; kernels_test.py holds its static bound to what is counted.

namespace hardpack::timing::kernels {

struct Kernel {
  const char* name;  // as c++filt has it, without its namespace
  void (*fill)();    // its input
  void (*run)();
};

// All of them; the last has no name.
extern const Kernel kNumberKernels[];
extern const Kernel kSequenceKernels[];
extern const Kernel kGraphKernels[];

// What the kernels read and write: one memory for all.
inline constexpr int kMostNumbers = 1024;
extern int32_t in[kMostNumbers];
extern int32_t out[kMostNumbers];
extern float real_in[kMostNumbers];
extern float real_out[kMostNumbers];

void FillRandom();      // in: 0 to 32767; real_in: -1 to 1
void FillDescending();  // in: kMostNumbers, kMostNumbers - 1, ...
void FillAscending();   // in: 0, 1, ...

}  // namespace hardpack::timing::kernels
