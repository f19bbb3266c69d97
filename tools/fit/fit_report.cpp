// SPDX-License-Identifier: Apache-2.0
#include "tools/fit/fit_report.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <limits>

#include "tools/sim/vehicle/vehicle_model_file.h"

namespace hardpack::fit {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kStep_s = sim::VehicleModel::kStep_s;
// Separations for a differential drive as a model of the vehicle (docs/vehicle.md).
constexpr double kGeometricTrack_m = 1.1364;
constexpr double kStockSeparation_m = 1.6875;
constexpr double kMeasuredBaseline_m = 1.87;

std::string Text(double value, int digits) {
  std::array<char, 48> text = {};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

double Rounded(double value, int digits) {
  std::array<char, 48> text = {};
  std::snprintf(text.data(), text.size(), "%.*g", digits, value);
  return std::strtod(text.data(), nullptr);
}

// The one with which a predictor does best.
double PoseAgeOf(const std::vector<DriveSegment>& segments, const Predictor& predict) {
  constexpr int kAges = 20;
  constexpr double kAge_s = 0.02;
  double best_s = 0.0;
  double best_radps = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kAges; ++i) {
    const double error_radps = Evaluate(segments, predict, i * kAge_s).yaw_rate_rms_radps;
    if (error_radps >= best_radps) continue;
    best_radps = error_radps;
    best_s = i * kAge_s;
  }
  return best_s;
}

std::vector<Contender> Contend(const Split& split, const VehicleFit& fit) {
  std::vector<Contender> contenders;
  const auto add = [&](const char* key, const char* text, const Predictor& predict) {
    const bool has_own_body = contenders.size() < 2;  // and with it its age
    const double age_s = has_own_body ? fit.pose_age_s : PoseAgeOf(split.fit, predict);
    contenders.push_back({key, text, age_s, Evaluate(split.held_out, predict, age_s)});
  };
  const auto ideal = [](double separation_m) {
    return [separation_m](const DriveSegment& segment, Track& track) {
      PredictIdeal(separation_m, segment, kStep_s, track);
    };
  };
  const auto first_order = [](double separation_m) {
    return [separation_m](const DriveSegment& segment, Track& track) {
      PredictFirstOrder({}, separation_m, segment, kStep_s, track);
    };
  };
  add("model", "this model", ModelPredictor(fit.params, kStep_s));
  add("recorded_wheels", "recorded wheels, this model's body",
      [&fit](const DriveSegment& segment, Track& track) {
        PredictFromWheels(fit.params, kWheelAge_s, segment, kStep_s, track);
      });
  add("first_order_stock", "published first order, 1.6875 m", first_order(kStockSeparation_m));
  add("first_order_measured", "published first order, 1.87 m", first_order(kMeasuredBaseline_m));
  add("ideal_geometric", "ideal differential drive, 1.1364 m", ideal(kGeometricTrack_m));
  add("ideal_stock", "ideal differential drive, 1.6875 m", ideal(kStockSeparation_m));
  add("ideal_measured", "ideal differential drive, 1.87 m", ideal(kMeasuredBaseline_m));
  return contenders;
}

Json SpreadToJson(const Spread& spread) {
  return {{"rms", Rounded(spread.rms, 5)},
          {"median", Rounded(spread.median, 5)},
          {"p95", Rounded(spread.p95, 5)}};
}

Json HorizonToJson(const HorizonErrors& horizon) {
  return {{"mean_s", Rounded(horizon.mean_s, 4)},
          {"position_m", SpreadToJson(horizon.position_m)},
          {"heading_rad", SpreadToJson(horizon.heading_rad)},
          {"yaw_rate_radps", SpreadToJson(horizon.yaw_rate_radps)}};
}

// With a column's mark before each.
std::string Columns(std::initializer_list<std::string> texts) {
  std::string line;
  for (const std::string& text : texts) line.append(" | ").append(text);
  return line;
}

std::string WithMedian(const Spread& spread) {
  return Text(spread.rms, 2).append(" (").append(Text(spread.median, 2)).append(")");
}

std::string HorizonColumns(const HorizonErrors& horizon) {
  return Columns({WithMedian(horizon.position_m), WithMedian(horizon.heading_rad),
                  Text(horizon.yaw_rate_radps.rms, 2)});
}

std::string CommandOf(const FitReport& report) {
  return "hardpack fit --drive " + report.drive + " --seed " + std::to_string(report.seed) +
         " --out DIR";
}

}  // namespace

FitReport MakeFitReport(const std::vector<DriveSegment>& segments, const std::string& drive,
                        double held_out_share, uint64_t seed, const FitSettings& settings) {
  const Split split = SplitByRun(segments, held_out_share, seed);
  FitReport report;
  report.drive = drive;
  report.seed = seed;
  report.segments_fitted = static_cast<int>(split.fit.size());
  report.segments_held_out = static_cast<int>(split.held_out.size());
  report.fit = FitVehicle(split.fit, FirstGuess(), settings);
  report.deviation = DeviationOverRuns(split.fit, report.fit, settings);
  report.contenders = Contend(split, report.fit);
  return report;
}

Json FitReportToJson(const FitReport& report) {
  Json params;
  for (const sim::VehicleParameter& parameter : sim::VehicleParameters()) {
    params[parameter.name] = {{"value", Rounded(report.fit.params.*parameter.value, 6)},
                              {"deviation", Rounded(report.deviation.*parameter.value, 6)}};
  }
  Json contenders;
  for (const Contender& contender : report.contenders) {
    const Errors& errors = contender.errors;
    contenders[contender.key] = {{"text", contender.text},
                                 {"pose_age_s", Rounded(contender.pose_age_s, 4)},
                                 {"yaw_rate_rms_radps", Rounded(errors.yaw_rate_rms_radps, 5)},
                                 {"windows", errors.windows},
                                 {"wheel_rms_radps", Rounded(errors.wheel_rms_radps, 5)},
                                 {"one_s", HorizonToJson(errors.one_s)},
                                 {"two_s", HorizonToJson(errors.two_s)}};
  }
  return {{"drive", report.drive},
          {"seed", report.seed},
          {"segments_fitted", report.segments_fitted},
          {"segments_held_out", report.segments_held_out},
          {"pose_age_s", Rounded(report.fit.pose_age_s, 4)},
          {"evaluations", report.fit.evaluations},
          {"params", params},
          {"held_out", contenders}};
}

std::string FitReportToMarkdown(const FitReport& report) {
  std::string text = "`";
  text += CommandOf(report) + "`\n\n";
  text += std::to_string(report.segments_fitted) + " segments fitted, ";
  text += std::to_string(report.segments_held_out) +
          " held out (whole runs). Errors on what was held out, open loop from the\n"
          "setpoints; root mean square, the median in brackets.\n\n";
  text +=
      "| prediction | yaw rate, all windows [rad/s] | wheel speed [rad/s] | position, 1 s [m] | "
      "heading, 1 s [rad] | yaw rate, 1 s [rad/s] | position, 2 s [m] | heading, 2 s [rad] | "
      "yaw rate, 2 s [rad/s] |\n|---|---|---|---|---|---|---|---|---|\n";
  for (const Contender& contender : report.contenders) {
    const Errors& errors = contender.errors;
    text += "| " + contender.text +
            Columns({Text(errors.yaw_rate_rms_radps, 3), Text(errors.wheel_rms_radps, 2)}) +
            HorizonColumns(errors.one_s) + HorizonColumns(errors.two_s) + " |\n";
  }
  text += "\n| number | value | deviation over runs | what it is |\n|---|---|---|---|\n";
  for (const sim::VehicleParameter& parameter : sim::VehicleParameters()) {
    const double deviation = report.deviation.*parameter.value;
    text += std::string("| `") + parameter.name + "` | " +
            sim::NumberText(Rounded(report.fit.params.*parameter.value, 4)) + " | " +
            (deviation > 0.0 ? sim::NumberText(Rounded(deviation, 2)) : "not fitted") + " | " +
            parameter.description + " |\n";
  }
  return text;
}

sim::UncertainVehicle FittedVehicle(const FitReport& report, double wheel_limit_radps) {
  constexpr int kDigits = 4;
  sim::UncertainVehicle vehicle;
  for (const sim::VehicleParameter& parameter : sim::VehicleParameters()) {
    vehicle.typical.*parameter.value = Rounded(report.fit.params.*parameter.value, kDigits);
    vehicle.deviation.*parameter.value = Rounded(report.deviation.*parameter.value, kDigits);
  }
  vehicle.typical.wheel_limit_radps = wheel_limit_radps;
  return vehicle;
}

std::string FittedVehicleToml(const FitReport& report, double wheel_limit_radps,
                              const std::string& note) {
  const std::string comment =
      note + "\nFitted to " + report.drive + " (norlab-ulaval/DRIVE, BSD-3-Clause), written by\n" +
      CommandOf(report) +
      "\nwhere deviation stands: the standard deviation of refits to single runs; the others are "
      "not fitted:\nwheel radius from clearpath_common, wheel limit as above, brake assumed.\n"
      "Yaw-rate RMSE on held-out runs " +
      Text(report.contenders.front().errors.yaw_rate_rms_radps, 3) + " rad/s.";
  return sim::VehicleToToml(FittedVehicle(report, wheel_limit_radps), comment);
}

}  // namespace hardpack::fit
