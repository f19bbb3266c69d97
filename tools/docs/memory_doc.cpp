// SPDX-License-Identifier: Apache-2.0
// Prints docs/memory.md: who takes how much memory, from the types themselves.
#include <cstdio>

#include "core/autonomy/mapper.h"
#include "core/autonomy/planner.h"
#include "core/autonomy/replanner.h"
#include "hal/onboard/vehicle_loop/vehicle_loop.h"

namespace {

constexpr const char* kIntroduction = R"(# Memory

Every buffer is a member of an object whose size is known at compile time and held to a budget by a
`static_assert`. The objects are owned by the caller; nothing is allocated in `core` or `hal`.
This page is printed by `memory_doc` (a test compares them); sizes are those of a 64-bit build.

| object | bytes | bytes per cell | purpose |
|---|---:|---:|---|
)";

void PrintRow(const char* name, size_t bytes, const char* purpose) {
  std::printf("| %s | %zu | %.2f | %s |\n", name, bytes,
              static_cast<double>(bytes) / hardpack::kMapCells, purpose);
}

}  // namespace

int main() {
  using namespace hardpack;
  std::fputs(kIntroduction, stdout);
  PrintRow("`HeightGrid`", sizeof(HeightGrid), "heights of returns, per cell");
  PrintRow("`Replanner`", sizeof(Replanner),
           "all of planning except the heights: the committed plan, and:");
  PrintRow("`Planner`", sizeof(Planner), "one plan, including:");
  PrintRow("&nbsp; `CostmapBuilder`", sizeof(CostmapBuilder),
           "costs, flags, distances, and the scratch of their passes");
  PrintRow("&nbsp; `AstarSearch`", sizeof(AstarSearch), "64 bits per cell and 4096 buckets");
  PrintRow("&nbsp; `Manoeuvre`", sizeof(Manoeuvre),
           "bins and states of the search for several moves");
  PrintRow("&nbsp; `PathSampler`", sizeof(PathSampler), "the base path");
  PrintRow("&nbsp; `Optimizer`", sizeof(Optimizer), "both optimizers: paths and trial paths");
  PrintRow("&nbsp; `PathCheck`", sizeof(PathCheck), "the check's progress");
  PrintRow("&nbsp; `Plan`", sizeof(Plan), "the result");
  PrintRow("`Mapper`", sizeof(Mapper), "all of perception, including `HeightGrid` and:");
  PrintRow("&nbsp; `ScanRing`", sizeof(ScanRing),
           "at least three revolutions of columns; budget 2 MiB");
  PrintRow("&nbsp; `Segmenter`", sizeof(Segmenter), "the directions that are processed together");
  PrintRow("&nbsp; `BeamModel`", sizeof(BeamModel), "the lidar's geometry");
  PrintRow("&nbsp; `PoseHistory`", sizeof(PoseHistory), "poses for motion compensation");
  PrintRow("`VehicleLoop`", sizeof(VehicleLoop),
           "everything on board: `Mapper`, `Replanner`, and:");
  PrintRow("&nbsp; `Corridor`", sizeof(Corridor),
           "returns against the path: a coarse grid, and the cells of the last ticks");
  PrintRow("&nbsp; `AreaSet`", sizeof(AreaSet), "the areas in force: 64 of 32 corners");
  PrintRow("&nbsp; `ReactionMeter`", sizeof(ReactionMeter), "waiting columns, and histograms");
  PrintRow("&nbsp; `vectornav::StreamParser`", sizeof(vectornav::StreamParser),
           "the INS's stream, until a message is complete");
  PrintRow("&nbsp; `control::OperatorCommand`", sizeof(control::OperatorCommand),
           "waypoints, or an area");
  PrintRow("&nbsp; `sevcon::DrivePair`", sizeof(sevcon::DrivePair), "both drives");
  PrintRow("&nbsp; `ouster::PacketMonitor`", sizeof(ouster::PacketMonitor), "the lidar's stream");
  PrintRow("&nbsp; `VehicleConfig`", sizeof(VehicleConfig), "parameters, and the configured areas");
  constexpr double kMiB = 1024.0 * 1024.0;
  const size_t planning = sizeof(Replanner) + sizeof(HeightGrid);
  std::printf(
      "\nPlanning (`Replanner` and `HeightGrid`) takes %zu of its %d bytes (%.2f of %.2f MiB).\n",
      planning, kPlanningBudget_bytes, static_cast<double>(planning) / kMiB,
      static_cast<double>(kPlanningBudget_bytes) / kMiB);
  return 0;
}
