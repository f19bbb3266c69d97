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
       "IPv4 address that " + what +
           " sends from; datagrams from other senders are dropped and counted."},
      {group + ".port", &source.port, lowest_port, 65535,
       "UDP port on this computer that it sends to."},
      {group + ".bind_address", &source.bind_address, 0, 0,
       "Address of this computer that it sends to; empty: any."},
      {group + ".receive_buffer_bytes", &source.receive_buffer_bytes, 4096, 268435456,
       "Receive buffer of the socket, requested from the kernel: at least half a second of "
       "datagrams."},
      {group + ".require_receive_buffer", &source.require_receive_buffer, 0, 0,
       "true: the program does not start if the kernel grants less (net.core.rmem_max)."}};
  keys.insert(keys.end(), rows.begin(), rows.end());
}

void AddDevices(Configuration& c, Keys& keys) {
  AddSource("lidar", "the lidar", 1, c.lidar, keys);
  keys.push_back({"lidar.metadata", &c.lidar.metadata, 1, kMaxText,
                  "Path of the lidar's metadata, the JSON file that it serves."});
  const Keys velodyne = {
      {"velodyne.model", &c.velodyne.model, 1, 8,
       "Model of the vehicle's Velodyne, if it has one: vlp16 (also for Puck LITE) or vlp32c."},
      {"velodyne.returns", &c.velodyne.returns, 1, 16, "Its return mode: strongest, last or dual."},
      {"velodyne.rpm", &c.velodyne.rpm, velodyne::kLeastRpm, velodyne::kMostRpm,
       "Its motor speed, a multiple of 60."}};
  keys.insert(keys.end(), velodyne.begin(), velodyne.end());
  AddSource("ins", "the inertial navigation system", 0, c.ins, keys);
  AddSource("labels", "the segmentation computer", 1, c.label_source, keys);
  const Keys rows = {
      {"can.interface", &c.can.interface, 1, 15, "Network interface of the drives' CAN bus."},
      {"can.restart", &c.can.restart, 0, 0,
       "true: the program may take the interface down and up again, for example after bus-off; "
       "this needs CAP_NET_ADMIN."},
      {"can.frame_max_age_ms", &c.can.frame_max_age_ms, 1, 1000,
       "A frame that could not be sent for this long is dropped: a late command is worse than "
       "none."}};
  keys.insert(keys.end(), rows.begin(), rows.end());
}

void AddVehicleType(Configuration& c, Keys& keys) {
  std::string known;
  for (const std::string_view type : VehicleTypes()) known.append(" ").append(type);
  keys.push_back({"vehicle.type", &c.vehicle_type, 1, kMaxVehicleType,
                  "Vehicle to drive, one of those built into the program:" + known + "."});
}

void AddProgram(Configuration& c, Keys& keys) {
  const Keys rows = {
      {"log.enabled", &c.log.enabled, 0, 0, "true: write a flight log."},
      {"log.directory", &c.log.directory, 1, kMaxText, "Directory of its files."},
      {"log.file_size_mb", &c.log.file_size_mb, 1, 4000,
       "When a file reaches this size (in units of 1e6 bytes), the next one is started.",
       "log.max_total_mb"},
      {"log.max_total_mb", &c.log.max_total_mb, 1, 16000000,
       "When all files together exceed this size, the oldest are deleted."},
      {"log.min_free_mb", &c.log.min_free_mb, 0, 16000000,
       "Space to leave free on the medium: the oldest files are deleted for it."},
      {"log.buffer_mb", &c.log.buffer_mb, 1, 1000,
       "Memory that buffers the log while the medium is busy; records that do not fit are dropped "
       "and counted."},
      {"control.socket", &c.control.socket, 1, 107, "Path of the operator's control socket."},
      {"control.group", &c.control.group, 0, 32,
       "Group whose members may command, in addition to the program's user; empty: none."},
      {"process.realtime_priority", &c.process.realtime_priority, 0, 99,
       "SCHED_FIFO priority of the tick's thread; 0: none requested."},
      {"process.lock_memory", &c.process.lock_memory, 0, 0,
       "true: lock the memory, so that it is not swapped out."},
      {"process.cpu", &c.process.cpu, -1, 1023, "CPU of the tick's thread; -1: any."},
      {"process.abort_on_allocation", &c.process.abort_on_allocation, 0, 0,
       "true: an allocation after the start aborts the program (for tests); false: it is "
       "counted."}};
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
bool WithLabels(const Configuration& c) {
  return c.perception.mapping.use_labels != 0;
}
bool WithIns(const Configuration& c) {
  return c.onboard.safety.needs_ins != 0 || c.ins.address.value != 0;
}

constexpr std::array kRequired = {
    RequiredKey{"drive.gear_ratio", WithSevcon, "the Warthog's is not public: measure it"},
    RequiredKey{"drive.left_sign", WithSevcon,
                "1 or -1: the motor's mounting is not public: try it with the wheels up"},
    RequiredKey{"drive.right_sign", WithSevcon,
                "1 or -1: the motor's mounting is not public: try it with the wheels up"},
    RequiredKey{"lidar.address", Always, "the address that your lidar sends from"},
    RequiredKey{"lidar.metadata", WithOuster, "the file with your lidar's beam angles"},
    RequiredKey{"ins.address", WithIns,
                "the address that your INS sends from; without an INS set safety.needs_ins = 0"},
    RequiredKey{"ins.port", WithIns,
                "the port that your INS sends to; without an INS set safety.needs_ins = 0"},
    RequiredKey{"labels.address", WithLabels,
                "the address that labels come from; mapping.use_labels = 1 needs it"},
};

struct Unit {
  std::string_view suffix;
  std::string_view text;
};
// A longer suffix comes before the shorter ones that it ends in.
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
  // [ins] has keys of this port and parameters, but a file may open a table only once.
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
  // A file is read as double first. If that double does not round to the same float, write all of
  // the double's digits.
  double read = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), read);
  if (static_cast<float>(read) != value) text = Shortest(static_cast<double>(value));
  // Without a point or an exponent it would be a whole number, which has no -0.
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
