// SPDX-License-Identifier: Apache-2.0
int Planted() { return 3; }
