// SPDX-License-Identifier: Apache-2.0
float Planted(float value) { return __builtin_sinf(value); }
