// SPDX-License-Identifier: Apache-2.0
#include "port_linux/hardpackd/devices.h"

#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <span>

#include "port_linux/hardpackd/revision.h"

namespace hardpack {
namespace {

constexpr uint64_t kBytesPerMegabyte = 1'000'000;
constexpr int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr uint64_t kLogDrain_ns = 5'000'000'000;
constexpr uint32_t kBitsPerKilobit = 1000;

// Reports the outcome; true if it is open.
bool Tell(std::string_view what, const OpenOutcome& outcome) {
  const std::string begin = std::string(what) + ": ";
  const std::string warns = "warning: " + begin;
  for (const std::string& warning : outcome.warnings) Say(warns + warning);
  if (!outcome.message.empty()) Say(begin + outcome.message);
  return outcome.ok();
}

UdpSocketOptions OptionsOf(const DatagramSource& source) {
  UdpSocketOptions options;
  options.bind_address = source.bind_address.value;
  options.port = static_cast<uint16_t>(source.port);
  options.sender_address = source.address.value;
  options.receive_buffer_bytes = source.receive_buffer_bytes;
  options.require_receive_buffer = source.require_receive_buffer;
  return options;
}

int64_t WallClockOffset_ns(MonotonicClock& clock) {
  timespec wall = {};
  clock_gettime(CLOCK_REALTIME, &wall);
  return wall.tv_sec * kNanosecondsPerSecond + wall.tv_nsec - static_cast<int64_t>(clock.Now_ns());
}

template <size_t kSize>
void Copy(std::string_view text, char (&field)[kSize]) {
  std::copy_n(text.begin(), std::min(text.size(), kSize - 1), field);
}

}  // namespace

std::span<const uint8_t> BytesOf(std::string_view text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

namespace {

flight_log::Endpoint Sender(const DatagramSource& source) {
  return {source.address.value, static_cast<uint16_t>(source.port)};
}
flight_log::Endpoint Receiver(const DatagramSource& source) {
  const uint32_t address =
      source.bind_address.value == 0 ? flight_log::kLoopback : source.bind_address.value;
  return {address, static_cast<uint16_t>(source.port)};
}

}  // namespace

void Say(std::string_view text) {
  std::string line = "hardpackd: ";
  line += text;
  line += '\n';
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, line.data(), line.size());
}

bool Devices::Open(const Startup& startup, const AnyVehicle& vehicle) {
  const Configuration& configuration = startup.configuration;
  // First of all, so that a second instance touches nothing.
  const ControlSocketOptions control = {configuration.control.socket, configuration.control.group};
  if (!Tell("control socket", control_.Open(control))) return false;
  SocketCanOptions can;
  can.restart = configuration.can.restart;
  can.bit_rate_bps =
      static_cast<uint32_t>(configuration.onboard.drive.bit_rate_kbps) * kBitsPerKilobit;
  return Tell(configuration.can.interface, can_.Open(configuration.can.interface, can)) &&
         OpenSensors(configuration) && OpenLog(startup, vehicle) &&
         Tell("service manager", watchdog_.Open());
}

bool Devices::OpenSensors(const Configuration& configuration) {
  has_labels_ = configuration.perception.mapping.use_labels != 0;
  // A vehicle that needs no INS may have none.
  has_ins_ = configuration.ins.address.value != 0;
  return (!has_ins_ || Tell("ins", ins_.Open(OptionsOf(configuration.ins)))) &&
         (!has_labels_ || Tell("labels", labels_.Open(OptionsOf(configuration.label_source)))) &&
         Tell("lidar", lidar_.Open(OptionsOf(configuration.lidar)));
}

bool Devices::OpenLog(const Startup& startup, const AnyVehicle& vehicle) {
  const LogConfiguration& log = startup.configuration.log;
  if (!log.enabled) {
    Say("warning: log.enabled = false: this run cannot be replayed");
    return true;
  }
  FileRecorderConfig config;
  config.directory = log.directory;
  config.file_bytes = static_cast<uint64_t>(log.file_size_mb) * kBytesPerMegabyte;
  config.total_bytes = static_cast<uint64_t>(log.max_total_mb) * kBytesPerMegabyte;
  config.min_free_bytes = static_cast<uint64_t>(log.min_free_mb) * kBytesPerMegabyte;
  config.ring_bytes = static_cast<size_t>(log.buffer_mb) * kBytesPerMegabyte;
  const ReadOutcome started = recorder_.Start(config);
  if (!started.ok()) {
    Say(started.message);
    return false;
  }
  const size_t state_bytes = vehicle.state().size();
  snapshot_ = std::make_unique<uint8_t[]>(state_bytes);
  flight_log_ =
      std::make_unique<flight_log::FlightLog>(recorder_, std::span(snapshot_.get(), state_bytes));
  flight_log::FlightLogSetup setup;
  setup.wall_clock_offset_ns = WallClockOffset_ns(clock_);
  setup.version.state_layout = vehicle.state_layout();
  vehicle.CopyType(setup.version.vehicle);
  setup.version.run = static_cast<uint64_t>(setup.wall_clock_offset_ns) + clock_.Now_ns();
  Copy(HARDPACK_VERSION, setup.version.version);
  Copy(std::string(kRevision) + ", " + __VERSION__, setup.version.build);
  utsname machine = {};
  if (uname(&machine) == 0) Copy(machine.machine, setup.version.processor);
  setup.configuration = BytesOf(startup.configuration_text);
  setup.lidar_metadata = BytesOf(startup.lidar_text);
  const Configuration& configuration = startup.configuration;
  const DatagramSource* const sources[kInputSources] = {
      &configuration.ins, &configuration.label_source, &configuration.lidar};
  for (int i = 0; i < kInputSources; ++i) {
    setup.sender[i] = Sender(*sources[i]);
    setup.receiver[i] = Receiver(*sources[i]);
  }
  if (IsUsable(flight_log_->Start(setup))) return true;
  Say("log: the configuration's or the metadata's text is too long to be logged");
  return false;
}

void Devices::BecomeRealtime(const ProcessConfiguration& process) {
  realtime_ = hardpack::BecomeRealtime({.priority = process.realtime_priority,
                                        .lock_memory = process.lock_memory,
                                        .cpu = process.cpu});
  for (const std::string& refused : realtime_.refused) Say("warning: " + refused);
}

void Devices::Close() {
  if (flight_log_) {
    flight_log_->End();
    if (!recorder_.Stop(kLogDrain_ns)) Say("warning: the log's end could not be written");
  }
  control_.Close();
}

OnboardDevices Devices::ForOnboard() {
  OnboardDevices devices;
  devices.clock = &clock_;
  devices.can = &can_;
  devices.ins = has_ins_ ? &ins_ : nullptr;
  devices.labels = has_labels_ ? &labels_ : nullptr;
  devices.lidar = &lidar_;
  devices.recorder = flight_log_ ? &recorder_ : nullptr;
  devices.flight_log = flight_log_.get();
  devices.watchdog = &watchdog_;
  devices.control = &control_;
  return devices;
}

}  // namespace hardpack
