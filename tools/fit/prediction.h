// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tools/fit/drive_record.h"
#include "tools/sim/vehicle/vehicle_model.h"

// What a model makes of a segment's setpoints: from the wheel speeds at its begin, open loop.

namespace hardpack::fit {

struct TrackPoint {
  sim::WheelSpeeds wheels;
  sim::Pose pose;  // in the frame of the segment's begin
};

// At each multiple of step_s from the segment's begin; at other times straight lines between, the
// ends beyond them.
struct Track {
  double step_s = 0.0;
  std::vector<TrackPoint> points;

  TrackPoint At(double t_s) const;
};

// With the model. Of a segment that goes on from the one predicted before, the drives' integral
// action is carried on, as nothing recorded tells it; else it is that of settled wheels. `track` is
// overwritten; its memory is used again.
class ModelPredictor {
 public:
  ModelPredictor(const sim::VehicleModelParams& params, double step_s)
      : params_(params), step_s_(step_s) {}

  void operator()(const DriveSegment& segment, Track& track);

 private:
  sim::VehicleModelParams params_;
  double step_s_;
  int before_ = -2;  // number of the segment before; none
  double integral_radps_ = 0.0;
};

// Wheels that turn as commanded at once, wheel_radius_m and separation_m as a differential drive.
void PredictIdeal(double separation_m, const DriveSegment& segment, double step_s, Track& track);

// Each side a first-order lag after a dead time, the body as in PredictIdeal.
struct FirstOrderPowertrain {
  double time_constant_left_s = 1.22;
  double time_constant_right_s = 1.05;
  double dead_time_left_s = 0.058;
  double dead_time_right_s = 0.056;
};
void PredictFirstOrder(const FirstOrderPowertrain& powertrain, double separation_m,
                       const DriveSegment& segment, double step_s, Track& track);

// The wheels as recorded, with straight lines between their fresh samples, and the body of the
// model: what would be left to a perfect model of the wheels alone. wheel_age_s: how old a fresh
// sample is.
void PredictFromWheels(const sim::VehicleModelParams& params, double wheel_age_s,
                       const DriveSegment& segment, double step_s, Track& track);

}  // namespace hardpack::fit
