// SPDX-License-Identifier: Apache-2.0
#include "tools/capture/scan_loader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "core/base/math.h"
#include "test/hal/ouster/ouster_packets.h"
#include "test/tools/capture/capture_files.h"

namespace hardpack::capture {
namespace {

using test::Bytes;
using test::CaptureFile;
using test::Ethernet;
using test::IpOptions;
using test::Ipv4;
using test::TextFile;
using test::Udp;

constexpr int kBeams = 16;
constexpr int kColumns = 512;
constexpr int kPacketsPerRevolution = kColumns / 16;

// Sixteen level beams: row r of column m is at angle -2 pi m / W, mounted without a turn.
std::string LevelSensor(const std::string& more = "") {
  std::string zeros = "0";
  for (int i = 1; i < kBeams; ++i) zeros += ",0";
  return R"({"beam_altitude_angles": [)" + zeros + R"(], "beam_azimuth_angles": [)" + zeros +
         R"(], "lidar_mode": "512x10", "lidar_origin_to_beam_origin_mm": 0,
         "lidar_to_sensor_transform": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1])" +
         more + "}";
}

// Packet `index` of a revolution whose every return is at range_mm.
Bytes Packet(int frame_id, int index, uint32_t range_mm) {
  std::vector<LidarColumn> columns(16);
  for (int i = 0; i < 16; ++i) {
    LidarColumn& column = columns[static_cast<size_t>(i)];
    column.measurement_id = static_cast<uint16_t>(16 * index + i);
    column.frame_id = static_cast<uint16_t>(frame_id);
    column.timestamp_ns = static_cast<uint64_t>(frame_id) * 100'000'000u + column.measurement_id;
    column.status = 0xffffffffu;
    column.beams = kBeams;
    std::fill_n(column.range_mm, kBeams, range_mm);
  }
  return ouster::test::EncodeLegacy(columns);
}

class ScanLoader : public testing::Test {
 protected:
  void SetUp() override {
    request_.metadata_path = metadata_.path();
    request_.perception.mount.yaw_rad = 0.0f;
    request_.perception.mount.z_m = 1.0f;
    request_.perception.mount.self_min_x_m = -2.0f;
    request_.perception.mount.self_max_x_m = -0.5f;
    request_.perception.mount.min_range_m = 0.5f;
    request_.perception.mount.max_range_m = 120.0f;
  }
  void AddPacket(int frame_id, int index, uint32_t range_mm) {
    capture_.Add(Ethernet(Ipv4(Udp(Packet(frame_id, index, range_mm)))));
  }
  void AddRevolution(int frame_id, int first, int last, uint32_t range_mm) {
    for (int index = first; index < last; ++index) AddPacket(frame_id, index, range_mm);
  }
  ReadOutcome Load() {
    request_.capture_path = capture_.Write();
    return LoadLidarScan(request_, *mapper_, report_);
  }

  // Where the column lies in the ring; -1: it is not in it.
  int SlotOf(int measurement_id) const {
    const ScanRing& ring = mapper_->ring();
    for (int slot = 0; slot < ring.slots(); ++slot) {
      const ScanColumn& column = ring.column(slot);
      if (column.state != ColumnState::kAbsent && column.measurement_id == measurement_id) {
        return slot;
      }
    }
    return -1;
  }
  // The first point within a centimetre of (x, y).
  const ClassedPoint* PointAt(float x_m, float y_m) const {
    for (const ClassedPoint& point : report_.filed.points) {
      const Vec3& p = point.point_odom;
      if (std::abs(p.x_m - x_m) < 0.01f && std::abs(p.y_m - y_m) < 0.01f) return &point;
    }
    return nullptr;
  }

  TextFile metadata_{LevelSensor()};
  CaptureFile capture_;
  LidarScanRequest request_;
  LidarScanReport report_;
  std::unique_ptr<Mapper> mapper_ = std::make_unique<Mapper>();
};

TEST_F(ScanLoader, TakesTheFirstCompleteRevolution) {
  AddRevolution(7, 20, kPacketsPerRevolution, 3000);
  AddRevolution(8, 0, kPacketsPerRevolution, 4000);
  AddRevolution(9, 0, kPacketsPerRevolution, 5000);
  const ReadOutcome outcome = Load();
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  EXPECT_EQ(report_.frame_id, 8);
  EXPECT_EQ(report_.columns, kColumns);
  EXPECT_EQ(report_.missing_columns, 0);
  EXPECT_EQ(report_.filed.returns, kColumns * kBeams);
  EXPECT_EQ(mapper_->ring().at(SlotOf(0), 0).range_mm(), 4000u);
  EXPECT_EQ(report_.packets, kPacketsPerRevolution - 20 + kPacketsPerRevolution);
}

TEST_F(ScanLoader, TakesTheFullestWhenNoneIsComplete) {
  AddRevolution(7, 30, kPacketsPerRevolution, 3000);
  AddRevolution(8, 1, kPacketsPerRevolution, 4000);
  for (int frame = 9; frame < 20; ++frame) AddRevolution(frame, 0, 3, 5000);
  ASSERT_TRUE(Load().ok());
  EXPECT_EQ(report_.frame_id, 8);
  EXPECT_EQ(report_.columns, kColumns - 16);
  EXPECT_EQ(report_.missing_columns, 16);
  EXPECT_EQ(SlotOf(0), -1);
}

TEST_F(ScanLoader, TakesPacketsInAnyOrderAndRepeated) {
  std::vector<int> order;
  for (int index = 0; index < kPacketsPerRevolution; ++index) order.push_back(index);
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  for (const int index : order) {
    AddPacket(8, index, 4000);
    if (index % 5 == 0) AddPacket(8, index, 4000);
    if (index % 7 == 0) AddPacket(9, index, 5000);
  }
  ASSERT_TRUE(Load().ok());
  EXPECT_EQ(report_.frame_id, 8);
  EXPECT_EQ(report_.missing_columns, 0);
  EXPECT_EQ(mapper_->ring().counters().duplicates, 0u);
}

TEST_F(ScanLoader, CountsForeignPackets) {
  AddPacket(8, 0, 4000);
  capture_.Add(Ethernet(Ipv4(Udp(Bytes(48)))));                 // IMU
  capture_.Add(Ethernet(Ipv4(Udp(Packet(8, 1, 9000), 9999))));  // another port
  IpOptions other;
  other.source = 0x0a000001;
  capture_.Add(Ethernet(Ipv4(Udp(Packet(8, 1, 9000)), other)));  // another sensor
  const Bytes cut = Ethernet(Ipv4(Udp(Packet(8, 1, 4000))));
  capture_.Add(cut, 0, 1000);
  ASSERT_TRUE(Load().ok());
  EXPECT_EQ(report_.datagrams, 4);
  EXPECT_EQ(report_.packets, 1);
  EXPECT_EQ(report_.foreign_packets, 3);
  EXPECT_EQ(report_.damaged_datagrams, 1);
  EXPECT_EQ(report_.missing_columns, kColumns - 16);
}

TEST_F(ScanLoader, ExpectsOnlyTheSensorsWindow) {
  const TextFile windowed(LevelSensor(R"(, "column_window": [16, 31])"));
  request_.metadata_path = windowed.path();
  AddRevolution(8, 0, 2, 4000);
  AddRevolution(9, 0, 2, 5000);
  ASSERT_TRUE(Load().ok());
  EXPECT_EQ(report_.frame_id, 8);
  EXPECT_EQ(report_.columns, 16);
  EXPECT_EQ(report_.missing_columns, 0);
}

// The body stands at (100, 50) and looks along +y of odom: what is 4 m ahead of it (column 0) is at
// (100, 54), what is behind it (column 256) at (100, 46).
TEST_F(ScanLoader, PutsReturnsWhereThePoseSays) {
  AddRevolution(8, 0, kPacketsPerRevolution, 4000);
  request_.pose = {.position = {100.0f, 50.0f, 0.5f}, .yaw_rad = kHalfPi};
  ASSERT_TRUE(Load().ok());
  ASSERT_EQ(report_.filed.points.size(), static_cast<size_t>(kColumns * kBeams));
  const ClassedPoint* const ahead = PointAt(100.0f, 54.0f);
  ASSERT_NE(ahead, nullptr);
  EXPECT_NE(PointAt(100.0f, 46.0f), nullptr);
  EXPECT_NEAR(ahead->point_odom.z_m, 1.5f, 1e-3f);
  EXPECT_EQ(ahead->return_class, ReturnClass::kHard);
  const HeightGrid& grid = mapper_->heights();
  EXPECT_EQ(grid.window(), GridWindow::CenteredAt({100.0f, 50.0f}));
  EXPECT_EQ(grid.At(CellAt({100.0f, 54.0f})).highest_hard_cm, 150);
  EXPECT_EQ(grid.At(CellAt({100.0f, 52.0f})).highest_hard_cm, HeightGrid::kNone);
}

//   behind, within 2 m and half a box width: the vehicle itself
TEST_F(ScanLoader, LeavesOutTheVehicleItself) {
  AddRevolution(8, 0, kPacketsPerRevolution, 1500);
  ASSERT_TRUE(Load().ok());
  EXPECT_GT(report_.filed.self_returns, 0);
  EXPECT_EQ(report_.filed.returns, kColumns * kBeams);
  EXPECT_EQ(static_cast<int64_t>(report_.filed.points.size()),
            report_.filed.returns - report_.filed.self_returns);
  for (const ClassedPoint& point : report_.filed.points) {
    EXPECT_FALSE(IsSelfReturn(request_.perception.mount, point.point_odom, 1.5f));
  }
}

// A person who stands where the vehicle's own returns are expected is still a person.
TEST_F(ScanLoader, NeverTakesALabelledPersonForTheVehicle) {
  AddRevolution(8, 0, kPacketsPerRevolution, 1500);
  const TextFile labels("ring,meas_id,label\n0,256,17\n1,256,4\n");
  request_.labels_path = labels.path();
  ASSERT_TRUE(Load().ok());
  const auto persons =
      std::count_if(report_.filed.points.begin(), report_.filed.points.end(),
                    [](const auto& p) { return p.return_class == ReturnClass::kPerson; });
  EXPECT_EQ(persons, 1);
  EXPECT_TRUE(mapper_->ring().at(SlotOf(256), 1).self()) << "the one beside it is the vehicle";
}

TEST_F(ScanLoader, ClassesReturnsByTheirLabels) {
  AddRevolution(8, 0, kPacketsPerRevolution, 4000);
  const TextFile labels("ring,meas_id,label\n0,0,17\n1,0,19\n2,0,3\n3,0,0\n4,0,4\n");
  request_.labels_path = labels.path();
  const ReadOutcome outcome = Load();
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  EXPECT_EQ(report_.labelled_returns, 5);
  EXPECT_EQ(report_.filed.ignored_returns, 0);
  const PackedReturn person = mapper_->ring().at(SlotOf(0), 0);
  EXPECT_EQ(person.return_class(), ReturnClass::kPerson);
  EXPECT_EQ(mapper_->ring().at(SlotOf(0), 1).return_class(), ReturnClass::kSoft);
  // Void says nothing: what stands there is what geometry takes it for.
  EXPECT_EQ(mapper_->ring().at(SlotOf(0), 3).return_class(), ReturnClass::kHard);
  EXPECT_EQ(mapper_->ring().at(SlotOf(0), 4).return_class(), ReturnClass::kHard);
  EXPECT_TRUE(mapper_->heights().At(CellAt({4.0f, 0.0f})).person);
  EXPECT_TRUE(mapper_->ring().at(SlotOf(0), 0).labelled());
}

// A label file that has lost some of its lines must not make obstacles vanish.
TEST_F(ScanLoader, TakesWhatTheLabelsDoNotNameForHard) {
  AddRevolution(8, 0, kPacketsPerRevolution, 4000);
  const TextFile labels("ring,meas_id,label\n0,0,3\n");
  request_.labels_path = labels.path();
  ASSERT_TRUE(Load().ok());
  EXPECT_EQ(report_.labelled_returns, 1);
  EXPECT_EQ(mapper_->ring().at(SlotOf(100), 0).return_class(), ReturnClass::kHard);
  EXPECT_NE(mapper_->heights().At(CellAt({0.0f, -4.0f})).highest_hard_cm, HeightGrid::kNone);
}

TEST_F(ScanLoader, CountsReturnsOffTheGrid) {
  request_.perception.mount.max_range_m = 500.0f;
  AddRevolution(8, 0, kPacketsPerRevolution, 200000);
  ASSERT_TRUE(Load().ok());
  EXPECT_EQ(report_.filed.returns_off_grid, kColumns * kBeams);
}

TEST_F(ScanLoader, NamesTheFileOfWhatIsWrong) {
  AddRevolution(8, 0, kPacketsPerRevolution, 4000);
  request_.metadata_path = "/nowhere.json";
  EXPECT_EQ(Load().message, "/nowhere.json: cannot be opened (No such file or directory)");

  request_.metadata_path = metadata_.path();
  request_.labels_path = "/nowhere.csv";
  EXPECT_EQ(Load().message, "/nowhere.csv: cannot be opened (No such file or directory)");

  request_.labels_path = "";
  request_.pose.position.x_m = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(Load().status, Status::kNotFinite);
  request_.pose.position.x_m = 0.0f;
  request_.pose.roll_rad = std::numeric_limits<float>::infinity();
  EXPECT_EQ(Load().status, Status::kNotFinite);
  request_.pose.roll_rad = 0.0f;
  request_.perception.mapping.ageing_revolutions = 0;
  EXPECT_EQ(Load().message, "parameters: out of range");
}

TEST_F(ScanLoader, SaysWhenACaptureHoldsNoPacketOfTheSensor) {
  capture_.Add(Ethernet(Ipv4(Udp(Bytes(48)))));
  const ReadOutcome outcome = Load();
  EXPECT_EQ(outcome.status, Status::kWrongSensor);
  EXPECT_EQ(outcome.message, request_.capture_path +
                                 ": no lidar packet of this sensor (1 datagrams; expected 3392 "
                                 "bytes each)");
}

TEST_F(ScanLoader, LoadsTheRecordedScanWithItsLabels) {
  const std::string folder = test::DataFolder();
  if (folder.empty()) GTEST_SKIP() << "HARDPACK_DATA names no folder with rellis/";
  const std::string base = folder + "/rellis/rellis_000104_";
  request_.capture_path = base + "os1-64_2048x10_legacy_reencoded.pcap";
  request_.metadata_path = base + "os1-64_2048x10_legacy_reencoded.json";
  request_.labels_path = base + "labelled.csv";
  request_.perception.mount.z_m = 1.284f;
  // The box that holds what the data set leaves unlabelled around the sensor; the person standing
  // beside it begins at y = 2.0 m.
  request_.perception.mount.self_min_x_m = -1.95f;
  request_.perception.mount.self_max_x_m = -0.6f;
  request_.perception.mount.self_max_abs_y_m = 2.0005f;
  request_.perception.mount.self_max_z_m = 1.95f;
  const ReadOutcome outcome = LoadLidarScan(request_, *mapper_, report_);
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  EXPECT_EQ(report_.frame_id, 104);
  EXPECT_EQ(report_.packets, 128);
  EXPECT_EQ(report_.columns, 2048);
  EXPECT_EQ(report_.missing_columns, 0);
  EXPECT_EQ(report_.filed.returns, 77708);
  EXPECT_EQ(report_.labelled_returns, 77708);
  EXPECT_EQ(report_.filed.ignored_returns, 0) << "unlabelled returns that the box does not hold";
  int64_t person = 0;
  for (const ClassedPoint& point : report_.filed.points) {
    person += point.return_class == ReturnClass::kPerson ? 1 : 0;
  }
  EXPECT_GT(person, 1290);  // of 1310
}

}  // namespace
}  // namespace hardpack::capture
