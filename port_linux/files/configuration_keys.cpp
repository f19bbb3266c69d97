// SPDX-License-Identifier: Apache-2.0
#include "port_linux/files/configuration_keys.h"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>

#include "core/base/validate.h"
#include "hal/onboard/vehicle_loop/vehicles.h"
#include "port_linux/files/vehicle_types.h"

namespace hardpack {
namespace {

using Keys = std::vector<ConfigurationKey>;

// The parameters of the tables of config/.
template <typename Params>
void AddParameters(Params& params, Keys& keys) {
  VisitParameters(params, [&keys](auto& group, const auto& table) {
    for (const auto& entry : table) {
      ConfigurationKey key{entry.full_name, {}, entry.low, entry.high, entry.description};
      key.is_parameter = true;
      if (entry.number != nullptr) key.value = &(group.*entry.number);
      if (entry.whole != nullptr) key.value = &(group.*entry.whole);
      if (entry.rule != nullptr) key.value = &(group.*entry.rule);
      for (const auto& other : table) {
        if (entry.not_above != nullptr && other.number == entry.not_above) {
          key.not_above = other.full_name;
        }
      }
      keys.push_back(std::move(key));
    }
  });
}

void AddSource(const std::string& group, const std::string& what, float lowest_port,
               DatagramSource& source, Keys& keys) {
  const Keys rows = {
      {group + ".address", &source.address, 0, 0,
       "IPv4 address that " + what + " sends from; what others send is dropped and counted."},
      {group + ".port", &source.port, lowest_port, 65535,
       "UDP port of this computer that it sends to."},
      {group + ".bind_address", &source.bind_address, 0, 0,
       "Address of this computer that it sends to; empty: every one."},
      {group + ".receive_buffer_bytes", &source.receive_buffer_bytes, 4096, 268435456,
       "Of the socket, asked of the kernel: half a second of datagrams, at least."},
      {group + ".require_receive_buffer", &source.require_receive_buffer, 0, 0,
       "true: the program does not start when the kernel grants less (net.core.rmem_max)."}};
  keys.insert(keys.end(), rows.begin(), rows.end());
}

void AddDevices(Configuration& c, Keys& keys) {
  AddSource("lidar", "the lidar", 1, c.lidar, keys);
  keys.push_back({"lidar.metadata", &c.lidar.metadata, 1, kMaxText,
                  "Path of the lidar's own description, the JSON that it serves."});
  const Keys velodyne = {
      {"velodyne.model", &c.velodyne.model, 1, 8,
       "Of the vehicle's Velodyne, if it has one: vlp16 (Puck LITE too) or vlp32c."},
      {"velodyne.returns", &c.velodyne.returns, 1, 16, "Its return mode: strongest, last or dual."},
      {"velodyne.rpm", &c.velodyne.rpm, velodyne::kLeastRpm, velodyne::kMostRpm,
       "Its motor's speed, a multiple of 60."}};
  keys.insert(keys.end(), velodyne.begin(), velodyne.end());
  AddSource("ins", "the inertial navigation system", 0, c.ins, keys);
  AddSource("labels", "the segmentation computer", 1, c.label_source, keys);
  const Keys rows = {
      {"can.interface", &c.can.interface, 1, 15, "Network interface of the drives' bus."},
      {"can.restart", &c.can.restart, 0, 0,
       "true: the interface may be taken down and up again, after bus-off for one; that needs "
       "CAP_NET_ADMIN."},
      {"can.frame_max_age_ms", &c.can.frame_max_age_ms, 1, 1000,
       "A frame that the bus did not take for so long is dropped: a late command is worse than "
       "none."}};
  keys.insert(keys.end(), rows.begin(), rows.end());
}

void AddVehicleType(Configuration& c, Keys& keys) {
  std::string known;
  for (const std::string_view type : VehicleTypes()) known.append(" ").append(type);
  keys.push_back({"vehicle.type", &c.vehicle_type, 1, kMaxVehicleType,
                  "Which vehicle to drive, one of those that the program has:" + known + "."});
}

void AddProgram(Configuration& c, Keys& keys) {
  const Keys rows = {
      {"log.enabled", &c.log.enabled, 0, 0, "true: a flight log is written."},
      {"log.directory", &c.log.directory, 1, kMaxText, "Where its files go."},
      {"log.file_size_mb", &c.log.file_size_mb, 1, 4000,
       "A file that has reached this size (of 1e6 bytes) is followed by the next.",
       "log.max_total_mb"},
      {"log.max_total_mb", &c.log.max_total_mb, 1, 16000000,
       "Beyond this size of all files together the oldest are deleted."},
      {"log.min_free_mb", &c.log.min_free_mb, 0, 16000000,
       "So much of the medium is left to others: the oldest files are deleted for it."},
      {"log.buffer_mb", &c.log.buffer_mb, 1, 1000,
       "Memory that holds what is to be written while the medium is busy; what does not fit is "
       "counted."},
      {"control.socket", &c.control.socket, 1, 107,
       "Path of the socket over which the operator commands."},
      {"control.group", &c.control.group, 0, 32,
       "Group whose members may command besides the program's user; empty: nobody."},
      {"process.realtime_priority", &c.process.realtime_priority, 0, 99,
       "Of the tick's thread, SCHED_FIFO; 0: not asked for."},
      {"process.lock_memory", &c.process.lock_memory, 0, 0,
       "true: memory is kept from being swapped out."},
      {"process.cpu", &c.process.cpu, -1, 1023, "Processor of the tick's thread; -1: any."},
      {"process.abort_on_allocation", &c.process.abort_on_allocation, 0, 0,
       "true: an allocation after the start ends the program (for tests); false: it is counted."}};
  keys.insert(keys.end(), rows.begin(), rows.end());
}

bool Always(const Configuration&) {
  return true;
}
bool WithSevcon(const Configuration& c) {
  return DevicesOf(c.vehicle_type).sevcon;
}
bool WithOuster(const Configuration& c) {
  return DevicesOf(c.vehicle_type).ouster;
}
bool WhereLabelsAreUsed(const Configuration& c) {
  return c.perception.mapping.use_labels != 0;
}
bool WhereInsIsUsed(const Configuration& c) {
  return c.onboard.safety.needs_ins != 0 || c.ins.address.value != 0;
}

constexpr std::array kRequired = {
    RequiredKey{"drive.gear_ratio", WithSevcon, "the Warthog's is not public: measure it"},
    RequiredKey{"drive.left_sign", WithSevcon,
                "1 or -1: how the motor is mounted is not public: try it with the wheels up"},
    RequiredKey{"drive.right_sign", WithSevcon,
                "1 or -1: how the motor is mounted is not public: try it with the wheels up"},
    RequiredKey{"lidar.address", Always, "where your lidar sends from"},
    RequiredKey{"lidar.metadata", WithOuster, "the file with your lidar's beam angles"},
    RequiredKey{"ins.address", WhereInsIsUsed,
                "where your INS sends from; without one set safety.needs_ins = 0"},
    RequiredKey{"ins.port", WhereInsIsUsed,
                "where your INS sends to; without one set safety.needs_ins = 0"},
    RequiredKey{"labels.address", WhereLabelsAreUsed,
                "where labels come from, which mapping.use_labels = 1 asks for"},
};

struct Unit {
  std::string_view suffix;
  std::string_view text;
};
// A suffix before the shorter ones that it ends in.
constexpr std::array kUnits = {Unit{"_per_m2", "1/m^2"},
                               Unit{"_per_m", "1/m"},
                               Unit{"_per_s2", "1/s^2"},
                               Unit{"_per_s", "1/s"},
                               Unit{"_mps2", "m/s^2"},
                               Unit{"_mps", "m/s"},
                               Unit{"_radps", "rad/s"},
                               Unit{"_rad", "rad"},
                               Unit{"_m", "m"},
                               Unit{"_s", "s"},
                               Unit{"_ms", "ms"},
                               Unit{"_cells", "cells"},
                               Unit{"_rpmps", "rpm/s"},
                               Unit{"_rpm", "rpm"},
                               Unit{"_permille", "permille"},
                               Unit{"_percent", "percent"},
                               Unit{"_kbps", "kbit/s"},
                               Unit{"_mb", "MB"},
                               Unit{"_bytes", "bytes"}};

template <typename Number>
std::string Shortest(Number value) {
  std::array<char, 64> text;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} ? std::string(text.data(), end) : std::string("?");
}

// "3", not "3.0"; "2147483520", not "2.1474835e+09".
std::string LimitText(float value) {
  const int32_t whole = RoundToInt(value);
  return static_cast<float>(whole) == value ? Shortest(whole) : Shortest(value);
}

std::string Quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') quoted += '\\';
    quoted += letter;
  }
  return quoted + '"';
}

}  // namespace

std::vector<ConfigurationKey> KeysOf(Configuration& configuration) {
  Keys keys;
  AddDevices(configuration, keys);
  AddParameters(configuration.onboard, keys);
  AddParameters(configuration.perception, keys);
  AddVehicleType(configuration, keys);
  AddParameters(configuration.planner, keys);
  AddProgram(configuration, keys);
  // [ins] has keys of the port and parameters; a file may open a table only once.
  std::vector<std::string> groups;
  for (const ConfigurationKey& key : keys) groups.push_back(key.group());
  const auto first_of = [&groups](const ConfigurationKey& key) {
    return std::find(groups.begin(), groups.end(), key.group()) - groups.begin();
  };
  std::stable_sort(keys.begin(), keys.end(),
                   [&](const auto& a, const auto& b) { return first_of(a) < first_of(b); });
  return keys;
}

std::span<const RequiredKey> RequiredKeys() {
  return kRequired;
}

bool IsUnset(const ConfigurationKey& key) {
  if (const auto* whole = std::get_if<int32_t*>(&key.value)) return **whole == 0;
  if (const auto* text = std::get_if<std::string*>(&key.value)) return (*text)->empty();
  if (const auto* address = std::get_if<Ipv4Address*>(&key.value)) return (*address)->value == 0;
  return false;
}

std::string_view UnitOf(std::string_view name) {
  const auto unit = std::find_if(kUnits.begin(), kUnits.end(), [name](const Unit& candidate) {
    return name.ends_with(candidate.suffix);
  });
  return unit == kUnits.end() ? std::string_view() : unit->text;
}

std::string ExpectedOf(const ConfigurationKey& key) {
  const std::string range = LimitText(key.low) + " to " + LimitText(key.high);
  const std::string unit(UnitOf(key.full_name));
  const std::string with_unit = unit.empty() ? range : range + " " + unit;
  if (std::holds_alternative<float*>(key.value)) return "a number from " + with_unit;
  if (std::holds_alternative<bool*>(key.value)) return "true or false";
  if (std::holds_alternative<std::string*>(key.value)) {
    return "a text of " + range + " letters without control characters";
  }
  if (std::holds_alternative<Ipv4Address*>(key.value)) return "an IPv4 address like \"10.0.0.5\"";
  return key.low == 0.0f && key.high == 1.0f ? "0 or 1" : "a whole number from " + with_unit;
}

std::string NumberText(float value) {
  std::string text = Shortest(value);
  // A file is read as double first. Should that, rounded again, not be the same float, all the
  // double's digits are.
  double read = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), read);
  if (static_cast<float>(read) != value) text = Shortest(static_cast<double>(value));
  // Without either it would be a whole number, which has no -0.
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string ValueText(const ConfigurationKey& key) {
  if (const auto* number = std::get_if<float*>(&key.value)) return NumberText(**number);
  if (const auto* whole = std::get_if<int32_t*>(&key.value)) return Shortest(**whole);
  if (const auto* rule = std::get_if<ObstacleRule*>(&key.value)) {
    return Shortest(static_cast<int32_t>(**rule));
  }
  if (const auto* is_on = std::get_if<bool*>(&key.value)) return **is_on ? "true" : "false";
  if (const auto* text = std::get_if<std::string*>(&key.value)) return Quoted(**text);
  const Ipv4Address address = *std::get<Ipv4Address*>(key.value);
  return address.value == 0 ? "\"\"" : Quoted(ToText(address));
}

}  // namespace hardpack
