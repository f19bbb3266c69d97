// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "hal/can_frame.h"
#include "hal/onboard/flight_log/records.h"
#include "hal/onboard/vehicle_loop/vehicle_loop.h"
#include "port_linux/files/read_outcome.h"
#include "tools/capture/pcap_reader.h"

// Reads one file of a flight log (hal/onboard/flight_log, docs/flight_log.md), tick by tick, and
// its opening records. It trusts nothing: ticks that do not match their own records are
// distinguished from whole ones, and a file may end anywhere.

namespace hardpack::capture {

struct LoggedDatagram {
  InputSource source = InputSource::kIns;
  flight_log::Endpoint sender;
  std::vector<uint8_t> bytes;
};

struct LoggedTick {
  int64_t time_ns = 0;  // wall clock
  flight_log::TickBeginRecord begin;
  flight_log::TickEndRecord end;
  std::vector<CanFrame> frames_in;
  std::vector<LoggedDatagram> datagrams;
  std::vector<uint8_t> command;
  uint32_t command_user = 0;
  std::vector<CanFrame> frames_out;
};

// A text or an image assembled from its parts.
struct Assembled {
  std::vector<uint8_t> bytes;
  uint64_t next = 0;  // start of the next part
  bool whole = false;
  bool damaged = false;  // parts are missing, or contradict each other
};

class FlightReader {
 public:
  enum class Item : uint8_t {
    kTick,
    kGap,      // gap_records() are missing
    kEnd,      // the run ended as it should
    kDamaged,  // the data is not a tick; damage() says why
    kFileEnd,  // outcome() says whether it ends within a packet
  };

  // Whether a file is a flight log: it is if one of its first packets is one of our records.
  // kInvalidArgument, kUnsupported: as for PcapReader::Open.
  static ReadOutcome IsFlightLog(const std::string& path, bool& is_log);

  // As for PcapReader::Open.
  ReadOutcome Open(const std::string& path);

  // The next item of the file; `tick` is valid only on kTick. The opening records, and the parts of
  // the image, are collected on the way.
  Item Next(LoggedTick& tick);

  bool has_version() const { return has_version_; }
  const flight_log::VersionRecord& version() const { return version_; }
  const Assembled& configuration() const { return configuration_; }
  const Assembled& lidar_metadata() const { return lidar_metadata_; }
  const Assembled& image() const { return image_; }
  uint64_t image_index() const { return image_index_; }  // of the tick after which it was taken

  uint64_t gap_records() const { return gap_records_; }
  const std::string& damage() const { return damage_; }
  // A tick has begun but not ended: the file was cut off there.
  bool ends_within_tick() const { return in_tick_; }
  const ReadOutcome& outcome() const { return reader_.outcome(); }

 private:
  bool Damage(const std::string& reason);
  bool TakeRecord(const UdpDatagram& datagram, LoggedTick& tick, Item& item);
  bool TakePart(flight_log::RecordKind kind, std::span<const uint8_t> payload);
  bool TakeImage(std::span<const uint8_t> payload);
  bool BeginTick(std::span<const uint8_t> payload, int64_t time_ns, LoggedTick& tick);
  bool EndTick(std::span<const uint8_t> payload, LoggedTick& tick);
  bool TakeCommand(std::span<const uint8_t> payload, LoggedTick& tick);
  bool TakeDatagram(const UdpDatagram& datagram, LoggedTick& tick);
  bool TakeFrame(const CapturedPacket& packet, LoggedTick& tick);

  PcapReader reader_;
  bool has_version_ = false;
  flight_log::VersionRecord version_;
  Assembled configuration_;
  Assembled lidar_metadata_;
  Assembled image_;
  uint64_t image_index_ = 0;
  uint32_t image_crc_ = 0;
  uint64_t gap_records_ = 0;
  std::string damage_;
  bool in_tick_ = false;
};

}  // namespace hardpack::capture
