// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hal/onboard/vehicle_loop/devices.h"

// What every InsDevice has to do (hal/onboard/vehicle_loop/devices.h). A Harness has:
//
//   Device      the type
//   Message(k)  the bytes of the k-th message, which has a stamp that grows with k

namespace hardpack {

template <typename Harness>
class InsDeviceConformance : public testing::Test {
 protected:
  using Device = typename Harness::Device;
  static_assert(InsDevice<Device>);
  static constexpr int kLooks = 1000;

  // The stamps of all samples that these bytes come to.
  std::vector<uint64_t> StampsOf(std::span<const uint8_t> bytes) {
    std::vector<uint64_t> stamps;
    InsSample sample;
    for (int feed = 0; feed < 1000 && !bytes.empty(); ++feed) {
      bytes = bytes.subspan(device_->Feed(bytes));
      while (IsUsable(device_->Next(sample))) stamps.push_back(sample.timestamp_ns);
    }
    EXPECT_TRUE(bytes.empty());
    return stamps;
  }
  std::vector<uint8_t> Messages(int first, int count) {
    std::vector<uint8_t> bytes;
    for (int k = first; k < first + count; ++k) {
      const std::vector<uint8_t> message = harness_.Message(k);
      bytes.insert(bytes.end(), message.begin(), message.end());
    }
    return bytes;
  }
  void SetUp() override { device_->BeginTick(kLooks); }

  Harness harness_;
  std::unique_ptr<Device> device_ = std::make_unique<Device>();
};
TYPED_TEST_SUITE_P(InsDeviceConformance);

TYPED_TEST_P(InsDeviceConformance, TellsEachMessageOnceInOrder) {
  const std::vector<uint64_t> stamps = this->StampsOf(this->Messages(0, 20));
  ASSERT_EQ(stamps.size(), 20u);
  for (size_t i = 1; i < stamps.size(); ++i) EXPECT_GT(stamps[i], stamps[i - 1]);
  InsSample sample;
  EXPECT_FALSE(IsUsable(this->device_->Next(sample)));
}

TYPED_TEST_P(InsDeviceConformance, LooksAtNoMoreThanATickAllows) {
  this->device_->BeginTick(3);
  const std::vector<uint8_t> bytes = this->Messages(0, 5);
  ASSERT_EQ(this->device_->Feed(bytes), bytes.size());
  InsSample sample;
  int told = 0;
  while (IsUsable(this->device_->Next(sample))) ++told;
  EXPECT_LE(told, 3);
  this->device_->BeginTick(this->kLooks);
  while (IsUsable(this->device_->Next(sample))) ++told;
  EXPECT_EQ(told, 5);
}

TYPED_TEST_P(InsDeviceConformance, NoiseIsNoMessage) {
  std::vector<uint8_t> noise(5000);
  uint32_t state = 1;
  for (uint8_t& byte : noise) {
    state = state * 1664525u + 1013904223u;
    byte = static_cast<uint8_t>(state >> 24);
  }
  EXPECT_TRUE(this->StampsOf(noise).empty());
}

TYPED_TEST_P(InsDeviceConformance, ForgetsHalfAMessage) {
  const std::vector<uint8_t> message = this->harness_.Message(0);
  static_cast<void>(this->StampsOf(std::span(message).first(message.size() / 2)));
  this->device_->Reset();
  this->device_->BeginTick(this->kLooks);
  EXPECT_EQ(this->StampsOf(this->Messages(1, 2)).size(), 2u);
}

REGISTER_TYPED_TEST_SUITE_P(InsDeviceConformance, TellsEachMessageOnceInOrder,
                            LooksAtNoMoreThanATickAllows, NoiseIsNoMessage, ForgetsHalfAMessage);

}  // namespace hardpack
