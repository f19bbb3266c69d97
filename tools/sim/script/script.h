// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "port_linux/files/read_outcome.h"
#include "tools/sim/script/scripted_vehicle.h"

// Fault scripts for a ScriptedVehicle, one event per line; # begins a comment:
//
//   at 5.0 drive-silent left on        seconds since the start, command, arguments
//
// SIDE is left, right or both; SWITCH on or off; numbers are decimal or 0x hexadecimal.
//
//   drive-silent SIDE SWITCH     neither sends nor receives
//   heartbeat SIDE SWITCH        off: it sends none
//   process-data SIDE SWITCH     off: it sends none
//   reboot SIDE [quiet]          quiet: without the boot-up message
//   key SIDE SWITCH              off: under-voltage, then silence; on: it boots
//   emcy SIDE CODE [REGISTER [FAULT_ID]]    the message only
//   fault SIDE CODE [REGISTER [FAULT_ID]]   with the state machine's fault
//   sdo-abort SIDE INDEX CODE    each transfer of that object is aborted; code 0: ends this
//   sdo-silent SIDE INDEX SWITCH requests are never answered
//   sdo-keep SIDE INDEX SWITCH   writes are answered, but nothing is written
//   object SIDE INDEX SUB VALUE  identity, mapping, type ...: as if built that way
//   mode-refused SIDE SWITCH     6061h does not change
//   lose-enable SIDE             leaves operation enabled
//   nmt SIDE operational|pre-operational|stopped
//   opposite SIDE SWITCH         turns against its command
//   blocked SIDE SWITCH          does not turn
//   frozen SIDE SWITCH           reports the same speed forever
//   controller-silent SWITCH     a motion controller neither sends nor receives
//   controller-deaf SWITCH       receives nothing
//   controller-frozen SWITCH     reports the same motion forever
//   controller-refuses SWITCH    does not follow
//   controller-bad-crc SWITCH    in everything it sends
//   controller-fault BITS        raises its own faults
//   controller-version NUMBER    the protocol version that it reports
//   controller-reboot            goes silent, then restarts
//   traction PERMILLE            share of the wheels' motion that moves the vehicle: 0, they spin
//   speed-offset SIDE RPM        of the reported motor speed
//   can-frame ID#HEX [PERIOD_S COUNT]    from a node that should not be there
//   bus-error bus-off|passive|warning    as the controller would report it
//   lidar SWITCH, ins SWITCH     off: silent; for the labels too: labels SWITCH, labels-foreign,
//                                -duplicate, -garbage, -loss ...
//   lidar-foreign SWITCH, ins-foreign SWITCH       from another address instead
//   lidar-duplicate SWITCH, ins-duplicate SWITCH   everything twice
//   lidar-garbage SWITCH, ins-garbage SWITCH       random bytes in addition
//   lidar-loss PERMILLE, ins-loss PERMILLE
//   lidar-delay MS, ins-delay MS                   later by this much
//   lidar-delay-growth MS, ins-delay-growth MS     and from now on this much more every second
//   lidar-reorder N, ins-reorder N                 N at a time, in a random order; 0: ends this
//   lidar-restart                its clock, frame count and init id restart; a Velodyne's clock
//                                restarts at 0
//   lidar-clock MS               its clock jumps ahead by this much; negative: back
//   lidar-blind FROM TO HOW      from one body direction anticlockwise to another [deg], ahead is
//                                0: lost (packets are lost), invalid (columns are marked invalid),
//                                dark (nothing comes back), covered (everything comes back from
//                                the window), or none: ends this. A Velodyne's columns cannot be
//                                marked: invalid acts as dark there
//   lidar-frozen SWITCH          each column repeats its data from the previous revolution
//   lidar-turned YAW PITCH ROLL  turns its mount, in degrees from its described orientation
//   lidar-rain PERMILLE          of its rays hit a drop 1 to 12 m away instead of what is behind
//                                it; in addition 3 in 100 returns are lost; 0: ends this
//   lidar-dust FROM TO RANGE_M PERMILLE    of its rays from one body direction anticlockwise to
//                                another [degree] hit dust, from 1.5 m to RANGE_M away; 0: ends
//                                this
//   labels-are CODE              every return gets this label; 0: ends this
//   labels-mistake CODE FOR      returns of one class are labelled as another; 0 0: ends this
//   ins-cut BYTES                datagrams of 1 .. BYTES bytes; 0: one per message
//   ins-mode MODE                InsStatus, 0 .. 3
//   ins-jump NORTH EAST          offsets its positions by this many metres, from now on
//   ins-drift NORTH EAST         and by this many more metres per second; 0 0: stops growing
//   box X Y SIZE HEIGHT          appears in the world
//   box-ahead AHEAD LEFT SIZE HEIGHT    the same, in metres from the vehicle's position at the time
//   world NAME [SEED]            replaces the world (tools/sim/world/named_worlds.h)
//   quit                         ends the simulation

namespace hardpack::sim {

// Appends the event of a line, if it has one. kInvalidArgument: not a valid event; the message says
// why.
ReadOutcome ParseScriptLine(std::string_view line, std::vector<ScriptEvent>& script);

// Parses every line; messages begin with name:line.
ReadOutcome ParseScript(std::string_view text, std::string_view name,
                        std::vector<ScriptEvent>& script);

}  // namespace hardpack::sim
