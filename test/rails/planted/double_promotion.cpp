// SPDX-License-Identifier: Apache-2.0
bool Planted(float value) { return value * 0.1 > 1.0; }
