// SPDX-License-Identifier: Apache-2.0
short Planted(int value) {
  short narrow = value;
  return narrow;
}
