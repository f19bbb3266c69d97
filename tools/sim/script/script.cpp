// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/script/script.h"

#include <functional>
#include <map>
#include <optional>
#include <sstream>

#include "tools/sim/script/script_controller.h"
#include "tools/sim/script/script_lidar.h"
#include "tools/sim/script/script_words.h"
#include "tools/sim/world/features.h"
#include "tools/sim/world/named_worlds.h"

namespace hardpack::sim {
namespace {

using script::Bounded;
using script::Command;
using script::Integer;
using script::MaybeAction;
using script::Real;
using script::Switch;
using script::Words;

std::optional<std::vector<Side>> Sides(const std::string& word) {
  if (word == "left") return std::vector{Side::kLeft};
  if (word == "right") return std::vector{Side::kRight};
  if (word == "both") return std::vector{Side::kLeft, Side::kRight};
  return std::nullopt;
}

// The drives selected by the first word of a command, a side.
using DriveAction = std::function<void(SevconDrive&)>;
MaybeAction OnDrives(const Words& words, DriveAction act) {
  const auto sides = Sides(words[0]);
  if (!sides) return std::nullopt;
  return [sides = *sides, act = std::move(act)](ScriptedVehicle& scripted) {
    for (const Side side : sides) act(scripted.vehicle().drive(side));
  };
}

// SIDE SWITCH, of one member of DriveFaults.
MaybeAction SetFault(const Words& words, bool DriveFaults::*member, bool when_on) {
  const auto on = Switch(words[1]);
  if (!on) return std::nullopt;
  const bool value = *on == when_on;
  return OnDrives(words, [member, value](SevconDrive& drive) { drive.faults().*member = value; });
}

MaybeAction Reboot(const Words& words) {
  const bool quiet = words.size() == 2;
  if (quiet && words[1] != "quiet") return std::nullopt;
  return OnDrives(words, [quiet](SevconDrive& drive) { drive.Reboot(!quiet); });
}

MaybeAction Key(const Words& words) {
  const auto on = Switch(words[1]);
  if (!on) return std::nullopt;
  return OnDrives(words, [on = *on](SevconDrive& drive) { drive.SetKey(on); });
}

MaybeAction EmergencyOrFault(const Words& words, bool fault) {
  const auto code = Bounded<uint16_t>(words[1]);
  const auto error_register = Bounded<uint8_t>(words.size() > 2 ? words[2] : "1");
  const auto fault_id = Bounded<uint16_t>(words.size() > 3 ? words[3] : "0");
  if (!code || !error_register || !fault_id) return std::nullopt;
  const Emergency emergency = {*code, *error_register, *fault_id};
  return OnDrives(words, [emergency, fault](SevconDrive& drive) {
    fault ? drive.RaiseFault(emergency) : drive.SendEmergency(emergency);
  });
}

MaybeAction SdoAbort(const Words& words) {
  const auto index = Bounded<uint16_t>(words[1]);
  const auto code = Bounded<uint32_t>(words[2]);
  if (!index || !code) return std::nullopt;
  return OnDrives(words, [index = *index, code = *code](SevconDrive& drive) {
    drive.faults().sdo_aborts.erase(index);
    if (code != 0) drive.faults().sdo_aborts[index] = code;
  });
}

MaybeAction SdoSet(const Words& words, std::set<uint16_t> DriveFaults::*member) {
  const auto index = Bounded<uint16_t>(words[1]);
  const auto on = Switch(words[2]);
  if (!index || !on) return std::nullopt;
  return OnDrives(words, [index = *index, on = *on, member](SevconDrive& drive) {
    std::set<uint16_t>& indices = drive.faults().*member;
    indices.erase(index);
    if (on) indices.insert(index);
  });
}

MaybeAction Object(const Words& words) {
  const auto index = Bounded<uint16_t>(words[1]);
  const auto sub_index = Bounded<uint8_t>(words[2]);
  const auto value = Integer(words[3]);
  if (!index || !sub_index || !value) return std::nullopt;
  return OnDrives(words, [index = *index, sub = *sub_index, value = *value](SevconDrive& drive) {
    drive.SetObject(index, sub, value);
  });
}

MaybeAction Nmt(const Words& words) {
  for (const NmtState state :
       {NmtState::kOperational, NmtState::kPreOperational, NmtState::kStopped}) {
    if (words[1] != Name(state)) continue;
    return OnDrives(words, [state](SevconDrive& drive) { drive.EnterNmtState(state); });
  }
  return std::nullopt;
}

MaybeAction SpeedOffset(const Words& words) {
  const auto rpm = Integer(words[1]);
  if (!rpm || std::abs(*rpm) > 20'000) return std::nullopt;
  return OnDrives(words, [rpm = static_cast<int32_t>(*rpm)](SevconDrive& drive) {
    drive.faults().speed_offset_rpm = rpm;
  });
}

std::optional<CanFrame> Frame(const std::string& word) {
  const size_t hash = word.find('#');
  if (hash == std::string::npos) return std::nullopt;
  const auto id = Bounded<uint32_t>("0x" + word.substr(0, hash));
  const std::string data = word.substr(hash + 1);
  if (!id || *id > kMaxExtendedCanId || data.size() % 2 != 0) return std::nullopt;
  if (data.size() > 2 * kMaxCanData_bytes) return std::nullopt;
  CanFrame frame;
  frame.id = *id;
  frame.extended = *id > kMaxStandardCanId;
  for (size_t i = 0; i < data.size(); i += 2) {
    const auto byte = Bounded<uint8_t>("0x" + data.substr(i, 2));
    if (!byte) return std::nullopt;
    frame.data[frame.size++] = *byte;
  }
  return frame;
}

MaybeAction ForeignFrame(const Words& words) {
  const auto frame = Frame(words[0]);
  const auto period_s = Real(words.size() == 3 ? words[1] : "1");
  const auto count = Bounded<uint16_t>(words.size() == 3 ? words[2] : "1");
  if (words.size() == 2 || !frame || !period_s || *period_s <= 0.0 || !count) return std::nullopt;
  return [frame = *frame, period_s = *period_s, count = *count](ScriptedVehicle& scripted) {
    scripted.SendForeignFrame(frame, period_s, count);
  };
}

// linux/can/error.h: CAN_ERR_BUSOFF; CAN_ERR_CRTL with the transmitter's passive and warning bits.
MaybeAction ReportBusError(const Words& words) {
  static const std::map<std::string, BusError> kErrors = {
      {"bus-off", {0x40, 0}}, {"passive", {0x04, 0x20}}, {"warning", {0x04, 0x08}}};
  const auto found = kErrors.find(words[0]);
  if (found == kErrors.end()) return std::nullopt;
  return [error = found->second](ScriptedVehicle& scripted) { scripted.SendBusError(error); };
}

MaybeAction SetSensor(const Words& words, Sensor sensor, bool SensorFaults::*member,
                      bool when_on = true) {
  const auto on = Switch(words[0]);
  if (!on) return std::nullopt;
  return [=, value = *on == when_on](ScriptedVehicle& scripted) {
    scripted.faults(sensor).*member = value;
  };
}

MaybeAction Loss(const Words& words, Sensor sensor) {
  const auto permille = Bounded<uint16_t>(words[0]);
  if (!permille || *permille > 1000) return std::nullopt;
  return [sensor, permille = *permille](ScriptedVehicle& scripted) {
    scripted.faults(sensor).loss_permille = permille;
  };
}

MaybeAction Delay(const Words& words, Sensor sensor) {
  const auto delay_ms = Bounded<uint16_t>(words[0]);
  if (!delay_ms) return std::nullopt;
  return [sensor, delay_s = 0.001 * *delay_ms](ScriptedVehicle& scripted) {
    scripted.faults(sensor).delay_s = delay_s;
  };
}

MaybeAction DelayGrowth(const Words& words, Sensor sensor) {
  const auto growth_ms = Bounded<uint16_t>(words[0]);
  if (!growth_ms) return std::nullopt;
  return [sensor, growth = 0.001 * *growth_ms](ScriptedVehicle& scripted) {
    scripted.faults(sensor).delay_growth = growth;
  };
}

MaybeAction Traction(const Words& words) {
  const auto permille = Bounded<uint16_t>(words[0]);
  if (!permille || *permille > 1000) return std::nullopt;
  return [share = 0.001 * *permille](ScriptedVehicle& scripted) {
    scripted.vehicle().SetTraction(share);
  };
}

MaybeAction Reorder(const Words& words, Sensor sensor) {
  const auto count = Bounded<uint8_t>(words[0]);
  if (!count) return std::nullopt;
  return [sensor, count = *count](ScriptedVehicle& scripted) {
    scripted.faults(sensor).reordered = count;
  };
}

MaybeAction LabelsAre(const Words& words) {
  const auto code = Bounded<uint8_t>(words[0]);
  if (!code) return std::nullopt;
  return [code = *code](ScriptedVehicle& scripted) {
    if (scripted.labels()) scripted.labels()->settings().all_are = code;
  };
}

MaybeAction LabelsMistake(const Words& words) {
  const auto code = Bounded<uint8_t>(words[0]);
  const auto said = Bounded<uint8_t>(words[1]);
  if (!code || !said) return std::nullopt;
  return [code = *code, said = *said](ScriptedVehicle& scripted) {
    if (!scripted.labels()) return;
    scripted.labels()->settings().mistaken = code;
    scripted.labels()->settings().mistaken_for = said;
  };
}

MaybeAction InsCut(const Words& words) {
  const auto bytes = Bounded<uint16_t>(words[0]);
  if (!bytes) return std::nullopt;
  return
      [bytes = *bytes](ScriptedVehicle& scripted) { scripted.ins().settings().cut_bytes = bytes; };
}

MaybeAction InsMode(const Words& words) {
  const auto mode = Bounded<uint8_t>(words[0]);
  if (!mode || *mode > 3) return std::nullopt;
  return [mode = *mode](ScriptedVehicle& scripted) { scripted.ins().settings().mode = mode; };
}

MaybeAction AddBox(const Words& words) {
  const auto x_m = Real(words[0]);
  const auto y_m = Real(words[1]);
  const auto size_m = Real(words[2]);
  const auto height_m = Real(words[3]);
  if (!x_m || !y_m || !size_m || !height_m || *size_m <= 0.0) return std::nullopt;
  return [=](ScriptedVehicle& scripted) {
    world::AddBoxOnGround(scripted.world(), {*x_m, *y_m}, 0.0, *size_m, *size_m, *height_m,
                          world::kThing);
  };
}

MaybeAction AddBoxAhead(const Words& words) {
  const auto ahead_m = Real(words[0]);
  const auto left_m = Real(words[1]);
  const auto size_m = Real(words[2]);
  const auto height_m = Real(words[3]);
  if (!ahead_m || !left_m || !size_m || !height_m || *size_m <= 0.0) return std::nullopt;
  return [=](ScriptedVehicle& scripted) {
    const Pose& pose = scripted.vehicle().pose();
    const world::Turn heading = world::TurnOf(pose.theta_rad);
    const world::Point2 place = {pose.x_m + heading.cos * *ahead_m - heading.sin * *left_m,
                                 pose.y_m + heading.sin * *ahead_m + heading.cos * *left_m};
    world::AddBoxOnGround(scripted.world(), place, pose.theta_rad, *size_m, *size_m, *height_m,
                          world::kThing);
  };
}

MaybeAction SelectWorld(const Words& words) {
  const auto seed = Bounded<uint32_t>(words.size() > 1 ? words[1] : "1");
  world::Scenario scenario;
  if (!seed || !world::MakeScenario(words[0], *seed, scenario).ok()) return std::nullopt;
  return [scenario](ScriptedVehicle& scripted) { scripted.world() = scenario.world; };
}

// NORTH EAST, of two members of InsErrors.
MaybeAction ShiftIns(const Words& words, double InsErrors::*north, double InsErrors::*east) {
  const auto to_north = Real(words[0]);
  const auto to_east = Real(words[1]);
  if (!to_north || !to_east) return std::nullopt;
  return [=](ScriptedVehicle& scripted) {
    scripted.ins().settings().errors.*north = *to_north;
    scripted.ins().settings().errors.*east = *to_east;
  };
}

void AddDriveCommands(std::map<std::string, Command>& commands) {
  const auto fault = [](bool DriveFaults::*member, bool when_on = true) {
    return Command{2, 2, [=](const Words& words) { return SetFault(words, member, when_on); }};
  };
  commands["drive-silent"] = fault(&DriveFaults::silent);
  commands["heartbeat"] = fault(&DriveFaults::no_heartbeat, false);
  commands["process-data"] = fault(&DriveFaults::no_process_data, false);
  commands["mode-refused"] = fault(&DriveFaults::mode_refused);
  commands["opposite"] = fault(&DriveFaults::opposite);
  commands["blocked"] = fault(&DriveFaults::blocked);
  commands["frozen"] = fault(&DriveFaults::frozen);
  commands["reboot"] = {1, 2, Reboot};
  commands["key"] = {2, 2, Key};
  commands["emcy"] = {2, 4, [](const Words& words) { return EmergencyOrFault(words, false); }};
  commands["fault"] = {2, 4, [](const Words& words) { return EmergencyOrFault(words, true); }};
  commands["sdo-abort"] = {3, 3, SdoAbort};
  commands["sdo-silent"] = {
      3, 3, [](const Words& words) { return SdoSet(words, &DriveFaults::sdo_silent); }};
  commands["sdo-keep"] = {3, 3,
                          [](const Words& words) { return SdoSet(words, &DriveFaults::sdo_kept); }};
  commands["object"] = {4, 4, Object};
  commands["lose-enable"] = {1, 1, [](const Words& words) {
                               return OnDrives(words,
                                               [](SevconDrive& drive) { drive.LoseEnable(); });
                             }};
  commands["nmt"] = {2, 2, Nmt};
  commands["traction"] = {1, 1, Traction};
  commands["speed-offset"] = {2, 2, SpeedOffset};
}

void AddSensorCommands(std::map<std::string, Command>& commands) {
  for (const auto& [name, sensor] : {std::pair{std::string("lidar"), Sensor::kLidar},
                                     std::pair{std::string("ins"), Sensor::kIns},
                                     std::pair{std::string("labels"), Sensor::kLabels}}) {
    const auto fault = [sensor = sensor](bool SensorFaults::*member, bool when_on = true) {
      return Command{1, 1,
                     [=](const Words& words) { return SetSensor(words, sensor, member, when_on); }};
    };
    commands[name] = fault(&SensorFaults::silent, false);
    commands[name + "-foreign"] = fault(&SensorFaults::foreign);
    commands[name + "-duplicate"] = fault(&SensorFaults::duplicated);
    commands[name + "-garbage"] = fault(&SensorFaults::garbage);
    commands[name + "-loss"] = {
        1, 1, [sensor = sensor](const Words& words) { return Loss(words, sensor); }};
    commands[name + "-delay"] = {
        1, 1, [sensor = sensor](const Words& words) { return Delay(words, sensor); }};
    commands[name + "-delay-growth"] = {
        1, 1, [sensor = sensor](const Words& words) { return DelayGrowth(words, sensor); }};
    commands[name + "-reorder"] = {
        1, 1, [sensor = sensor](const Words& words) { return Reorder(words, sensor); }};
  }
  commands["labels-are"] = {1, 1, LabelsAre};
  commands["labels-mistake"] = {2, 2, LabelsMistake};
  commands["ins-cut"] = {1, 1, InsCut};
  commands["ins-mode"] = {1, 1, InsMode};
  commands["ins-jump"] = {2, 2, [](const Words& words) {
                            return ShiftIns(words, &InsErrors::jump_north_m,
                                            &InsErrors::jump_east_m);
                          }};
  commands["ins-drift"] = {2, 2, [](const Words& words) {
                             return ShiftIns(words, &InsErrors::drift_north_mps,
                                             &InsErrors::drift_east_mps);
                           }};
}

const std::map<std::string, Command>& Commands() {
  static const auto commands = [] {
    std::map<std::string, Command> made;
    AddDriveCommands(made);
    AddSensorCommands(made);
    script::AddLidarCommands(made);
    script::AddControllerCommands(made);
    made["can-frame"] = {1, 3, ForeignFrame};
    made["bus-error"] = {1, 1, ReportBusError};
    made["box"] = {4, 4, AddBox};
    made["box-ahead"] = {4, 4, AddBoxAhead};
    made["world"] = {1, 2, SelectWorld};
    made["quit"] = {0, 0, [](const Words&) -> MaybeAction {
                      return [](ScriptedVehicle& scripted) { scripted.Quit(); };
                    }};
    return made;
  }();
  return commands;
}

ReadOutcome Refuse(const std::string& message) {
  return {Status::kInvalidArgument, message};
}

}  // namespace

ReadOutcome ParseScriptLine(std::string_view line, std::vector<ScriptEvent>& script) {
  std::istringstream in{std::string(line)};
  Words words;
  // A # within a word belongs to a CAN frame.
  for (std::string word; in >> word && !word.starts_with("#");) words.push_back(word);
  if (words.empty()) return {};
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  const auto at_s = words.size() < 3 || words[0] != "at" ? std::nullopt : Real(words[1]);
  if (!at_s || *at_s < 0.0) return Refuse(text + ": expected: at SECONDS COMMAND ...");
  const auto command = Commands().find(words[2]);
  if (command == Commands().end()) return Refuse(text + ": no such command");
  words.erase(words.begin(), words.begin() + 3);
  const Command& known = command->second;
  const bool fits = words.size() >= known.least_words && words.size() <= known.most_words;
  MaybeAction act = fits ? known.parse(words) : std::nullopt;
  if (!act) return Refuse(text + ": wrong arguments");
  script.push_back({*at_s, text, std::move(*act)});
  return {};
}

ReadOutcome ParseScript(std::string_view text, std::string_view name,
                        std::vector<ScriptEvent>& script) {
  std::istringstream in{std::string(text)};
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    const ReadOutcome outcome = ParseScriptLine(line, script);
    if (!outcome.ok()) {
      return Refuse(std::string(name) + ":" + std::to_string(number) + ": " + outcome.message);
    }
  }
  return {};
}

}  // namespace hardpack::sim
