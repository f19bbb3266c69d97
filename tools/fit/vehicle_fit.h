// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "tools/fit/drive_record.h"
#include "tools/fit/evaluation.h"
#include "tools/sim/vehicle/vehicle_model_params.h"

// Fits the vehicle model to a recording: the numbers with which open-loop predictions from the
// setpoints come nearest to the wheels' fresh speeds and to what the poses moved and turned by in
// windows of half a second. The scale of each kind of residual is what the record itself is unsure
// of; beyond it residuals count less and less than their square (pseudo-Huber), as poses sometimes
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

// From where the search begins.
VehicleFit FirstGuess();

VehicleFit FitVehicle(const std::vector<DriveSegment>& segments, const VehicleFit& start,
                      const FitSettings& settings);

// Which part of the segments is for the fit: whole runs, drawn by the seed, as segments of one run
// share its ground. Both parts keep the order.
struct Split {
  std::vector<DriveSegment> fit;
  std::vector<DriveSegment> held_out;
};
Split SplitByRun(const std::vector<DriveSegment>& segments, double held_out_share, uint64_t seed);

// How the numbers differ from run to run: the fit is repeated for each run alone, held to `whole`
// by a prior whose width is a third of each number, and the standard deviation taken over the runs.
// 0 for what is not fitted.
sim::VehicleModelParams DeviationOverRuns(const std::vector<DriveSegment>& segments,
                                          const VehicleFit& whole, const FitSettings& settings);

}  // namespace hardpack::fit
