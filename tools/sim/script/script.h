// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "port_linux/files/read_outcome.h"
#include "tools/sim/script/scripted_vehicle.h"

// Scripts of what goes wrong with a ScriptedVehicle, one event a line; # begins a comment:
//
//   at 5.0 drive-silent left on        seconds since the start, command, arguments
//
// SIDE is left, right or both; SWITCH on or off; numbers are decimal or 0x hexadecimal.
//
//   drive-silent SIDE SWITCH     neither sends nor hears
//   heartbeat SIDE SWITCH        off: it sends none
//   process-data SIDE SWITCH     off: it sends none
//   reboot SIDE [quiet]          quiet: without the boot-up message
//   key SIDE SWITCH              off: under-voltage, then silence; on: it boots
//   emcy SIDE CODE [REGISTER [FAULT_ID]]    the message alone
//   fault SIDE CODE [REGISTER [FAULT_ID]]   with the state machine's fault
//   sdo-abort SIDE INDEX CODE    each transfer of that object is aborted; code 0: no longer
//   sdo-silent SIDE INDEX SWITCH is never answered
//   sdo-keep SIDE INDEX SWITCH   writing is answered, and nothing is written
//   object SIDE INDEX SUB VALUE  identity, mapping, type ...: as if it had been made so
//   mode-refused SIDE SWITCH     6061h stays what it is
//   lose-enable SIDE             leaves operation enabled
//   nmt SIDE operational|pre-operational|stopped
//   opposite SIDE SWITCH         turns against its command
//   blocked SIDE SWITCH          does not turn
//   frozen SIDE SWITCH           reports the same speed for ever
//   controller-silent SWITCH     of a motion controller: neither sends nor hears
//   controller-deaf SWITCH       hears nothing
//   controller-frozen SWITCH     reports the same motion for ever
//   controller-refuses SWITCH    does not follow
//   controller-bad-crc SWITCH    of all that it sends
//   controller-fault BITS        raises faults of its own
//   controller-version NUMBER    of the protocol, that it says it has
//   controller-reboot            says nothing, and then starts anew
//   traction PERMILLE            so much of what the wheels turn moves the vehicle: 0, they spin
//   speed-offset SIDE RPM        of the reported speed of the motor
//   can-frame ID#HEX [PERIOD_S COUNT]    of a node that should not be there
//   bus-error bus-off|passive|warning    as the controller would report it
//   lidar SWITCH, ins SWITCH     off: silent; of the labels too: labels SWITCH, labels-foreign,
//                                -duplicate, -garbage, -loss ...
//   lidar-foreign SWITCH, ins-foreign SWITCH       from another address instead
//   lidar-duplicate SWITCH, ins-duplicate SWITCH   everything twice
//   lidar-garbage SWITCH, ins-garbage SWITCH       random bytes besides
//   lidar-loss PERMILLE, ins-loss PERMILLE
//   lidar-delay MS, ins-delay MS                   later by so much
//   lidar-delay-growth MS, ins-delay-growth MS     and from now on by so much more every second
//   lidar-reorder N, ins-reorder N                 N at a time, in an order drawn; 0: no longer
//   lidar-restart                its clock, its frame count and its init id begin anew; a
//                                Velodyne's clock at 0
//   lidar-clock MS               its clock jumps ahead by so much; negative: back
//   lidar-blind FROM TO HOW      from one direction of the body anticlockwise to the other [deg],
//                                ahead is 0: lost (its packets are), invalid (its columns say so),
//                                dark (nothing comes back), covered (everything from the window),
//                                or none: no longer. A Velodyne's columns say nothing of
//                                themselves: invalid is dark there
//   lidar-frozen SWITCH          each column says again what it said in the revolution before
//   lidar-turned YAW PITCH ROLL  its mount, so many degrees from where it is said to be
//   lidar-rain PERMILLE          of its rays that see a drop 1 to 12 m away instead of what is
//                                behind it; 3 in 100 returns are lost besides; 0: no longer
//   lidar-dust FROM TO RANGE_M PERMILLE    of its rays from one direction of the body
//                                anticlockwise to the other [degree] that see dust, from 1.5 m to
//                                RANGE_M away; 0: no longer
//   labels-are CODE              every return is named so; 0: no longer
//   labels-mistake CODE FOR      returns of one class are named as another; 0 0: no longer
//   ins-cut BYTES                datagrams of 1 .. BYTES bytes; 0: one a message
//   ins-mode MODE                InsStatus, 0 .. 3
//   ins-jump NORTH EAST          its positions are so many metres off, from now on
//   ins-drift NORTH EAST         and so many metres a second more; 0 0: no further
//   box X Y SIZE HEIGHT          appears in the world
//   box-ahead AHEAD LEFT SIZE HEIGHT    the same, so many metres from where the vehicle then is
//   world NAME [SEED]            the world is another one (tools/sim/world/named_worlds.h)
//   quit                         ends the simulation

namespace hardpack::sim {

// Appends the event of one line, if it has one. kInvalidArgument: it is none; the message says why.
ReadOutcome ParseScriptLine(std::string_view line, std::vector<ScriptEvent>& script);

// Every line; messages begin with name:line.
ReadOutcome ParseScript(std::string_view text, std::string_view name,
                        std::vector<ScriptEvent>& script);

}  // namespace hardpack::sim
