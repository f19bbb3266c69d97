// SPDX-License-Identifier: Apache-2.0
// The whole tick of a vehicle (hal/onboard/vehicle_loop/vehicles.h), as tick_play.h says.
#define HP_FUZZED_VEHICLE Warthog
#include "test/fuzz/tick_play.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 2) return 0;
  hardpack::Play(data, size).Run();
  return 0;
}
