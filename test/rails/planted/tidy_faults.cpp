// SPDX-License-Identifier: Apache-2.0
// A fault for each family of checks: bugprone-integer-division, cert-flp30-c and, in the core,
// cppcoreguidelines-pro-type-member-init.
struct Sum {
  float value;
};

float Planted(int places) {
  Sum sum;
  sum.value = static_cast<float>(places / 2) + places / 2;
  for (float x = 0.0f; x < 1.0f; x += 0.1f) sum.value += x;
  return sum.value;
}
