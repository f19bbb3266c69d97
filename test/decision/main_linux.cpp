// SPDX-License-Identifier: Apache-2.0
#include "test/decision/report.h"

int main() {
  hardpack::decision::RunAll();
}
