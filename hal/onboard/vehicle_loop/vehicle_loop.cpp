// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/vehicle_loop/vehicle_loop.h"

#include "hal/onboard/vehicle_loop/vehicle_loop_tick.h"

namespace hardpack {

template class BasicVehicleLoop<Warthog>;
template class BasicVehicleLoop<WarthogVelodyne>;
template class BasicVehicleLoop<TwistBase>;

}  // namespace hardpack
