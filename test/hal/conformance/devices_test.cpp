// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

#include "hal/ouster/lidar.h"
#include "hal/sevcon/sevcon.h"
#include "hal/vectornav/encode.h"
#include "hal/vectornav/stream_parser.h"
#include "hal/velodyne/lidar.h"
#include "test/hal/conformance/drive_device_conformance.h"
#include "test/hal/conformance/ins_device_conformance.h"
#include "test/hal/conformance/lidar_device_conformance.h"
#include "test/hal/ouster/ouster_packets.h"
#include "test/hal/pose_datagram/samples.h"
#include "test/hal/sevcon/bench.h"
#include "test/hal/twist_drive/controller.h"
#include "test/hal/velodyne/velodyne_packets.h"

// The devices that a vehicle can have (hal/onboard/vehicle_loop/vehicles.h).

namespace hardpack {
namespace {

struct OusterHarness {
  using Device = ouster::Lidar;
  static constexpr bool kTellsRestarts = true;

  static ouster::Metadata config() {
    ouster::Metadata metadata;
    metadata.profile = ouster::Profile::kRng19Rfl8Sig16Nir16;
    metadata.beams = 32;
    metadata.columns_per_frame = 512;
    metadata.columns_per_packet = 16;
    metadata.column_window_last = 511;
    for (int row = 0; row < metadata.beams; ++row) {
      metadata.beam_altitude_deg[row] = 15.0f - static_cast<float>(row);
    }
    return metadata;
  }
  static std::vector<uint8_t> DatagramOf(int k, uint32_t init_id) {
    const ouster::Metadata metadata = config();
    const int per_frame = metadata.columns_per_frame / metadata.columns_per_packet;
    std::vector<LidarColumn> columns(static_cast<size_t>(metadata.columns_per_packet));
    for (int i = 0; i < metadata.columns_per_packet; ++i) {
      LidarColumn& column = columns[static_cast<size_t>(i)];
      const int number = k * metadata.columns_per_packet + i;
      column.timestamp_ns = 1'000'000'000u + static_cast<uint64_t>(number) * 195'312u;
      column.measurement_id = static_cast<uint16_t>(number % metadata.columns_per_frame);
      column.frame_id = static_cast<uint16_t>(k / per_frame);
      column.status = 1;
      column.beams = metadata.beams;
      for (int row = 0; row < column.beams; ++row) column.range_mm[row] = 5000u;
    }
    ouster::test::PacketIdentity identity;
    identity.frame_id = static_cast<uint16_t>(k / per_frame);
    identity.init_id = init_id;
    identity.serial_number = 122;
    return ouster::test::EncodeRng19(identity, columns);
  }
  static std::vector<uint8_t> Datagram(int k) { return DatagramOf(k, 7); }
  static std::vector<uint8_t> Restarted(int k) { return DatagramOf(k, 8); }
};
INSTANTIATE_TYPED_TEST_SUITE_P(Ouster, LidarDeviceConformance, OusterHarness);

template <velodyne::Model kModel, velodyne::ReturnMode kMode>
struct VelodyneHarness {
  using Device = velodyne::Lidar;
  static constexpr bool kTellsRestarts = true;

  static velodyne::Config config() { return {kModel, kMode, 600}; }
  static std::vector<uint8_t> DatagramFrom(uint64_t begin_us, int k) {
    return velodyne::test::PacketOf(
        {.config = config(), .begin_cdeg = 35'000.0, .begin_us = begin_us}, k);
  }
  static std::vector<uint8_t> Datagram(int k) { return DatagramFrom(900'000'000, k); }
  static std::vector<uint8_t> Restarted(int k) { return DatagramFrom(20'000'000, k); }
};
using Vlp16Harness = VelodyneHarness<velodyne::Model::kVlp16, velodyne::ReturnMode::kStrongest>;
using Vlp32cHarness = VelodyneHarness<velodyne::Model::kVlp32c, velodyne::ReturnMode::kDual>;
INSTANTIATE_TYPED_TEST_SUITE_P(Vlp16, LidarDeviceConformance, Vlp16Harness);
INSTANTIATE_TYPED_TEST_SUITE_P(Vlp32c, LidarDeviceConformance, Vlp32cHarness);

struct VectorNavHarness {
  using Device = vectornav::StreamParser;

  static std::vector<uint8_t> Message(int k) {
    InsSample sample;
    sample.has_timestamp = true;
    sample.timestamp_ns = 1'000'000u + static_cast<uint64_t>(k) * 10'000'000u;
    sample.has_attitude = true;
    sample.yaw_rad = 0.5f;
    sample.has_angular_rate = true;
    sample.angular_rate = {0.0f, 0.0f, 0.1f};
    std::array<uint8_t, vectornav::kMaxMessageBytes> bytes;
    size_t size = 0;
    EXPECT_EQ(vectornav::EncodeBinary(sample, bytes, size), Status::kOk);
    return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)};
  }
};
INSTANTIATE_TYPED_TEST_SUITE_P(VectorNav, InsDeviceConformance, VectorNavHarness);

struct PoseDatagramHarness {
  using Device = pose_datagram::Receiver;

  static std::vector<uint8_t> Message(int k) {
    InsSample sample = pose_datagram::Example();
    sample.timestamp_ns = 1'000'000u + static_cast<uint64_t>(k) * 10'000'000u;
    return pose_datagram::Encoded(sample, static_cast<uint32_t>(k));
  }
};
INSTANTIATE_TYPED_TEST_SUITE_P(PoseDatagram, InsDeviceConformance, PoseDatagramHarness);

class SevconHarness {
 public:
  using Device = sevcon::DrivePair;

  Device& device() { return bench_.pair; }
  uint64_t now_ns() const { return bench_.now_ns; }
  void Step(const DriveDemand& demand) { bench_.Tick(demand); }
  void Silence() { bench_.left.powered = bench_.right.powered = false; }

 private:
  sevcon::Bench bench_ = sevcon::Bench::WithDrivesSetUp();
};
INSTANTIATE_TYPED_TEST_SUITE_P(Sevcon, DriveDeviceConformance, SevconHarness);

class TwistHarness {
 public:
  using Device = twist_drive::TwistDrive;

  Device& device() { return bench_.drive; }
  uint64_t now_ns() const { return bench_.now_ns; }
  void Step(const DriveDemand& demand) { bench_.Tick(demand); }
  void Silence() { bench_.speaks = false; }

 private:
  twist_drive::Bench bench_;
};
INSTANTIATE_TYPED_TEST_SUITE_P(Twist, DriveDeviceConformance, TwistHarness);

}  // namespace
}  // namespace hardpack
