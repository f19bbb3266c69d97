// SPDX-License-Identifier: Apache-2.0
#include "hal/ouster/ouster.h"
