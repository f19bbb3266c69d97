// SPDX-License-Identifier: Apache-2.0
#include "core/scan/sight_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "core/scan/scan.h"

namespace hardpack {
namespace {

constexpr int kWatchedBeams = 64;
constexpr int kPacketColumns = 16;
constexpr double kHeight_m = 1.284;
constexpr double kPi_rad = 3.14159265358979;

// A lidar on a vehicle on level ground, column by column, with noise.
class Lidar {
 public:
  explicit Lidar(const SafetyParams& safety = {}, int columns = 1024, int revolutions_per_s = 10)
      : columns_(columns),
        step_ns_(1'000'000'000u / static_cast<uint64_t>(columns) /
                 static_cast<uint64_t>(revolutions_per_s)) {
    std::vector<float> altitude;
    for (int beam = 0; beam < kWatchedBeams; ++beam) {
      altitude.push_back(16.6f - 33.2f * static_cast<float>(beam) / (kWatchedBeams - 1));
    }
    const std::vector<float> azimuth(kWatchedBeams, 0.0f);
    Transform3 half_turn;
    half_turn.rotation[0] = half_turn.rotation[4] = -1.0f;
    EXPECT_EQ(MakeBeamModel(altitude, azimuth, columns, 0.0f, half_turn, *model), Status::kOk);
    for (int beam = 0; beam < kWatchedBeams; ++beam) {
      const double fall =
          -std::sin(static_cast<double>(altitude[static_cast<size_t>(beam)]) * kPi_rad / 180.0);
      ground_mm[beam] = fall > 0.012 ? static_cast<uint32_t>(1000.0 * kHeight_m / fall) : 0u;
    }
    EXPECT_EQ(watch->Configure({}, safety, *model, kPacketColumns, 0, columns - 1), Status::kOk);
    Know(kHeight_m / 10.0);
    column->beams = kWatchedBeams;
    column->valid = true;
  }

  uint32_t Draw(uint32_t below) { return static_cast<uint32_t>(random() % below); }

  // Degrees from ahead, anticlockwise, of a column.
  double Angle_deg(int id) const {
    const double deg = 180.0 - 360.0 * id / columns_;
    return deg;
  }

  // How little a beam may fall that meets something the map knows, all around.
  void Know(double least_fall) {
    for (int sector = 0; sector < watch->sectors(); ++sector) {
      watch->ExpectKnown(sector, static_cast<float>(least_fall), *model);
    }
  }

  // One revolution; `says` may change a column, and says whether it comes.
  template <typename Says>
  void Revolution(Says&& says) {
    for (int id = 0; id < columns_; ++id) {
      now_ns += step_ns_;
      column->measurement_id = static_cast<uint16_t>(id);
      column->frame_id = frame_id;
      for (int beam = 0; beam < kWatchedBeams; ++beam) {
        const uint32_t range_mm = ground_mm[beam];
        column->range_mm[beam] = range_mm == 0 ? 0 : range_mm + Draw(13u);
      }
      if (says(id, *column)) watch->Take(*column, now_ns);
    }
    ++frame_id;
  }
  void Revolutions(int count) {
    for (int i = 0; i < count; ++i) {
      Revolution([](int, const LidarColumn&) { return true; });
    }
  }

  // Ahead over the vehicle's width, from its front to 12 m.
  SightLook Ahead() const {
    SightLook look;
    for (const float x_m : {0.76f, 2.0f, 4.0f, 8.0f, 12.0f}) {
      watch->LookBetween({x_m, -0.74f}, {x_m, 0.74f}, now_ns, look);
    }
    return look;
  }
  double AgeAhead_s() const { return Age_s(Ahead()); }
  double Age_s(const SightLook& look) const {
    return look.time_ns == 0 ? 1.0e9 : static_cast<double>(now_ns - look.time_ns) * 1.0e-9;
  }

  std::unique_ptr<BeamModel> model = std::make_unique<BeamModel>();
  std::unique_ptr<SightWatch> watch = std::make_unique<SightWatch>();
  std::unique_ptr<LidarColumn> column = std::make_unique<LidarColumn>();
  uint32_t ground_mm[kWatchedBeams] = {};
  uint64_t now_ns = 5'000'000'000;
  uint16_t frame_id = 65'530;
  std::minstd_rand random{7};

 private:
  int columns_;
  uint64_t step_ns_;
};

bool IsAhead(double angle_deg, double half_deg) {
  return std::fabs(angle_deg) <= half_deg;
}

// SR-SEE01: what was never looked along is infinitely old.
TEST(SightWatch, NeverLookedIsInfinite) {
  Lidar lidar;
  EXPECT_EQ(lidar.Ahead().time_ns, 0u);
  lidar.Revolution([&](int id, const LidarColumn&) { return !IsAhead(lidar.Angle_deg(id), 46.0); });
  EXPECT_EQ(lidar.Ahead().time_ns, 0u);
  EXPECT_EQ(lidar.Ahead().cause, SightCause::kSilent);
  SightLook behind;
  lidar.watch->LookBetween({-2.0f, 0.7f}, {-2.0f, -0.7f}, lidar.now_ns, behind);
  EXPECT_NE(behind.time_ns, 0u);
  EXPECT_NE(lidar.watch->newest_ns(), 0u);
}

TEST(SightWatch, LooksOfWholeRevolutionsAreFresh) {
  for (const int columns : {512, 1024, 2048}) {
    Lidar lidar({}, columns);
    for (int i = 0; i < 20; ++i) {
      lidar.Revolutions(1);
      EXPECT_LT(lidar.AgeAhead_s(), 0.101) << columns;
    }
    SightLook around;
    lidar.watch->LookAround(lidar.now_ns, around);
    EXPECT_LT(lidar.Age_s(around), 0.101);
    EXPECT_NEAR(static_cast<double>(lidar.watch->revolution_ns()), 1.0e8, 2.0e5);
    EXPECT_EQ(lidar.watch->OldSectors(lidar.now_ns, 0.42f), 0);
    EXPECT_EQ(lidar.watch->covered_sectors() + lidar.watch->frozen_sectors(), 0);
    for (int part = 0; part < SightWatch::kShown; ++part) {
      const SightWatch::Shares shares = lidar.watch->SharesOf(part, lidar.now_ns);
      EXPECT_EQ(shares.columns_permille, 1000);
      EXPECT_EQ(shares.returns_permille, 1000);
      EXPECT_EQ(shares.cause, SightCause::kNone);
    }
  }
}

// SR-SEE01: columns that are lost over the way are seen to be within the limit and a revolution.
TEST(SightWatch, ASectorThatIsLostGrowsOld) {
  Lidar lidar;
  lidar.Revolutions(5);
  for (int i = 1; i <= 5; ++i) {
    lidar.Revolution(
        [&](int id, const LidarColumn&) { return !IsAhead(lidar.Angle_deg(id), 46.0); });
    EXPECT_GT(lidar.AgeAhead_s(), 0.1 * i);
  }
  EXPECT_EQ(lidar.Ahead().cause, SightCause::kSilent);
  EXPECT_GE(lidar.watch->OldSectors(lidar.now_ns, 0.42f), 14);
  EXPECT_EQ(lidar.watch->SharesOf(7, lidar.now_ns).columns_permille, 0);
  EXPECT_EQ(lidar.watch->SharesOf(0, lidar.now_ns).columns_permille, 1000);
}

// A sector hidden for good is told too, at twice the limit, however narrow.
TEST(SightWatch, ASinglePacketThatNeverComesGrowsOld) {
  Lidar lidar;
  lidar.Revolutions(5);
  double worst_s = 0.0;
  for (int i = 1; i <= 10; ++i) {
    lidar.Revolution([&](int id, const LidarColumn&) { return id / kPacketColumns != 32; });
    worst_s = std::max(worst_s, lidar.AgeAhead_s());
    if (i == 4) {
      EXPECT_LT(worst_s, 0.42);
    }
  }
  EXPECT_GT(worst_s, 0.42);
}

// SR-SEE02: no false stop: one packet in ten lost, and a whole revolution besides, are no
// blindness.
TEST(SightWatch, APacketInTenAndARevolutionLostAreNoBlindness) {
  Lidar lidar;
  lidar.Revolutions(5);
  double worst_s = 0.0;
  bool comes = true;
  for (int turn = 0; turn < 3000; ++turn) {
    lidar.Revolution([&](int id, const LidarColumn&) {
      if (id % kPacketColumns == 0) comes = lidar.Draw(10u) != 0u && turn % 500 != 250;
      return comes;
    });
    worst_s = std::max(worst_s, lidar.AgeAhead_s());
  }
  EXPECT_LE(worst_s, 0.42);
  EXPECT_GT(worst_s, 0.15) << "something was lost";
}

// SR-SEE02: beams towards the sky are the same for ever, and no sign of anything.
TEST(SightWatch, OpenSkyAndRainAreNoBlindness) {
  Lidar lidar;
  lidar.Revolutions(3);
  for (int turn = 0; turn < 200; ++turn) {
    lidar.Revolution([&](int, LidarColumn& column) {
      for (int beam = 0; beam < kWatchedBeams; ++beam) {
        const unsigned drawn = lidar.Draw(100u);
        if (drawn < 35) column.range_mm[beam] = 0;                         // wet ground
        if (drawn >= 90) column.range_mm[beam] = 700 + lidar.Draw(8000u);  // drops
        if (drawn == 89) column.range_mm[beam] = 200;                      // on the window
      }
      return true;
    });
    ASSERT_LT(lidar.AgeAhead_s(), 0.11);
  }
  EXPECT_EQ(lidar.watch->covered_sectors() + lidar.watch->frozen_sectors(), 0);
}

// SR-SEE03: a window that is covered, by what swallows light or by what reflects it, is no look.
TEST(SightWatch, ACoveredWindowIsNoLook) {
  for (const uint32_t range_mm : {0u, 90u}) {
    Lidar lidar;
    lidar.Revolutions(5);
    for (int turn = 0; turn < 5; ++turn) {
      lidar.Revolution([&](int id, LidarColumn& column) {
        if (!IsAhead(lidar.Angle_deg(id), 46.0)) return true;
        for (uint32_t& range : column.range_mm) range = range_mm == 0 ? 0 : 60 + lidar.Draw(9u);
        return true;
      });
    }
    EXPECT_GT(lidar.AgeAhead_s(), 0.5);
    EXPECT_EQ(lidar.Ahead().cause, range_mm == 0 ? SightCause::kEmpty : SightCause::kCovered);
    EXPECT_EQ(lidar.watch->covered_sectors() > 0, range_mm != 0);
    EXPECT_LT(lidar.watch->SharesOf(8, lidar.now_ns).returns_permille, 100);
  }
}

constexpr double kNothing = 1.0e6;

void NothingAhead(Lidar& lidar, int revolutions) {
  for (int turn = 0; turn < revolutions; ++turn) {
    lidar.Revolution([&](int id, LidarColumn& column) {
      if (!IsAhead(lidar.Angle_deg(id), 46.0)) return true;
      for (uint32_t& range : column.range_mm) range = 0;
      return true;
    });
  }
}

// SR-SEE02: before a crest the map knows of nothing that a beam should meet: none is missing.
TEST(SightWatch, WhereNothingIsKnownNothingIsMissing) {
  Lidar lidar;
  lidar.Revolutions(3);
  lidar.Know(kNothing);
  NothingAhead(lidar, 10);
  EXPECT_LT(lidar.AgeAhead_s(), 0.11);
  EXPECT_EQ(lidar.watch->OldSectors(lidar.now_ns, 0.42f), 0);
  EXPECT_EQ(lidar.watch->SharesOf(8, lidar.now_ns).cause, SightCause::kNone);
}

// SR-SEE03: but only as long as what was known last came; a window covered before anything came
// from there proves nothing, and neither does one that was seen to be covered.
TEST(SightWatch, AWindowThatWasCoveredIsNoLookUntilSomethingComes) {
  Lidar lidar;
  lidar.Know(kNothing);
  NothingAhead(lidar, 10);
  EXPECT_EQ(lidar.Ahead().time_ns, 0u);
  lidar.Revolutions(2);
  EXPECT_LT(lidar.AgeAhead_s(), 0.11);
  NothingAhead(lidar, 3);
  EXPECT_LT(lidar.AgeAhead_s(), 0.11);
  lidar.Know(kHeight_m / 10.0);
  NothingAhead(lidar, 3);
  EXPECT_GT(lidar.AgeAhead_s(), 0.3);
  lidar.Know(kNothing);
  NothingAhead(lidar, 3);
  EXPECT_GT(lidar.AgeAhead_s(), 0.6);
  EXPECT_EQ(lidar.Ahead().cause, SightCause::kEmpty);
  EXPECT_LT(lidar.watch->SharesOf(8, lidar.now_ns).returns_permille, 100);
}

// Ground that is known as far as 5 m: two of the beams that should meet it are a look, two others
// are not.
TEST(SightWatch, ExpectsTheBeamsThatFallToWhatIsKnown) {
  for (const bool are_known : {true, false}) {
    Lidar lidar;
    lidar.Revolutions(3);
    lidar.Know(kHeight_m / 5.0);
    const int first = are_known ? kWatchedBeams - 2 : kWatchedBeams - 12;
    for (int turn = 0; turn < 10; ++turn) {
      lidar.Revolution([&](int id, LidarColumn& column) {
        if (!IsAhead(lidar.Angle_deg(id), 46.0)) return true;
        for (int beam = 0; beam < kWatchedBeams; ++beam) {
          if (beam != first && beam != first + 1) column.range_mm[beam] = 0;
        }
        return true;
      });
    }
    EXPECT_EQ(lidar.AgeAhead_s() < 0.11, are_known);
    EXPECT_EQ(lidar.watch->SharesOf(8, lidar.now_ns).returns_permille > 200, are_known);
  }
}

// SR-SEE03: a cover that is not ahead is told all the same.
TEST(SightWatch, ACoveredSideIsAFaultUnlessItIsMasked) {
  for (const bool is_masked : {false, true}) {
    SafetyParams safety;
    if (is_masked) {
      safety.sight_mask_from_rad = 1.2f;
      safety.sight_mask_to_rad = 2.0f;
    }
    Lidar lidar(safety);
    for (int turn = 0; turn < 8; ++turn) {
      lidar.Revolution([&](int id, LidarColumn& column) {
        if (std::fabs(lidar.Angle_deg(id) - 90.0) > 20.0) return true;
        for (uint32_t& range : column.range_mm) range = 60 + lidar.Draw(9u);
        return true;
      });
    }
    SightLook look;
    lidar.watch->LookAtFaults(look);
    if (is_masked) {
      EXPECT_EQ(look.time_ns, UINT64_MAX);
      EXPECT_EQ(lidar.watch->OldSectors(lidar.now_ns, 0.42f), 0);
    } else {
      EXPECT_GT(lidar.Age_s(look), 0.42);
      EXPECT_EQ(look.cause, SightCause::kCovered);
    }
    EXPECT_LT(lidar.AgeAhead_s(), 0.11);
  }
}

// SR-SEE04: an image that comes again, the last one or the last two by turns, is no look.
TEST(SightWatch, AFrozenImageIsNoLook) {
  for (const int images : {1, 2}) {
    Lidar lidar;
    lidar.Revolutions(5);
    std::vector<std::vector<LidarColumn>> image(2);
    for (int i = 0; i < 2; ++i) {
      lidar.Revolution([&](int, const LidarColumn& column) {
        image[static_cast<size_t>(i)].push_back(column);
        return true;
      });
    }
    for (int turn = 0; turn < 6; ++turn) {
      const auto shown = static_cast<size_t>(images == 1 ? 1 : turn % 2);
      lidar.Revolution([&](int id, LidarColumn& column) {
        const LidarColumn& old = image[shown][static_cast<size_t>(id)];
        std::copy(std::begin(old.range_mm), std::end(old.range_mm), std::begin(column.range_mm));
        return true;
      });
    }
    EXPECT_GT(lidar.AgeAhead_s(), 0.6) << images;
    EXPECT_EQ(lidar.Ahead().cause, SightCause::kFrozen);
    EXPECT_EQ(lidar.watch->frozen_sectors(), lidar.watch->sectors());
    lidar.Revolutions(2);
    EXPECT_LT(lidar.AgeAhead_s(), 0.11);
    EXPECT_EQ(lidar.watch->frozen_sectors(), 0);
  }
}

// An encoder or a buffer that stands still: one column for all.
// SR-SEE04
TEST(SightWatch, TheSameColumnAllAroundIsNoLook) {
  Lidar lidar;
  lidar.Revolutions(5);
  for (int turn = 0; turn < 6; ++turn) {
    lidar.Revolution([&](int, LidarColumn& column) {
      for (int beam = 0; beam < kWatchedBeams; ++beam) {
        column.range_mm[beam] = lidar.ground_mm[beam] + static_cast<uint32_t>(turn);
      }
      return true;
    });
  }
  EXPECT_GT(lidar.AgeAhead_s(), 0.5);
}

// Every direction is two revolutions old by then: nothing is ever fresh.
TEST(SightWatch, ALidarThatIsTooSlowForTheLimitIsNeverFresh) {
  Lidar five({}, 1024, 5);
  five.Revolutions(5);
  EXPECT_LT(five.AgeAhead_s(), 0.21);
  Lidar four({}, 1024, 4);
  four.Revolutions(5);
  EXPECT_EQ(four.Ahead().time_ns, 0u);
}

// SR-SEE02: the offset of the sensor's clock moves by half a millisecond between two packets.
TEST(SightWatch, AMovingClockOffsetIsNoSlowLidar) {
  Lidar lidar;
  lidar.Revolutions(3);
  for (int turn = 0; turn < 20; ++turn) {
    lidar.Revolution([&](int id, const LidarColumn&) {
      if (id == 512) lidar.now_ns += 500'000;
      EXPECT_LT(lidar.AgeAhead_s(), 0.11);
      return true;
    });
  }
}

TEST(SightWatch, AsksForTheSectorsBetweenTwoPoints) {
  Lidar lidar;
  lidar.Revolutions(3);
  for (int turn = 0; turn < 8; ++turn) {
    lidar.Revolution(
        [&](int id, const LidarColumn&) { return std::fabs(lidar.Angle_deg(id) - 90.0) > 15.0; });
  }
  const auto age_s = [&](Vec2 right, Vec2 left) {
    SightLook look;
    lidar.watch->LookBetween(right, left, lidar.now_ns, look);
    return lidar.Age_s(look);
  };
  EXPECT_LT(age_s({5.0f, -1.0f}, {5.0f, 1.0f}), 0.2);
  EXPECT_GT(age_s({1.0f, 5.0f}, {-1.0f, 5.0f}), 0.7);
  EXPECT_GT(age_s({-1.0f, 5.0f}, {1.0f, 5.0f}), 0.7) << "the other way round";
  EXPECT_LT(age_s({-5.0f, 1.0f}, {-5.0f, -1.0f}), 0.2) << "behind, over the seam";
  EXPECT_GT(age_s({NAN, 1.0f}, {5.0f, 1.0f}), 0.7) << "all of them";
}

TEST(SightWatch, RefusesWhatIsNoSensor) {
  Lidar lidar;
  SightWatch& watch = *lidar.watch;
  EXPECT_EQ(watch.Configure({}, {}, *lidar.model, 0, 0, 1023), Status::kInvalidArgument);
  EXPECT_EQ(watch.Configure({}, {}, *lidar.model, 16, 0, 1024), Status::kInvalidArgument);
  EXPECT_EQ(watch.Configure({}, {.max_look_age_s = 99.0f}, *lidar.model, 16, 0, 1023),
            Status::kParameterOutOfRange);
  EXPECT_EQ(lidar.Ahead().time_ns, 0u);
  lidar.column->beams = 16;
  watch.Take(*lidar.column, 1);
  EXPECT_EQ(watch.newest_ns(), 0u);
}

}  // namespace
}  // namespace hardpack
