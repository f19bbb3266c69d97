// SPDX-License-Identifier: Apache-2.0
// Prints docs/assured_sight.md: how far away lidars of 16 to 128 beams meet low objects, and the
// speed this allows.
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "core/autonomy/assured_sight.h"
#include "core/base/math.h"
#include "core/scan/scan.h"

namespace hardpack {
namespace {

constexpr const char* kIntroduction = R"(# Assured sight of the lidar

<!-- Printed by assured_sight_doc (tools/docs/assured_sight_doc.cpp); do not edit. -->

```
cmake --build --preset release --target assured_sight_doc
build/release/test/docs/assured_sight_doc > docs/assured_sight.md
```

An object standing on level ground is met when a beam ends on the part of it above the tolerance of the ground test
(`segmentation.ground_band_m`): one beam in a direction is enough for the segmenter to class its return as
standing (test `AssuredSight.WhatIsMetIsClassedAsStanding`). As long as the spacing of neighbouring beams is no greater
than the height of that part, one of them meets it, at any pitch of the vehicle; up to there, sight is assured
(`core/autonomy/assured_sight.h`). To be distinguished from growth, the object must be firm as well, and a return is firm with
three of its four neighbours in azimuth on the same surface: four columns
(test `AssuredSight.WhatIsAsWideAsIsAssuredIsFirm`).

The vehicle drives no faster than lets it stop within both distances, its front `speed.unseen_margin_m` before the object: the
onboard program lowers `speed.max_speed_mps` to what its own lidar allows. The height is `speed.assured_height_m`, the width
`speed.assured_width_m`. A lidar that cannot see an object of that size far enough ahead to creep is refused; with
`speed.refuse_unassured = 0` the vehicle creeps at `speed.person_creep_mps` instead. Narrower objects are met as far away, but
may be distinguished from growth too late to stop. An object with four beams on it, one above the other, is firm without
neighbours, and a wire is firm by the line of its returns.

The tables below are for lidars with even steps over 33.2 degrees, half of them upward, %.2f m above the ground, and the defaults
of all parameters; first by height alone, then by width. Sight is measured from the sensor. They do not cover deviations from
the even beam pattern, an unmeasured mount or a nose that dips.

)";

BeamModel EvenBeams(int beams, int columns = 1024) {
  std::vector<float> altitude_deg;
  for (int i = 0; i < beams; ++i) {
    altitude_deg.push_back(16.6f - 33.2f * static_cast<float>(i) / static_cast<float>(beams - 1));
  }
  const std::vector<float> azimuth_deg(static_cast<size_t>(beams), 0.0f);
  const Transform3 sensor_from_lidar = {{-1, 0, 0, 0, -1, 0, 0, 0, 1}, {0.0f, 0.0f, 0.03618f}};
  BeamModel model;
  const Status status =
      MakeBeamModel(altitude_deg, azimuth_deg, columns, 0.012163f, sensor_from_lidar, model);
  if (!IsUsable(status)) std::fprintf(stderr, "no model of %d beams\n", beams);
  return model;
}

void PrintRow(float band_m, float height_m, const char* what) {
  std::printf("| %.2f | %.2f | %s |", static_cast<double>(height_m), static_cast<double>(band_m),
              what);
  for (const int beams : {16, 32, 64, 128}) {
    const BeamModel model = EvenBeams(beams);
    PerceptionParams perception;
    perception.segmentation.ground_band_m = band_m;
    SpeedParams speed;
    speed.assured_height_m = height_m;
    speed.assured_width_m = 10.0f;  // of the height alone
    const float sight_m =
        AssuredSight_m(model, SensorHeight_m(model, perception.mount), band_m, height_m);
    std::printf(" %.1f m, %.2f m/s |", static_cast<double>(sight_m),
                static_cast<double>(AssuredSpeed_mps(model, perception, VehicleParams{}, speed)));
  }
  std::printf("\n");
}

void PrintWidths() {
  std::printf("\nBy the width, with 64 beams and the default height:\n\n");
  std::printf("| width m | 512 columns | 1024 columns | 2048 columns |\n|---|---|---|---|\n");
  for (const float width_m : {0.1f, 0.2f, SpeedParams{}.assured_width_m, 0.5f, 1.0f}) {
    std::printf("| %.2f |", static_cast<double>(width_m));
    for (const int columns : {512, 1024, 2048}) {
      const BeamModel model = EvenBeams(64, columns);
      SpeedParams speed;
      speed.assured_width_m = width_m;
      std::printf(
          " %.1f m, %.2f m/s |", static_cast<double>(FirmSight_m(model, width_m)),
          static_cast<double>(AssuredSpeed_mps(model, PerceptionParams{}, VehicleParams{}, speed)));
    }
    std::printf("\n");
  }
}

void PrintLeast() {
  std::printf("\nThe least height that is met early enough at each speed; -: none up to 2 m:\n\n");
  std::printf("| speed | 16 beams | 32 beams | 64 beams | 128 beams |\n|---|---|---|---|---|\n");
  for (const float speed_mps : {1.0f, 2.0f, 3.0f, 4.0f, 5.0f}) {
    std::printf("| %.0f m/s |", static_cast<double>(speed_mps));
    for (const int beams : {16, 32, 64, 128}) {
      const float least_m = LeastAssuredHeight_m(EvenBeams(beams), PerceptionParams{},
                                                 VehicleParams{}, SpeedParams{}, speed_mps);
      if (least_m > 0.0f) {
        std::printf(" %.2f m |", static_cast<double>(least_m));
      } else {
        std::printf(" - |");
      }
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace hardpack

int main() {
  using namespace hardpack;
  const BeamModel model = EvenBeams(64);
  std::printf(kIntroduction, static_cast<double>(SensorHeight_m(model, LidarMountParams{})));
  std::printf("| height m | tolerated m | | 16 beams | 32 beams | 64 beams | 128 beams |\n");
  std::printf("|---|---|---|---|---|---|---|\n");
  const float band_m = SegmentationParams{}.ground_band_m;
  PrintRow(band_m, 0.2f, "the default");
  PrintRow(0.1f, 0.2f, "one beam on the upper half");
  PrintRow(0.0f, 0.2f, "one beam anywhere");
  for (const float height_m : {0.15f, 0.3f, 0.4f, 0.5f}) PrintRow(band_m, height_m, "");
  PrintWidths();
  PrintLeast();
  return 0;
}
