// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "nlohmann/json.hpp"
#include "tools/fit/vehicle_fit.h"

// The results of `hardpack fit`, as text, as JSON and as vehicle files.

namespace hardpack::fit {

// A predictor and its errors on the held-out segments.
struct Contender {
  std::string key;          // in JSON
  std::string text;         // in tables
  double pose_age_s = 0.0;  // with which it predicts the fitted data best (evaluation.h)
  Errors errors;
};

struct FitReport {
  std::string drive;  // the recording's name, without its folder
  uint64_t seed = 0;
  int segments_fitted = 0;
  int segments_held_out = 0;
  VehicleFit fit;
  sim::VehicleModelParams deviation;  // over the fitted runs
  std::vector<Contender> contenders;  // the first one is the fitted model
};

// The complete fit: split by runs, fit, spread, and the errors of all contenders on the held-out
// runs. Precondition: the recording has at least four runs.
FitReport MakeFitReport(const std::vector<DriveSegment>& segments, const std::string& drive,
                        double held_out_share, uint64_t seed, const FitSettings& settings);

nlohmann::ordered_json FitReportToJson(const FitReport& report);
std::string FitReportToMarkdown(const FitReport& report);

// The fitted vehicle with its deviations, each to four digits; wheel_limit_radps is not fitted but
// given. `note` is written at the top of the file, with the recording and the command.
sim::UncertainVehicle FittedVehicle(const FitReport& report, double wheel_limit_radps);
std::string FittedVehicleToml(const FitReport& report, double wheel_limit_radps,
                              const std::string& note);

// The highest wheel speeds of the two vehicles that `hardpack fit` writes.
inline constexpr double kRecordedWheelLimit_radps = 13.4;  // reached with straight setpoints
inline constexpr double kPaperWheelLimit_radps = 17.5;     // 5 m/s over ground

}  // namespace hardpack::fit
