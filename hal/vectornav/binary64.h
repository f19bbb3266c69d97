// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/status.h"

// IEEE-754 binary64 numbers as their bits: the sensor sends positions in this form, and core and
// hal use single precision only. Integer arithmetic only, the same on every processor.

namespace hardpack::vectornav {

// The number times 10^9, rounded to the nearest integer, halves away from zero: degrees become 1e-9
// degrees. Exact except for that one rounding. kNotFinite: NaN or infinite; kCapacityExceeded:
// beyond the range of int64_t. Then `billionths` is unchanged. Cost: constant.
Status BillionthsFromBinary64(uint64_t bits, int64_t& billionths);

// The nearest float, ties to even, as a processor converts: including subnormals; infinite beyond
// the largest float; NaN stays NaN. Cost: constant.
float FloatFromBinary64(uint64_t bits);

// The inverse, for encoders. The nearest binary64 to billionths / 10^9, ties to even. Cost: at most
// 87 steps of a long division.
uint64_t Binary64FromBillionths(int64_t billionths);

// Exact. Cost: constant, for a subnormal 23 steps.
uint64_t Binary64FromFloat(float value);

}  // namespace hardpack::vectornav
