// SPDX-License-Identifier: Apache-2.0
void Planted() { throw 1; }
