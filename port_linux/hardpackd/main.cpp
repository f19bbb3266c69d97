// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "core/base/assert.h"
#include "port_linux/chosen_vehicle.h"
#include "port_linux/hardpackd/allocation_guard.h"
#include "port_linux/hardpackd/devices.h"
#include "port_linux/hardpackd/revision.h"

// The onboard program: reads its configuration, opens everything, ticks until it is told to stop.

namespace hardpack {
namespace {

constexpr const char* kHelp =
    "usage: hardpackd --config FILE\n"
    "       hardpackd --check-config FILE     reports every error, opens nothing\n"
    "       hardpackd --print-config FILE     prints every key with its effective value\n"
    "       hardpackd --version | --help\n"
    "\n"
    "Receives lidar and INS datagrams and CAN frames, drives the vehicle, writes the flight log\n"
    "(docs/onboard.md). `hardpack ctl` talks to it. SIGTERM, SIGINT or SIGHUP stop the vehicle,\n"
    "disable the drives and end the program; a second SIGTERM or SIGINT ends it at once.\n"
    "\n"
    "Exit codes: 0 ended on request; 1 something could not be opened or set up; 2 bad usage or\n"
    "configuration. Each reason is one line on stderr.\n";

enum ExitCode : int { kDone = 0, kFailed = 1, kBadInput = 2 };

std::atomic<bool> g_stop = false;
std::atomic<bool> g_told_to_end = false;  // by a signal; a second one ends it at once

extern "C" void OnStopSignal(int /*signal*/) {
  constexpr int kSignalled = 130;
  if (g_told_to_end.exchange(true)) std::_Exit(kSignalled);
  g_stop = true;
}

// A service manager or a closing terminal may send it in addition: it never ends the program at
// once.
extern "C" void OnHangUp(int /*signal*/) {
  g_stop = true;
}

// The drives' own time-outs bring the vehicle to rest; a service manager starts us again.
[[noreturn]] void OnAssertion(const char* file, int line, const char* expression) {
  std::fprintf(stderr, "hardpackd: %s:%d: assertion failed: %s\n", file, line, expression);
  std::abort();
}

void PrepareSignals() {
  struct sigaction action = {};
  action.sa_handler = OnStopSignal;
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
  action.sa_handler = OnHangUp;
  sigaction(SIGHUP, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

int Fail(ExitCode code, const ReadOutcome& outcome) {
  size_t begin = 0;
  while (begin < outcome.message.size()) {
    const size_t end = outcome.message.find('\n', begin);
    Say(std::string_view(outcome.message).substr(begin, end - begin));
    if (end == std::string::npos) break;
    begin = end + 1;
  }
  return code;
}

ReadOutcome ReadStartup(const std::string& path, Startup& startup) {
  ReadOutcome outcome = ReadConfiguration(path, startup.configuration);
  if (!outcome.ok()) return outcome;
  startup.configuration_text = ToToml(startup.configuration, Secrets::kHidden);
  return ReadLidar(startup.configuration, startup.lidar_text, startup.lidars);
}

// The only instance of these 8 MiB.
ChosenVehicle g_vehicle;

// Writes to every page once, so that the first plan does not wait for them if memory is not locked.
void TouchPages(std::span<std::byte> memory) {
  constexpr size_t kPage_bytes = 4096;
  for (size_t i = 0; i < memory.size(); i += kPage_bytes) {
    volatile std::byte& byte = memory[i];
    byte = byte;
  }
}

int Drive(const Startup& startup) {
  const Configuration& configuration = startup.configuration;
  const auto devices = std::make_unique<Devices>();
  if (!devices->Open(startup, *g_vehicle.get())) return kFailed;
  devices->BecomeRealtime(configuration.process);
  TouchPages(g_vehicle.memory());
  constexpr uint64_t kNanosecondsPerMillisecond = 1'000'000;
  RunOptions options;
  options.period_ms = configuration.onboard.tick.period_ms;
  options.frame_age_ns =
      static_cast<uint64_t>(configuration.can.frame_max_age_ms) * kNanosecondsPerMillisecond;
  options.version = std::string_view(HARDPACK_VERSION);
  options.parameters = BytesOf(startup.configuration_text);
  options.realtime_scheduled = devices->realtime().scheduled;
  options.memory_locked = devices->realtime().locked;
  options.allocations = AllocationsSinceFrozen;
  const auto run_loop = std::make_unique<RunLoop>(*g_vehicle.get(), devices->ForOnboard(), options);
  Say("running; " + std::to_string(configuration.onboard.tick.period_ms) + " ms a tick");
  FreezeHeap(configuration.process.abort_on_allocation);
  run_loop->Begin();
  while (run_loop->Next(g_stop.load(std::memory_order_relaxed))) {
  }
  ThawHeap();
  devices->Close();
  Say("ended after " + std::to_string(run_loop->index()) + " ticks");
  return kDone;
}

int Main(int argc, char** argv) {
  const std::string_view option = argc > 1 ? argv[1] : "";
  if (argc == 2 && (option == "--help" || option == "-h")) return std::fputs(kHelp, stdout), kDone;
  if (argc == 2 && option == "--version") {
    return std::printf("%s (%s)\n", HARDPACK_VERSION, kRevision), kDone;
  }
  const bool checks = option == "--check-config";
  const bool prints = option == "--print-config";
  if (argc != 3 || (option != "--config" && !checks && !prints)) {
    std::fputs(kHelp, stderr);
    return kBadInput;
  }
  const auto startup = std::make_unique<Startup>();
  ReadOutcome outcome = ReadStartup(argv[2], *startup);
  if (outcome.ok()) outcome = g_vehicle.Configure(startup->configuration, startup->lidars);
  if (!outcome.ok()) return Fail(kBadInput, outcome);
  if (prints) std::fputs(ToToml(startup->configuration).c_str(), stdout);
  if (checks || prints) return kDone;
  return Drive(*startup);
}

}  // namespace
}  // namespace hardpack

int main(int argc, char** argv) {
  hardpack::SetAssertionHook(hardpack::OnAssertion);
  hardpack::PrepareSignals();
  return hardpack::Main(argc, argv);
}
