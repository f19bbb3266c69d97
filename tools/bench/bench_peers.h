// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tools/bench/bench_chain.h"
#include "tools/bench/bench_timing.h"

// Other libraries on the inputs of a StageChain, those that this build has (tools/bench/peers). The
// chain must outlive the returned list.

namespace hardpack::command {

using PeerRuns = std::vector<std::unique_ptr<PeerRun>>;

// The names of those that this build has, for the report.
std::vector<std::string> PeerNames();

// "opencv": the exact distance transform, once for each layer.
PeerRuns DistancePeers(const StageChain& chain);

// "boost": astar_search on the same costmap, the queries in turn. Solves each once: throws a
// CommandFailure if a cost differs from that of core/astar.
PeerRuns SearchPeers(StageChain& chain, const std::string& scene);

// "ceres_trust_region", "ceres_line_search": the same F from the same seed, at most 100 iterations.
PeerRuns OptimizerPeers(const StageChain& chain);

}  // namespace hardpack::command
