// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "config/onboard_parameters.h"
#include "config/parameters.h"
#include "core/areas/area.h"
#include "core/segmentation/label_table.h"
#include "hal/velodyne/velodyne.h"
#include "port_linux/files/read_outcome.h"

// The onboard program's configuration: one TOML file (config/warthog.toml is the example). A key is
// "[group] name = value". The keys, with type, range, default and description, are in the tables of
// config/ (used by the vehicle) and in port_linux/files/configuration_keys.cpp (used by this port
// only). docs/configuration.md is for those who write such a file.
//
// Nothing is guessed: an unknown key or table, a value of the wrong type, out of range, or with a
// fraction where an integer is expected, a missing key without a default, and inconsistent
// parameters are errors. All of them are reported at once, one per line.
//
// Allocates; for start-up only. Throws nothing.

namespace hardpack {

// "10.0.0.5" is 0x0a000005; 0 is "0.0.0.0": every local address, or none.
struct Ipv4Address {
  uint32_t value = 0;  // host byte order

  friend bool operator==(const Ipv4Address&, const Ipv4Address&) = default;
};

// "10.0.0.5"; empty text: none. False, with the address unchanged, if it is not such an address
// (numbers only, no names, no leading zeros).
bool ParseIpv4(std::string_view text, Ipv4Address& address);
std::string ToText(Ipv4Address address);

// The source of a sensor's datagrams.
struct DatagramSource {
  Ipv4Address address;       // of the sender: others' datagrams are dropped
  int32_t port = 0;          // ours, where they arrive
  Ipv4Address bind_address;  // ours; 0.0.0.0: every one
  int32_t receive_buffer_bytes = 0;
  bool require_receive_buffer = true;  // the program does not start if the kernel grants less

  friend bool operator==(const DatagramSource&, const DatagramSource&) = default;
};

struct LidarSource : DatagramSource {
  std::string metadata;  // path of the sensor's JSON

  friend bool operator==(const LidarSource&, const LidarSource&) = default;
};

struct CanConfiguration {
  std::string interface = "can0";
  bool restart = true;            // it may be taken down and up again, e.g. after bus-off
  int32_t frame_max_age_ms = 20;  // a frame that could not be sent for this long is dropped

  friend bool operator==(const CanConfiguration&, const CanConfiguration&) = default;
};

// How a Velodyne is set up.
struct VelodyneConfiguration {
  std::string model = "vlp16";        // or "vlp32c"
  std::string returns = "strongest";  // or "last", "dual"
  int32_t rpm = 600;                  // a multiple of 60

  friend bool operator==(const VelodyneConfiguration&, const VelodyneConfiguration&) = default;
};
// The same for hal/velodyne. kInvalidArgument: a model or a kind of returns that is unknown.
Status ToConfig(const VelodyneConfiguration& configuration, velodyne::Config& config);

struct LogConfiguration {
  bool enabled = true;
  std::string directory = "/var/log/hardpack";
  int32_t file_size_mb = 256;    // a file that reaches it is followed by the next
  int32_t max_total_mb = 20000;  // the oldest files are deleted beyond this total
  int32_t min_free_mb = 1000;    // of the disk, left free
  int32_t buffer_mb = 64;        // of memory, while the disk is busy

  friend bool operator==(const LogConfiguration&, const LogConfiguration&) = default;
};

struct ControlConfiguration {
  std::string socket = "/run/hardpack/control.sock";
  std::string group;  // may command in addition to the owner; empty: none

  friend bool operator==(const ControlConfiguration&, const ControlConfiguration&) = default;
};

struct ProcessConfiguration {
  int32_t realtime_priority = 50;  // SCHED_FIFO; 0: not requested
  bool lock_memory = true;
  int32_t cpu = -1;                  // the tick's; -1: any
  bool abort_on_allocation = false;  // from the first tick on; otherwise it is counted

  friend bool operator==(const ProcessConfiguration&, const ProcessConfiguration&) = default;
};

struct Configuration {
  std::string vehicle_type = "warthog";  // vehicle.type, one of VehicleTypes()
  PlannerParams planner;
  PerceptionParams perception;
  OnboardParams onboard;
  LabelTable labels = RellisLabelTable();  // [labels.classes]
  AreaList areas;                          // [[area]], in the order of the file

  LidarSource lidar = {{{}, 7502, {}, 4194304, true}, {}};
  DatagramSource ins = {{}, 0, {}, 131072, true};
  DatagramSource label_source = {{}, 7510, {}, 1048576, true};  // [labels]
  VelodyneConfiguration velodyne;
  CanConfiguration can;
  LogConfiguration log;
  ControlConfiguration control;
  ProcessConfiguration process;
};

// Far larger than any configuration; larger files are refused unread.
inline constexpr size_t kMaxConfigurationBytes = 256 * 1024;

// Parses the text of a file; `name` is its name in messages, usually its path. On failure
// `configuration` is unchanged and the message has one line for each problem, at most
// kMaxConfigurationProblems, "warthog.toml:12: costmap.halo_m: ...", and the status is that of the
// first: kInvalidArgument (not TOML, unknown, wrong type, missing, duplicate, inconsistent),
// kNotFinite, kParameterOutOfRange, kOversized.
inline constexpr int kMaxConfigurationProblems = 40;
ReadOutcome ParseConfiguration(std::string_view toml, std::string_view name,
                               Configuration& configuration);

// Reads and parses a file. Also kInvalidArgument if it cannot be read.
ReadOutcome ReadConfiguration(const std::string& path, Configuration& configuration);

// A file that sets every key to its value in `configuration`, so that parsing it gives exactly the
// same again, whatever the defaults of the parsing version. kHidden: without the drives' password,
// which is then 0 with kHiddenSecret after it if there is one.
enum class Secrets : uint8_t { kShown, kHidden };
inline constexpr std::string_view kHiddenSecret = "# not shown";
std::string ToToml(const Configuration& configuration, Secrets secrets = Secrets::kShown);

}  // namespace hardpack
