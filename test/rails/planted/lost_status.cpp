// SPDX-License-Identifier: Apache-2.0
#include "core/base/status.h"

hardpack::Status Fails();
void Planted() { Fails(); }
