// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "tools/fit/drive_record.h"
#include "tools/fit/evaluation.h"
#include "tools/sim/vehicle/vehicle_model_params.h"

// Fits the vehicle model to a recording: the numbers with which open-loop predictions from the
// setpoints come closest to the fresh wheel speeds and to the translations and rotations of the
// poses in windows of half a second. Each kind of residual is scaled by the uncertainty of the
// recording; larger residuals count less than their square (pseudo-Huber), because poses sometimes
// jump.

namespace hardpack::fit {

struct FitSettings {
  double step_s = 0.005;
  int iterations = 30;
};

struct VehicleFit {
  sim::VehicleModelParams params;
  double pose_age_s = 0.1;  // see evaluation.h
  double cost = 0.0;
  int evaluations = 0;  // of the whole set of segments
};

// The starting point of the search.
VehicleFit FirstGuess();

VehicleFit FitVehicle(const std::vector<DriveSegment>& segments, const VehicleFit& start,
                      const FitSettings& settings);

// Splits the segments into those to fit and those held out: by whole runs drawn with the seed,
// because segments of one run share its ground. Both parts keep the order.
struct Split {
  std::vector<DriveSegment> fit;
  std::vector<DriveSegment> held_out;
};
Split SplitByRun(const std::vector<DriveSegment>& segments, double held_out_share, uint64_t seed);

// The variation of the numbers between runs: the fit is repeated for each run alone, with a prior
// around `whole` whose width is a third of each number, and the standard deviation is taken over
// the runs. 0 for numbers that are not fitted.
sim::VehicleModelParams DeviationOverRuns(const std::vector<DriveSegment>& segments,
                                          const VehicleFit& whole, const FitSettings& settings);

}  // namespace hardpack::fit
