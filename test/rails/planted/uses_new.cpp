// SPDX-License-Identifier: Apache-2.0
int* Planted() { return new int(3); }
