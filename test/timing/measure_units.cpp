// SPDX-License-Identifier: Apache-2.0
#include <cstdint>

#include "config/onboard_parameters.h"
#include "core/autonomy/mapper.h"
#include "core/autonomy/planner.h"
#include "core/base/assert.h"
#include "core/safety/motion_sweep.h"
#include "hal/onboard/vehicle_loop/vehicle_loop.h"
#include "test/bare_metal/instruction_clock.h"
#include "test/bare_metal/print.h"
#include "test/bare_metal/semihosting.h"
#include "test/decision/storage.h"
#include "test/timing/adversarial_maps.h"

// The most instructions that one step of each of the planner's stages takes on the adversarial
// maps, counted exactly: tools/proof/wcet/timing.py holds the static bounds against them. Each map
// for the default vehicle and for the largest one, in steps of one unit and in whole portions, from
// the middle to a corner and, with a heading there, to a side, by either optimizer.

namespace hardpack::decision {

const uint8_t kFreshMemory = 0;

}  // namespace hardpack::decision

namespace hardpack::timing {
namespace {

using bare_metal::InstructionClock;

constexpr int kStages = static_cast<int>(PlanStage::kDone) + 1;
constexpr const char* kStageNames[kStages] = {"idle",     "heights", "pending", "costmap",
                                              "search",   "sample",  "lead",    "moves",
                                              "optimize", "check",   "speed",   "done"};

HP_BIG_MEMORY decision::Storage<Planner> planner_memory;
HP_BIG_MEMORY decision::Storage<HeightGrid> heights_memory;

struct Counts {
  uint32_t most[kStages] = {};
  uint32_t steps[kStages] = {};
};

[[noreturn]] void OnAssertion(const char* file, int line, const char* expression) {
  bare_metal::PrintNumber(file, static_cast<uint32_t>(line));
  bare_metal::PrintLine(expression);
  bare_metal::Exit(4);
}

template <typename Step>
void Run(Planner& planner, Counts& counts, Step&& step) {
  Progress progress = Progress::kBusy;
  while (progress == Progress::kBusy) {
    const auto stage = static_cast<int>(planner.stage());
    const uint32_t from = InstructionClock::Now();
    progress = step();
    const uint32_t taken = InstructionClock::InstructionsBetween(from, InstructionClock::Now());
    ++counts.steps[stage];
    if (taken > counts.most[stage]) counts.most[stage] = taken;
  }
}

PlanRequest RequestFor(int goal) {
  constexpr Vec2 kGoals[] = {{45.0f, 44.0f}, {-48.0f, 20.0f}};
  PlanRequest request;
  request.start.pose = {0.1f, 0.1f, 0.3f};
  request.goal_odom = kGoals[goal];
  request.has_goal_heading = goal == 1;
  request.goal_heading_rad = 2.0f;
  return request;
}

// As large as a vehicle may be, planned for as widely as may be: what looks around it looks
// furthest.
void MakeLargest(PlannerParams& params) {
  params.vehicle.length_m = 6.0f;
  params.vehicle.width_m = 4.0f;
  params.vehicle.axle_offset_m = 3.0f;
  params.costmap.hard_slope_per_m *= 0.4f;  // the same costs inside
  params.costmap.soft_slope_per_m *= 0.4f;
  params.optimizer.window_steps = 255;
  params.path.smoothing_passes = PathSmoother::kMaxPasses;
}

struct Round {
  int method = 0;
  int goal = 0;
  bool is_largest = false;
};

constexpr PlannerParams kDefaults;

void PlanOn(const AdversarialMap& map, const Round& round, int units, Counts& counts) {
  Planner& planner = planner_memory.Construct();
  static PlannerParams params;  // a frame has room for less
  params = kDefaults;
  params.optimizer.method = round.method;
  if (round.is_largest) MakeLargest(params);
  const GridWindow window = GridWindow::CenteredAt({0.1f, 0.1f});
  if (!IsUsable(planner.BeginCells(window, params, RequestFor(round.goal)))) bare_metal::Exit(5);
  for (int32_t y = 0; y < kMapSize_cells; ++y) {
    for (int32_t x = 0; x < kMapSize_cells; ++x) {
      planner.costmap_builder().SetCell(y * kMapSize_cells + x, map.flags(x, y));
    }
  }
  Run(planner, counts, [&] { return planner.StepCells(units); });
}

// Heights of every kind: a row of them is classed in a unit.
void PlanOnHeights(int units, Counts& counts) {
  HeightGrid& heights = heights_memory.Construct();
  for (int32_t y = -kMiddle; y < kMiddle; ++y) {
    for (int32_t x = -kMiddle; x < kMiddle; ++x) {
      const Vec2 place = CellCenter({x, y});
      const uint32_t bits = Mixed(x, y);
      const float top_m = static_cast<float>(bits % 256u) * 0.01f;
      static_cast<void>(heights.Insert({place.x_m, place.y_m, 0.0f}, ReturnClass::kGround, 1));
      if (bits % 5u == 0) continue;
      const ReturnClass what = bits % 5u == 1 ? ReturnClass::kSoft : ReturnClass::kHard;
      static_cast<void>(heights.Insert({place.x_m, place.y_m, top_m}, what, 1));
    }
  }
  Planner& planner = planner_memory.Construct();
  if (!IsUsable(planner.Begin(heights, kDefaults, RequestFor(0)))) bare_metal::Exit(5);
  Run(planner, counts, [&] { return planner.Step(heights, units); });
}

void MeasureWith(const char* prefix, int units) {
  static Counts counts;
  counts = {};
  PlanOnHeights(units, counts);
  for (const AdversarialMap& map : kAdversarialMaps) {
    for (int method = 0; method < 2; ++method) {
      for (int goal = 0; goal < 2; ++goal) {
        PlanOn(map, {method, goal, false}, units, counts);
        PlanOn(map, {method, goal, true}, units, counts);
      }
    }
  }
  for (int stage = 0; stage < kStages; ++stage) {
    if (counts.steps[stage] == 0) continue;
    bare_metal::Write(prefix);
    bare_metal::Write(" ");
    bare_metal::PrintNumber(kStageNames[stage], counts.most[stage]);
  }
}

void PrintConstants() {
  const auto print = [](const char* name, int64_t value) {
    bare_metal::Write("constant ");
    bare_metal::PrintNumber(name, static_cast<uint32_t>(value));
  };
  print("portion_units", Planner::kPortion_units);
  print("search_units", Planner::kSearchUnits);
  print("datagrams", VehicleLoop::kMaxDatagramsPerTick);
  print("ins_feeds", VehicleLoop::kMaxInsFeeds);
  print("ins_looks", VehicleLoop::kMaxInsMessages);
  print("aged_cells", Mapper::kMaxAged_cells);
  print("crossed_cells", Mapper::kMaxCrossed_cells);
  print("tick_crossed_cells", Mapper::kMaxCrossedInTick_cells);
  print("ins_bytes", VehicleLoop::kMaxInsDatagram_bytes);
  print("ins_waiting", vectornav::StreamParser::kCapacity);
  print("bridge_cells", HeightGrid::kMaxBridge_cells);
  print("corridor_tests", Corridor::kMaxTests);
  print("corridor_rows", Corridor::kMaxMarked_rows);
  print("person_cells", SpeedCaps::kMaxPersonCells);
  print("folds", Mapper::kMaxFolds);
  print("near_cells", PathCheck::kMaxNearCells);
  print("mount_columns", Pilot::kMaxMountColumns);
  print("person_looks", Pilot::kMaxPersonLooks);
  print("body_looks", Pilot::kMaxBodyLooks);
  print("sweep_tests", MotionSweep::kMaxTests);
  print("plan_units", Planner::kMaxUnits);
  print("plan_transitions", Planner::kMaxTransitions);
  // What parameters are by default.
  print("planning_units", TickParams{}.planning_units);
  print("directions", TickParams{}.directions);
  print("beams", kMaxBeams);
}

}  // namespace
}  // namespace hardpack::timing

int main() {
  hardpack::SetAssertionHook(hardpack::timing::OnAssertion);
  hardpack::timing::PrintConstants();
  hardpack::bare_metal::InstructionClock::Start();
  hardpack::timing::MeasureWith("portion", hardpack::Planner::kPortion_units);
  hardpack::timing::MeasureWith("unit", 1);
  return 0;
}
