// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "config/onboard_parameters.h"
#include "config/parameters.h"
#include "core/segmentation/label_table.h"
#include "port_linux/files/read_outcome.h"

// The onboard program's configuration: one TOML file (config/warthog.toml is the example). A key is
// "[group] name = value"; what keys there are, with type, range, default and description, is in the
// tables of config/ (what the vehicle computes with) and in port_linux/files/configuration_keys.cpp
// (what only this port needs). docs/configuration.md is for those who write such a file.
//
// Nothing is guessed: an unknown key or table, a value of another type, out of its range, or with a
// fraction where whole things are counted, a key without a default that is not set, and parameters
// that do not go together are errors. All of them are told at once, one a line.
//
// Allocates; for start-up only. No exception leaves it.

namespace hardpack {

// "10.0.0.5" is 0x0a000005; 0 is "0.0.0.0": every local address, or none.
struct Ipv4Address {
  uint32_t value = 0;  // host byte order

  friend bool operator==(const Ipv4Address&, const Ipv4Address&) = default;
};

// "10.0.0.5"; empty text: none. False, and the address untouched, when it is no such address
// (numbers only, no names, no leading zeros).
bool ParseIpv4(std::string_view text, Ipv4Address& address);
std::string ToText(Ipv4Address address);

// Where a sensor's datagrams come in.
struct DatagramSource {
  Ipv4Address address;       // of the sender: no other's datagrams are taken
  int32_t port = 0;          // ours, where they arrive
  Ipv4Address bind_address;  // ours; 0.0.0.0: every one
  int32_t receive_buffer_bytes = 0;
  bool require_receive_buffer = true;  // the program does not start when the kernel grants less

  friend bool operator==(const DatagramSource&, const DatagramSource&) = default;
};

struct LidarSource : DatagramSource {
  std::string metadata;  // path of the sensor's JSON

  friend bool operator==(const LidarSource&, const LidarSource&) = default;
};

struct CanConfiguration {
  std::string interface = "can0";
  bool restart = true;            // it may be taken down and up again, after bus-off for one
  int32_t frame_max_age_ms = 20;  // a frame that could not be sent for so long is dropped

  friend bool operator==(const CanConfiguration&, const CanConfiguration&) = default;
};

struct LogConfiguration {
  bool enabled = true;
  std::string directory = "/var/log/hardpack";
  int32_t file_size_mb = 256;    // a file that reaches it is followed by the next
  int32_t max_total_mb = 20000;  // the oldest files go when all together are larger
  int32_t min_free_mb = 1000;    // of the medium, left to others
  int32_t buffer_mb = 64;        // of memory, while the medium is busy

  friend bool operator==(const LogConfiguration&, const LogConfiguration&) = default;
};

struct ControlConfiguration {
  std::string socket = "/run/hardpack/control.sock";
  std::string group;  // that may command besides the owner; empty: none

  friend bool operator==(const ControlConfiguration&, const ControlConfiguration&) = default;
};

struct ProcessConfiguration {
  int32_t realtime_priority = 50;  // SCHED_FIFO; 0: not asked for
  bool lock_memory = true;
  int32_t cpu = -1;                  // the tick's; -1: any
  bool abort_on_allocation = false;  // from the first tick on; else it is counted

  friend bool operator==(const ProcessConfiguration&, const ProcessConfiguration&) = default;
};

struct Configuration {
  std::string vehicle_type = "warthog";  // vehicle.type, one of VehicleTypes()
  PlannerParams planner;
  PerceptionParams perception;
  OnboardParams onboard;
  LabelTable labels = RellisLabelTable();  // [labels.classes]

  LidarSource lidar = {{{}, 7502, {}, 4194304, true}, {}};
  DatagramSource ins = {{}, 0, {}, 131072, true};
  DatagramSource label_source = {{}, 7510, {}, 1048576, true};  // [labels]
  CanConfiguration can;
  LogConfiguration log;
  ControlConfiguration control;
  ProcessConfiguration process;
};

// Far more than any configuration; a larger file is refused unread.
inline constexpr size_t kMaxConfigurationBytes = 256 * 1024;

// Reads the text of a file; `name` is what messages call it, as a rule its path. On failure
// `configuration` is untouched and the message has one line for each problem, at most
// kMaxConfigurationProblems, "warthog.toml:12: costmap.halo_m: ...", and the status is the first
// one's: kInvalidArgument (no TOML, unknown, of another type, missing, twice, not going together),
// kNotFinite, kParameterOutOfRange, kOversized.
inline constexpr int kMaxConfigurationProblems = 40;
ReadOutcome ParseConfiguration(std::string_view toml, std::string_view name,
                               Configuration& configuration);

// Reads and parses a file. Besides: kInvalidArgument when it cannot be read.
ReadOutcome ReadConfiguration(const std::string& path, Configuration& configuration);

// A file that sets every key to its value in `configuration`, so that parsing it gives the same
// again, exactly, whatever the defaults of the version that parses it.
// kHidden: but for the drives' password, which then is 0 with kHiddenSecret behind it where there
// is one.
enum class Secrets : uint8_t { kShown, kHidden };
inline constexpr std::string_view kHiddenSecret = "# not shown";
std::string ToToml(const Configuration& configuration, Secrets secrets = Secrets::kShown);

}  // namespace hardpack
