// SPDX-License-Identifier: Apache-2.0
// Any bytes as a Velodyne's datagrams: of each model, return mode and rate, through the device and
// the geometry of the beams.
//   byte 0  model, return mode, rate
//   then datagrams: a u16 with their size in the input, a byte that says what is to be done with
//   them (kResume ...), the bytes
// Required: each datagram is counted once; of one that is accepted each column has a place within
// the revolution, no further off than the ring takes, in order, and its points are possible; the
// same again is a duplicate.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

#include "core/scan/scan.h"
#include "hal/velodyne/lidar.h"
#include "test/fuzz/accepted.h"

using namespace hardpack;
using namespace hardpack::velodyne;

namespace {

enum Treatment : uint8_t {
  kResume = 1,   // before it
  kFill = 2,     // with zeros, or cut it, to the size of a packet
  kRepair = 4,   // flags, return mode, product
  kTurn = 8,     // its azimuths go on evenly from the first
  kNext = 16,    // its stamp and first azimuth follow the one before
  kRepeat = 32,  // the one before it instead
};

void Require(bool condition) {
  if (!condition) std::abort();
}

Config ConfigFrom(uint8_t byte) {
  constexpr ReturnMode kModes[] = {ReturnMode::kStrongest, ReturnMode::kLast, ReturnMode::kDual};
  return {.model = byte % 2 == 0 ? Model::kVlp16 : Model::kVlp32c,
          .return_mode = kModes[byte / 2 % 3],
          .rpm = kLeastRpm + kRpmStep * (byte / 6 % 12)};
}

uint64_t SumOf(const PacketCounters& c) {
  return c.accepted + c.wrong_size + c.wrong_type + c.wrong_sensor + c.wrong_mode + c.bad_azimuth +
         c.bad_time + c.wrong_rate + c.not_resumed + c.duplicates;
}

uint32_t Number(const std::vector<uint8_t>& bytes, size_t at, size_t size) {
  uint32_t number = 0;
  for (size_t i = 0; i < size; ++i) number |= uint32_t{bytes[at + i]} << (8 * i);
  return number;
}

void Put(std::vector<uint8_t>& bytes, size_t at, size_t size, uint32_t number) {
  for (size_t i = 0; i < size; ++i) bytes[at + i] = static_cast<uint8_t>(number >> (8 * i));
}

class Stream {
 public:
  explicit Stream(const Config& config)
      : config_(config), format_(FormatOf(config)), layout_(Lidar::LayoutOf(config)) {
    Require(lidar_->Configure(config) == Status::kOk);
    Require(MakeBeamModel(layout_, *model_) == Status::kOk);
    Require(ring_->Configure(format_.beams, layout_.columns_per_revolution) == Status::kOk);
  }

  void Take(uint8_t treatment, std::span<const uint8_t> bytes) {
    if ((treatment & kRepeat) == 0) {
      packet_.assign(bytes.begin(), bytes.end());
      if ((treatment & kFill) != 0) packet_.resize(kPacket_bytes);
      if (packet_.size() == kPacket_bytes) Treat(treatment);
    }
    if ((treatment & kResume) != 0) lidar_->Resume();
    ++given_;
    const Status status = lidar_->Check(packet_);
    Require(SumOf(lidar_->counters()) == given_);
    Require(lidar_->counters().missing <= given_ * 20'000u);
    for (const int index : {-1, lidar_->columns()}) {
      Require(!IsUsable(lidar_->Decode(packet_, index, *column_)));
    }
    if (status != Status::kOk) return;
    Accepted(config_.model == Model::kVlp16 ? "vlp16" : "vlp32c");
    if (config_.return_mode == ReturnMode::kDual) Accepted("dual");
    DecodeAll();
    ++given_;
    Require(lidar_->Check(packet_) == Status::kDuplicate);
  }

 private:
  void Treat(uint8_t treatment) {
    if ((treatment & kRepair) != 0) {
      for (size_t block = 0; block < 12; ++block) Put(packet_, 100 * block, 2, 0xeeff);
      packet_[1204] = static_cast<uint8_t>(config_.return_mode);
      packet_[1205] = format_.product;
    }
    const double turn_cdeg = config_.rpm * 600.0 * 55.296e-6;
    if ((treatment & kNext) != 0) {
      time_us_ += 55.296 * format_.firings;
      azimuth_cdeg_ += turn_cdeg * format_.firings;
      Put(packet_, 1200, 4, static_cast<uint32_t>(std::fmod(time_us_, 3.6e9)));
      Put(packet_, 2, 2, static_cast<uint32_t>(std::fmod(azimuth_cdeg_, 36'000.0)));
    } else {
      time_us_ = Number(packet_, 1200, 4);
      azimuth_cdeg_ = Number(packet_, 2, 2) % 36'000u;
    }
    if ((treatment & kTurn) == 0) return;
    for (size_t block = 0; block < 12; ++block) {
      const auto group =
          static_cast<double>(block / (config_.return_mode == ReturnMode::kDual ? 2 : 1));
      const double at_cdeg = azimuth_cdeg_ + turn_cdeg * format_.firings_per_block * group;
      Put(packet_, 100 * block + 2, 2, static_cast<uint32_t>(std::fmod(at_cdeg, 36'000.0)));
    }
  }

  void DecodeAll() {
    uint64_t before_ns = 0;
    int64_t before = -1;
    uint16_t first_frame = 0;
    std::vector<uint8_t> self(static_cast<size_t>(format_.beams));
    for (int index = 0; index < lidar_->columns(); ++index) {
      Require(lidar_->Decode(packet_, index, *column_) == Status::kOk);
      if (index == 0) first_frame = column_->frame_id;
      const int64_t frames = static_cast<uint16_t>(column_->frame_id - first_frame);
      const int64_t name = frames * layout_.columns_per_revolution + column_->measurement_id;
      Require(column_->measurement_id < layout_.columns_per_revolution && frames <= 1);
      Require(name >= before && column_->timestamp_ns > before_ns);
      before = name;
      before_ns = column_->timestamp_ns;
      Require(ring_->TakesOffset(*column_) && column_->beams == format_.beams);
      Require(ring_->Push(*column_, 1, Transform3{}, self) != Status::kBadColumn);
      const SinCosPair encoder =
          EncoderSinCos(*model_, column_->measurement_id, column_->azimuth_offset_rad);
      for (int row = 0; row < format_.beams; ++row) {
        const Vec3 point = PointInSensor(*model_, encoder, row, NearestRange(*column_, row));
        Require(Abs(point.x_m) < 263.0f && Abs(point.y_m) < 263.0f && Abs(point.z_m) < 112.0f);
      }
    }
  }

  Config config_;
  Format format_;
  LidarLayout layout_;
  std::unique_ptr<Lidar> lidar_ = std::make_unique<Lidar>();
  std::unique_ptr<BeamModel> model_ = std::make_unique<BeamModel>();
  std::unique_ptr<ScanRing> ring_ = std::make_unique<ScanRing>();
  std::unique_ptr<LidarColumn> column_ = std::make_unique<LidarColumn>();
  std::vector<uint8_t> packet_;
  uint64_t given_ = 0;
  double time_us_ = 0.0;
  double azimuth_cdeg_ = 0.0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 1) return 0;
  Stream stream(ConfigFrom(data[0]));
  std::span<const uint8_t> rest(data + 1, size - 1);
  while (rest.size() >= 3) {
    const size_t length = std::min<size_t>(rest[0] + 256u * rest[1], rest.size() - 3);
    stream.Take(rest[2], rest.subspan(3, length));
    rest = rest.subspan(3 + length);
  }
  return 0;
}
