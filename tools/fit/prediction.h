// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tools/fit/drive_record.h"
#include "tools/sim/vehicle/vehicle_model.h"

// A model's prediction from the setpoints of a segment and the wheel speeds at its start, open
// loop.

namespace hardpack::fit {

struct TrackPoint {
  sim::WheelSpeeds wheels;
  sim::Pose pose;  // in the frame of the segment's start
};

// At each multiple of step_s from the segment's start; in between interpolated linearly, beyond the
// ends constant.
struct Track {
  double step_s = 0.0;
  std::vector<TrackPoint> points;

  TrackPoint At(double t_s) const;
};

// With the model. If a segment continues the one predicted before, the drives' integral action is
// carried over, because no recorded quantity shows it; otherwise it is that of settled wheels.
// `track` is overwritten; its memory is reused.
class ModelPredictor {
 public:
  ModelPredictor(const sim::VehicleModelParams& params, double step_s)
      : params_(params), step_s_(step_s) {}

  void operator()(const DriveSegment& segment, Track& track);

 private:
  sim::VehicleModelParams params_;
  double step_s_;
  int before_ = -2;  // number of the previous segment; none
  double integral_radps_ = 0.0;
};

// An ideal differential drive with wheel_radius_m and separation_m: its wheels follow commands at
// once.
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

// The recorded wheels, interpolated linearly between their fresh samples, with the model's body:
// the error that a perfect model of the wheels alone would leave. wheel_age_s: the age of a fresh
// sample.
void PredictFromWheels(const sim::VehicleModelParams& params, double wheel_age_s,
                       const DriveSegment& segment, double step_s, Track& track);

}  // namespace hardpack::fit
