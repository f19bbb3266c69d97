// SPDX-License-Identifier: Apache-2.0
// Linked with the whole of core and hal, the compiler's own library, the four functions of
// test/bare_metal/memory_functions.cpp and nothing else: -nostdlib -ffreestanding.
#include "hal/onboard/vehicle_loop/vehicle_loop.h"

namespace {

alignas(hardpack::VehicleLoop) unsigned char loop_memory[sizeof(hardpack::VehicleLoop)];

}  // namespace

// Nothing runs it: that it links is what is shown.
extern "C" void freestanding_start() {
  auto* const loop = reinterpret_cast<hardpack::VehicleLoop*>(loop_memory);
  static hardpack::TickOutput output;
  static_cast<void>(loop->Tick({}, output));
  for (;;) {
  }
}
