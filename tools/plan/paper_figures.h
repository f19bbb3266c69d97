// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/picture/canvas.h"

// The figures of the paper that need no simulator, made with the library itself on small worlds.
// Each throws a CommandFailure (work failed) when there is no plan to draw.

namespace hardpack::command {

// [OS] Path Representation: a path around a square obstacle in world and in actuator space.
picture::Canvas SquareFigure();

// [OS] Path Solver: a perturbation at step 5, N = 25, in actuator space (left) and world space
// (right): unperturbed green, without correction red, with correction blue.
picture::Canvas PerturbationFigure();

// [OS] Cost Map Creation: input, expanded layers, their costs and the sum.
picture::Canvas CostmapFigure();

}  // namespace hardpack::command
