// SPDX-License-Identifier: Apache-2.0
// How far a lidar is sure to meet what is low: by its beams one by one, and on the segmenter.
#include "core/autonomy/assured_sight.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <memory>
#include <vector>

#include "core/scan/scan.h"
#include "core/segmentation/segmentation.h"
#include "core/speed/speed.h"

namespace hardpack {
namespace {

constexpr float kSensor_m = 1.32f;

BeamModel EvenBeams(int beams, int columns = 1024) {
  std::vector<float> altitude_deg;
  for (int i = 0; i < beams; ++i) {
    altitude_deg.push_back(16.6f - 33.2f * static_cast<float>(i) / static_cast<float>(beams - 1));
  }
  const std::vector<float> azimuth_deg(static_cast<size_t>(beams), 0.0f);
  BeamModel model;
  EXPECT_EQ(MakeBeamModel(altitude_deg, azimuth_deg, columns, 0.012f, Transform3{}, model),
            Status::kOk);
  return model;
}

// By definition: whether some beam ends on the part from band to height.
bool IsMet(int beams, double pitch_rad, double distance_m, double band_m, double height_m) {
  for (int i = 0; i < beams; ++i) {
    const double slope = std::tan((-16.6 + 33.2 * i / (beams - 1)) * M_PI / 180.0 + pitch_rad);
    const double z_m = double{kSensor_m} + slope * distance_m;
    if (z_m > band_m && z_m <= height_m) return true;
  }
  return false;
}

// SR-LOW02 the speed keeps within the sight that the beams assure.
TEST(AssuredSight, EveryThingNearerIsMetAndNotEveryOneBeyond) {
  for (const int beams : {32, 64, 128}) {
    const BeamModel model = EvenBeams(beams);
    for (const double height_m : {0.15, 0.2, 0.3}) {
      for (const double band_m : {0.0, 0.08, 0.1}) {
        const double sight_m = double{AssuredSight_m(model, kSensor_m, static_cast<float>(band_m),
                                                     static_cast<float>(height_m))};
        if (sight_m == 0.0) continue;
        SCOPED_TRACE(::testing::Message() << beams << " beams, " << band_m << " to " << height_m
                                          << " m: " << sight_m << " m");
        bool is_missed_beyond = false;
        for (double pitch_rad = -0.02; pitch_rad <= 0.02; pitch_rad += 0.0005) {
          // The lowest beam comes down to the height here. The beams' spacing differs by a little.
          const double near_m =
              (double{kSensor_m} - height_m) / std::tan(16.6 * M_PI / 180.0 - pitch_rad);
          for (double d_m = near_m + 0.01; d_m < 0.98 * sight_m; d_m += 0.02) {
            ASSERT_TRUE(IsMet(beams, pitch_rad, d_m, band_m, height_m)) << d_m;
          }
          is_missed_beyond =
              is_missed_beyond || !IsMet(beams, pitch_rad, 1.1 * sight_m, band_m, height_m);
        }
        EXPECT_TRUE(is_missed_beyond);
      }
    }
  }
}

TEST(AssuredSight, NothingComesOfHeightsOrBeamsThatMakeNoSense) {
  const BeamModel model = EvenBeams(64);
  EXPECT_EQ(AssuredSight_m(BeamModel{}, kSensor_m, 0.08f, 0.2f), 0.0f);
  EXPECT_EQ(AssuredSight_m(model, kSensor_m, 0.2f, 0.2f), 0.0f);
  EXPECT_EQ(AssuredSight_m(model, 0.1f, 0.08f, 0.2f), 0.0f);
  EXPECT_EQ(AssuredSight_m(model, kSensor_m, -0.1f, 0.2f), 0.0f);
  EXPECT_EQ(FirmSight_m(BeamModel{}, 0.32f), 0.0f);
  EXPECT_EQ(FirmSight_m(model, 0.0f), 0.0f);
  EXPECT_EQ(FirmSight_m(model, -1.0f), 0.0f);
  EXPECT_EQ(FirmSight_m(model, NAN), 0.0f);
  EXPECT_EQ(FirmSight_m(model, INFINITY), kMostSight_m);
}

// The vehicle stops before what it meets; with 64 beams at 5 m/s, with 32 more slowly.
// SR-LOW02
TEST(AssuredSight, TheSpeedStopsWithinIt) {
  const VehicleParams vehicle;
  const SpeedParams speed;
  const PerceptionParams perception;
  float before_mps = 0.0f;
  for (const int beams : {16, 32, 64, 128}) {
    const BeamModel model = EvenBeams(beams);
    const float assured_mps = AssuredSpeed_mps(model, perception, vehicle, speed);
    const float sight_m = AssuredSight_m(model, SensorHeight_m(model, perception.mount),
                                         perception.segmentation.ground_band_m, 0.2f);
    EXPECT_LE(StoppingDistance(speed, assured_mps) + 0.5f * vehicle.length_m +
                  (assured_mps > 0.0f ? speed.unseen_margin_m : 0.0f),
              Max(sight_m, 0.5f * vehicle.length_m));
    EXPECT_GE(assured_mps, before_mps);
    before_mps = assured_mps;
  }
  EXPECT_GT(AssuredSpeed_mps(EvenBeams(64), perception, vehicle, speed), 4.9f);
  EXPECT_LT(AssuredSpeed_mps(EvenBeams(32), perception, vehicle, speed), 3.0f);
  // With half the columns the same beams tell what is narrow half as far away.
  const float coarse_mps = AssuredSpeed_mps(EvenBeams(64, 512), perception, vehicle, speed);
  EXPECT_LT(coarse_mps, 3.2f);
  EXPECT_LE(StoppingDistance(speed, coarse_mps) + 0.5f * vehicle.length_m + speed.unseen_margin_m,
            FirmSight_m(EvenBeams(64, 512), speed.assured_width_m));
}

// SR-LOW02
TEST(AssuredSight, LowersTheLimitsOrRefuses) {
  SpeedParams speed;
  EXPECT_EQ(LimitToAssuredSight(EvenBeams(32), {}, {}, speed), Status::kOk);
  EXPECT_LT(speed.max_speed_mps, 3.0f);
  EXPECT_LE(speed.min_speed_mps, speed.max_speed_mps);
  EXPECT_LE(speed.person_creep_mps, speed.min_speed_mps);
  // Of 16 beams the two lowest are further apart than the thing is high before they come down to
  // it.
  SpeedParams refused;
  EXPECT_EQ(LimitToAssuredSight(EvenBeams(16), {}, {}, refused), Status::kParameterOutOfRange);
  refused.refuse_unassured = 0;
  EXPECT_EQ(LimitToAssuredSight(EvenBeams(16), {}, {}, refused), Status::kOk);
  EXPECT_EQ(refused.max_speed_mps, SpeedParams{}.person_creep_mps);
}

// A thing on level ground, seen by the segmenter with all beams of one pitch.
struct Thing {
  double distance_m = 0.0;
  double aside_m = 0.0;  // of its middle, to the left
  double width_m = 0.0;
  double height_m = 0.0;
};

DirectionView LookAt(const Thing& thing, double azimuth_rad, int beams) {
  const double side_m = std::tan(azimuth_rad) * thing.distance_m;
  DirectionView view;
  view.beams = beams;
  view.sensor_height_m = kSensor_m;
  for (int beam = 0; beam < beams; ++beam) {
    const double slope = std::tan((-16.6 + 33.2 * beam / (beams - 1)) * M_PI / 180.0);
    view.slope[beam] = static_cast<float>(slope);
    const double ground_m = slope < 0.0 ? double{kSensor_m} / -slope : 1.0e9;
    const double z_m = double{kSensor_m} + slope * thing.distance_m;
    const bool on_it = std::abs(side_m - thing.aside_m) < thing.width_m / 2.0 && z_m > 0.0 &&
                       z_m <= thing.height_m;
    const double level_m = on_it ? thing.distance_m : ground_m;
    if (level_m > 100.0) continue;
    view.seen[beam] = true;
    view.level_m[beam] = static_cast<float>(level_m);
    view.height_m[beam] = static_cast<float>(double{kSensor_m} + slope * level_m);
    view.range_m[beam] = static_cast<float>(level_m * std::sqrt(1.0 + slope * slope));
  }
  return view;
}

// Of the returns of one scan: those that stand and are firm. left_out: before this column, counted
// from straight ahead, a place has none.
int StandingFirm(const Thing& thing, int beams, int columns, int left_out = INT_MAX) {
  constexpr int kDirections = 41;
  auto segmenter = std::make_unique<Segmenter>();
  EXPECT_EQ(segmenter->Configure(SegmentationParams{}, beams), Status::kOk);
  int standing = 0;
  for (int direction = 0; direction < kDirections + Segmenter::kLag; ++direction) {
    const int place = direction - kDirections / 2;
    const int column = place > left_out ? place - 1 : place;
    DirectionView view = LookAt(thing, column * 2.0 * M_PI / columns, beams);
    if (place == left_out) std::fill_n(view.seen, beams, false);
    EXPECT_EQ(segmenter->Push(view), Status::kOk);
    if (!segmenter->ready()) continue;
    const DirectionClasses& classes = segmenter->result();
    for (int beam = 0; beam < beams; ++beam) {
      const bool stands = classes.what[beam] == ReturnClass::kHard && classes.ground_known[beam];
      standing += stands && segmenter->IsFirm(beam) ? 1 : 0;
    }
  }
  return standing;
}

// One beam on what is above the tolerated part is enough for the segmenter itself: a thing of 0.2 m
// and twice as wide as it is high, everywhere from where the lowest beam meets it to the end of the
// sight.
// SR-LOW02
TEST(AssuredSight, WhatIsMetIsClassedAsStanding) {
  constexpr int kBeams = 64;
  const float band_m = SegmentationParams{}.ground_band_m;
  const double sight_m = double{AssuredSight_m(EvenBeams(kBeams), kSensor_m, band_m, 0.2f)};
  for (double d_m = 5.0; d_m < sight_m; d_m += 0.05) {
    EXPECT_GE(StandingFirm({d_m, 0.0, 0.4, 0.2}, kBeams, 1024), 2) << "at " << d_m << " m";
  }
}

// And the columns: a thing as wide as is assured is firm wherever it lies between the columns up to
// the end of the sight, and somewhere between them it is not, a little further away.
// SR-LOW02
TEST(AssuredSight, WhatIsAsWideAsIsAssuredIsFirm) {
  constexpr int kBeams = 32;  // of which one to three meet it: too few for an upright line
  constexpr int kPlaces = 10;
  for (const int columns : {512, 1024}) {
    const double sight_m = double{FirmSight_m(EvenBeams(kBeams, columns), 0.24f)};
    const auto least = [&](double d_m) {
      int standing = kMaxBeams;
      for (int place = 0; place < kPlaces; ++place) {
        const double aside_m = d_m * 2.0 * M_PI / columns * place / kPlaces;
        standing = std::min(standing, StandingFirm({d_m, aside_m, 0.24, 0.3}, kBeams, columns));
      }
      return standing;
    };
    for (const double share : {0.92, 0.96, 0.995}) {
      EXPECT_GE(least(share * sight_m), 2) << columns << " columns, " << share * sight_m << " m";
    }
    EXPECT_EQ(least(1.1 * sight_m), 0) << columns << " columns";
  }
}

// The same of a sensor that leaves places out, wherever one is.
// SR-LOW02
TEST(AssuredSight, WhatIsAsWideAsIsAssuredIsFirmWithAPlaceLeftOut) {
  constexpr int kBeams = 32;
  constexpr int kFired = 994;
  constexpr int kPlaces = 10;
  BeamModel model = EvenBeams(kBeams);
  const float all_m = FirmSight_m(model, 0.24f);
  model.fired_per_revolution = kFired;
  const double sight_m = double{FirmSight_m(model, 0.24f)};
  EXPECT_LT(sight_m, 0.79 * double{all_m});
  const auto least = [&](double d_m) {
    int standing = kMaxBeams;
    for (int place = 0; place < kPlaces; ++place) {
      const double aside_m = d_m * 2.0 * M_PI / kFired * place / kPlaces;
      for (int left_out = -5; left_out <= 6; ++left_out) {
        const Thing thing = {d_m, aside_m, 0.24, 0.3};
        standing = std::min(standing, StandingFirm(thing, kBeams, kFired, left_out));
      }
    }
    return standing;
  };
  for (const double share : {0.92, 0.96, 0.995}) EXPECT_GE(least(share * sight_m), 1) << share;
  EXPECT_EQ(least(double{all_m} * 0.96), 0) << "with four columns";
}

}  // namespace
}  // namespace hardpack
