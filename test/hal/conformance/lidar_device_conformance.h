// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <climits>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/scan/scan.h"
#include "hal/onboard/vehicle_loop/devices.h"

// What every LidarDevice has to do (hal/onboard/vehicle_loop/devices.h). A Harness has:
//
//   Device                     the type
//   config()                   of a sensor that sends
//   Datagram(k)                the k-th of its datagrams, from 0
//   kTellsRestarts, Restarted  whether a new start shows, and a datagram behind one

namespace hardpack {

template <typename Harness>
class LidarDeviceConformance : public testing::Test {
 protected:
  using Device = typename Harness::Device;
  static_assert(LidarDevice<Device>);

  void SetUp() override { ASSERT_EQ(device_->Configure(harness_.config()), Status::kOk); }

  Harness harness_;
  std::unique_ptr<Device> device_ = std::make_unique<Device>();
  std::unique_ptr<LidarColumn> column_ = std::make_unique<LidarColumn>();
};
TYPED_TEST_SUITE_P(LidarDeviceConformance);

TYPED_TEST_P(LidarDeviceConformance, SaysHowItIsMade) {
  using Device = typename TypeParam::Device;
  const auto config = this->harness_.config();
  const LidarLayout layout = Device::LayoutOf(config);
  EXPECT_GT(layout.altitude_deg.size(), 0u);
  EXPECT_EQ(layout.altitude_deg.size(), layout.azimuth_deg.size());
  EXPECT_GT(layout.window.columns_per_datagram, 0);
  EXPECT_LE(layout.window.columns_per_datagram, Device::kMaxColumns);
  EXPECT_GE(Device::MostColumnsPerSecond(config), layout.columns_per_revolution);
  const auto model = std::make_unique<BeamModel>();
  EXPECT_EQ(MakeBeamModel(layout, *model), Status::kOk);
}

TYPED_TEST_P(LidarDeviceConformance, DecodesEveryColumnOfItsDatagrams) {
  const LidarLayout layout = TypeParam::Device::LayoutOf(this->harness_.config());
  uint64_t newest_ns = 0;
  for (int k = 0; k < 30; ++k) {
    const std::vector<uint8_t> datagram = this->harness_.Datagram(k);
    ASSERT_EQ(this->device_->Check(datagram), Status::kOk) << k;
    ASSERT_EQ(this->device_->columns(), layout.window.columns_per_datagram);
    for (int i = 0; i < this->device_->columns(); ++i) {
      ASSERT_EQ(this->device_->Decode(datagram, i, *this->column_), Status::kOk);
      EXPECT_EQ(this->column_->beams, static_cast<int32_t>(layout.altitude_deg.size()));
      EXPECT_LT(this->column_->measurement_id, layout.columns_per_revolution);
      EXPECT_GE(this->column_->timestamp_ns, newest_ns);
      newest_ns = this->column_->timestamp_ns;
    }
  }
}

TYPED_TEST_P(LidarDeviceConformance, RefusesWhatIsNoDatagramOfItsOwn) {
  const std::vector<uint8_t> whole = this->harness_.Datagram(0);
  for (size_t size = 0; size < whole.size(); size += 1 + size / 40) {
    EXPECT_FALSE(IsUsable(this->device_->Check(std::span(whole).first(size)))) << size;
  }
  std::vector<uint8_t> longer = whole;
  longer.push_back(0);
  EXPECT_FALSE(IsUsable(this->device_->Check(longer)));
  EXPECT_FALSE(IsUsable(this->device_->Check(std::vector<uint8_t>(65507))));
  EXPECT_EQ(this->device_->Check(whole), Status::kOk);
}

TYPED_TEST_P(LidarDeviceConformance, HasNoColumnsButItsOwn) {
  const std::vector<uint8_t> datagram = this->harness_.Datagram(0);
  ASSERT_EQ(this->device_->Check(datagram), Status::kOk);
  for (const int index : {-1, this->device_->columns(), INT_MAX, INT_MIN}) {
    EXPECT_FALSE(IsUsable(this->device_->Decode(datagram, index, *this->column_))) << index;
  }
}

TYPED_TEST_P(LidarDeviceConformance, GoesOnAfterARestartOnlyWhenToldTo) {
  if (!TypeParam::kTellsRestarts) GTEST_SKIP() << "its datagrams do not tell";
  ASSERT_EQ(this->device_->Check(this->harness_.Datagram(0)), Status::kOk);
  for (int k = 1; k < 4; ++k) {
    EXPECT_EQ(this->device_->Check(this->harness_.Restarted(k)), Status::kSensorRestarted);
  }
  this->device_->Resume();
  EXPECT_EQ(this->device_->Check(this->harness_.Restarted(4)), Status::kOk);
}

// Its state is copied into a flight log, and goes on from there.
TYPED_TEST_P(LidarDeviceConformance, GoesOnFromACopy) {
  for (int k = 0; k < 5; ++k) {
    ASSERT_EQ(this->device_->Check(this->harness_.Datagram(k)), Status::kOk);
  }
  const auto copy = std::make_unique<typename TypeParam::Device>(*this->device_);
  for (const int k : {5, 4, 6}) {
    EXPECT_EQ(copy->Check(this->harness_.Datagram(k)),
              this->device_->Check(this->harness_.Datagram(k)));
  }
}

REGISTER_TYPED_TEST_SUITE_P(LidarDeviceConformance, SaysHowItIsMade,
                            DecodesEveryColumnOfItsDatagrams, RefusesWhatIsNoDatagramOfItsOwn,
                            HasNoColumnsButItsOwn, GoesOnAfterARestartOnlyWhenToldTo,
                            GoesOnFromACopy);

}  // namespace hardpack
