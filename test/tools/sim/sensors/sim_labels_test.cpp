// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/sensors/sim_labels.h"

#include <cmath>
#include <map>

#include "gtest/gtest.h"
#include "hal/labels/labels.h"
#include "tools/sim/world/named_worlds.h"

// The datagrams read with the library's own codec.

namespace hardpack::sim {
namespace {

constexpr int kColumns = 1024;

// One revolution's columns, cast in the forest.
std::vector<CastColumn> Truth() {
  world::Scenario forest;
  EXPECT_TRUE(world::MakeScenario("forest", 1, forest).ok());
  SimLidar lidar({}, 0);
  std::vector<std::vector<uint8_t>> packets;
  std::vector<CastColumn> truth;
  lidar.Advance(99'999'999, forest.start, forest.world, packets, &truth);
  EXPECT_EQ(truth.size(), size_t{kColumns});
  return truth;
}

struct Counts {
  int right = 0;
  int wrong = 0;
  int lost = 0;  // nothing came back, and something was named
};

Counts Compare(const std::vector<CastColumn>& truth,
               const std::vector<std::vector<uint8_t>>& datagrams) {
  Counts counts;
  std::map<uint16_t, const CastColumn*> by_id;
  for (const CastColumn& column : truth) by_id[column.measurement_id] = &column;
  for (const std::vector<uint8_t>& datagram : datagrams) {
    labels::Header header;
    EXPECT_EQ(labels::CheckDatagram(datagram, 64, kColumns, header), hardpack::Status::kOk);
    for (int i = 0; i < header.columns; ++i) {
      ColumnLabels said;
      EXPECT_EQ(labels::DecodeColumn(header, datagram, i, said), hardpack::Status::kOk);
      const CastColumn& column = *by_id.at(said.measurement_id);
      EXPECT_EQ(said.frame_id, column.frame_id);
      for (size_t beam = 0; beam < 64; ++beam) {
        if (column.labels[beam] == 0) {
          counts.lost += said.label[beam] != 0 ? 1 : 0;
        } else {
          ++(said.label[beam] == column.labels[beam] ? counts.right : counts.wrong);
        }
      }
    }
  }
  return counts;
}

TEST(SimLabels, AreRightAsOftenAsTold) {
  const std::vector<CastColumn> truth = Truth();
  for (const double accuracy : {1.0, 0.9, 0.5, 0.0}) {
    LabelSettings settings;
    settings.accuracy = accuracy;
    SimLabels labels(settings);
    std::vector<std::vector<uint8_t>> datagrams;
    labels.Advance(1'000'000'000, truth, datagrams);
    ASSERT_EQ(datagrams.size(), size_t{kColumns / 16});
    const Counts counts = Compare(truth, datagrams);
    const int returns = counts.right + counts.wrong;
    ASSERT_GT(returns, 20'000);
    EXPECT_EQ(counts.lost, 0);
    EXPECT_NEAR(static_cast<double>(counts.right) / returns, accuracy,
                4.0 * std::sqrt(accuracy * (1.0 - accuracy) / returns));
  }
}

TEST(SimLabels, ComeWhenTheDelayIsOver) {
  const std::vector<CastColumn> truth = Truth();
  LabelSettings settings;
  settings.delay_s = 0.1;
  SimLabels labels(settings);
  std::vector<std::vector<uint8_t>> datagrams;
  const uint64_t first_ns = truth[15].time_ns + 100'000'000;
  labels.Advance(first_ns - 1, truth, datagrams);
  EXPECT_TRUE(datagrams.empty());
  labels.Advance(first_ns, {}, datagrams);
  ASSERT_EQ(datagrams.size(), 1u);
  labels::Header header;
  ASSERT_EQ(labels::CheckDatagram(datagrams[0], 64, kColumns, header), hardpack::Status::kOk);
  EXPECT_EQ(header.first_measurement, 0);
  EXPECT_EQ(header.columns, 16);
  EXPECT_EQ(header.timestamp_ns, truth[0].lidar_time_ns);
  labels.Advance(truth.back().time_ns + 100'000'000, {}, datagrams);
  EXPECT_EQ(datagrams.size(), size_t{kColumns / 16});
}

TEST(SimLabels, EndADatagramWithTheLidarsFrame) {
  std::vector<CastColumn> truth = Truth();
  truth.erase(truth.begin(), truth.begin() + kColumns - 5);
  CastColumn next = truth.back();
  next.frame_id = 1;
  next.measurement_id = 0;
  truth.push_back(next);
  SimLabels labels(LabelSettings{});
  std::vector<std::vector<uint8_t>> datagrams;
  labels.Advance(1'000'000'000, truth, datagrams);
  ASSERT_EQ(datagrams.size(), 1u) << "the second one is not full";
  labels::Header header;
  ASSERT_EQ(labels::CheckDatagram(datagrams[0], 64, kColumns, header), hardpack::Status::kOk);
  EXPECT_EQ(header.columns, 5);
}

}  // namespace
}  // namespace hardpack::sim
