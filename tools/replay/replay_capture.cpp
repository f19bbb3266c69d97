// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <deque>
#include <memory>

#include "hal/sevcon/canopen.h"
#include "tools/capture/pcap_reader.h"
#include "tools/replay/replay.h"

namespace hardpack::replay {
namespace {

constexpr int64_t kMillisecond_ns = 1'000'000;
// A capture with a longer pause was stopped in between: that time gets no ticks.
constexpr int64_t kMaxPause_ns = 60'000'000'000;

// Whether an identifier is one that only the master sends: a capture does not tell who did.
bool IsOwn(const CanFrame& frame, const DriveParams& drive) {
  using namespace sevcon;
  if (frame.extended) return false;
  if (frame.id == kNmtId || frame.id == IdOf(kHeartbeatBase, drive.master_node)) return true;
  if (frame.id == kSyncId) return drive.sync_period_ms > 0;
  const int32_t nodes[] = {drive.left_node, drive.right_node};
  return std::any_of(std::begin(nodes), std::end(nodes), [&frame](int32_t node) {
    return frame.id == IdOf(kCommandBase, node) || frame.id == IdOf(kSdoQuestionBase, node);
  });
}

bool IsFrom(const capture::UdpDatagram& datagram, const DatagramSource& source) {
  const bool right_sender =
      source.address.value == 0 || source.address.value == datagram.source_address;
  return source.port != 0 && datagram.destination_port == source.port && right_sender;
}

class CaptureReplay {
 public:
  CaptureReplay(AnyVehicle& vehicle, const Configuration& configuration, Report& report)
      : vehicle_(vehicle), configuration_(configuration), report_(report), observer_(report) {
    period_ns_ = configuration.onboard.tick.period_ms * kMillisecond_ns;
  }

  ReadOutcome Read(const std::string& path) {
    capture::PcapReader reader;
    const ReadOutcome opened = reader.Open(path);
    if (!opened.ok()) return opened;
    reader.DropDuplicates();
    capture::CapturedPacket packet;
    while (reader.Next(packet)) Take(packet);
    report_.duplicates += reader.counters().duplicates;
    report_.incomplete += reader.reassembly().incomplete + reader.reassembly().conflicts;
    report_.cut = report_.cut || !reader.outcome().ok();
    return {};
  }

  // Input that no tick has taken yet.
  void Finish() {
    while (Waiting()) Tick();
  }

 private:
  void Take(const capture::CapturedPacket& packet) {
    if (packet.kind == capture::CapturedPacket::Kind::kCanFrame) {
      if (IsOwn(packet.frame, configuration_.onboard.drive)) {
        ++report_.own_frames;
        return;
      }
      AdvanceTo(packet.time_ns);
      frames_.push_back(packet.frame);
      return;
    }
    const DatagramSource* const sources[kInputSources] = {
        &configuration_.ins, &configuration_.label_source, &configuration_.lidar};
    for (size_t i = 0; i < kInputSources; ++i) {
      if (!IsFrom(packet.datagram, *sources[i])) continue;
      AdvanceTo(packet.time_ns);
      const std::span<const uint8_t> payload = packet.datagram.payload;
      datagrams_[i].emplace_back(payload.begin(), payload.end());
      return;
    }
    ++report_.foreign_datagrams;
  }

  // Ticks until the next tick is the one that takes a packet of that time.
  void AdvanceTo(int64_t time_ns) {
    if (next_tick_ns_ == 0) next_tick_ns_ = time_ns + period_ns_;
    if (time_ns - next_tick_ns_ > kMaxPause_ns) {
      Finish();
      const int64_t missed = (time_ns - next_tick_ns_) / period_ns_;
      index_ += static_cast<uint64_t>(missed);
      next_tick_ns_ += missed * period_ns_;
    }
    while (time_ns > next_tick_ns_) Tick();
  }

  bool Waiting() const {
    return !frames_.empty() || std::any_of(datagrams_.begin(), datagrams_.end(),
                                           [](const auto& queue) { return !queue.empty(); });
  }

  void Tick() {
    std::vector<std::vector<uint8_t>> taken;
    std::vector<TickDatagram> datagrams;
    taken.reserve(TickLimits::kMaxDatagramsPerTick);
    for (size_t source = 0; source < kInputSources; ++source) {
      std::deque<std::vector<uint8_t>>& queue = datagrams_[source];
      while (!queue.empty() && taken.size() < TickLimits::kMaxDatagramsPerTick) {
        taken.push_back(std::move(queue.front()));
        queue.pop_front();
        datagrams.push_back({static_cast<InputSource>(source), taken.back()});
      }
    }
    std::vector<CanFrame> frames;
    while (!frames_.empty() && frames.size() < CanBus::kMaxFramesPerTick) {
      frames.push_back(frames_.front());
      frames_.pop_front();
    }
    const TickInput input = {
        index_++, static_cast<uint64_t>(next_tick_ns_), CanBusState::kActive, datagrams, frames,
        {}};
    next_tick_ns_ += period_ns_;
    // A tick that is refused is in the loop's counters.
    static_cast<void>(observer_.Tick(input, vehicle_, output_));
  }

  AnyVehicle& vehicle_;
  const Configuration& configuration_;
  Report& report_;
  Observer observer_;
  int64_t period_ns_ = 0;
  int64_t next_tick_ns_ = 0;  // 0: nothing has come yet
  uint64_t index_ = 0;
  std::deque<CanFrame> frames_;
  std::array<std::deque<std::vector<uint8_t>>, kInputSources> datagrams_;
  TickOutput output_;
};

}  // namespace

ReadOutcome ReplayCapture(const Request& request, ChosenVehicle& vehicle,
                          Configuration& configuration, Report& report) {
  if (request.configuration_path.empty()) {
    return {Status::kInvalidArgument,
            request.files.front() + ": a plain capture, which needs --config"};
  }
  const ReadOutcome read = ReadConfiguration(request.configuration_path, configuration);
  if (!read.ok()) return read;
  if (!request.metadata_path.empty()) configuration.lidar.metadata = request.metadata_path;
  const auto lidars = std::make_unique<LidarConfigs>();
  std::string text;
  const ReadOutcome lidar = ReadLidar(configuration, text, *lidars);
  if (!lidar.ok()) return lidar;
  ReadOutcome configured = vehicle.Configure(configuration, *lidars);
  if (!configured.ok()) {
    configured.message = request.configuration_path + ": refused: " + configured.message;
    return configured;
  }
  report.files = request.files;
  CaptureReplay replay(*vehicle.get(), configuration, report);
  for (const std::string& path : request.files) {
    const ReadOutcome taken = replay.Read(path);
    if (!taken.ok()) return taken;
  }
  replay.Finish();
  if (report.ticks == 0) report.not_comparable = "it contains no input for a tick";
  return {};
}

}  // namespace hardpack::replay
