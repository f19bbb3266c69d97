// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/bench_peers.h"

#include "port_linux/command_line/command.h"
#ifdef HARDPACK_HAS_BOOST
#include "tools/bench/peers/boost_astar.h"
#endif
#ifdef HARDPACK_HAS_CERES
#include "tools/bench/peers/ceres_smoother.h"
#endif
#ifdef HARDPACK_HAS_OPENCV
#include "tools/bench/peers/opencv_distance.h"
#endif

namespace hardpack::command {

std::vector<std::string> PeerNames() {
  std::vector<std::string> names;
#ifdef HARDPACK_HAS_OPENCV
  names.emplace_back("opencv");
#endif
#ifdef HARDPACK_HAS_BOOST
  names.emplace_back("boost");
#endif
#ifdef HARDPACK_HAS_CERES
  names.emplace_back("ceres_trust_region");
  names.emplace_back("ceres_line_search");
#endif
  return names;
}

PeerRuns DistancePeers([[maybe_unused]] const StageChain& chain) {
  PeerRuns peers;
#ifdef HARDPACK_HAS_OPENCV
  const auto opencv = std::make_shared<peers::OpencvDistance>();
  opencv->Load(chain.map());
  peers.push_back(std::make_unique<PeerRun>(
      PeerRun{.name = "opencv", .run = [opencv] { opencv->Transform(); }}));
#endif
  return peers;
}

PeerRuns SearchPeers([[maybe_unused]] StageChain& chain,
                     [[maybe_unused]] const std::string& scene) {
  PeerRuns peers;
#ifdef HARDPACK_HAS_BOOST
  struct Boost {
    peers::BoostAstar search;
    std::vector<std::pair<Cell, Cell>> queries;
    size_t next = 0;
  };
  const auto boost = std::make_shared<Boost>();
  for (const BenchQuery& query : chain.queries()) {
    boost->queries.emplace_back(CellAt(query.start_m), CellAt(query.goal_m));
    const auto& [start, goal] = boost->queries.back();
    const auto found = boost->search.Search(chain.map(), start, goal);
    static_cast<void>(chain.Search(query));
    if (found.reached && found.cost == chain.search_result().cost) continue;
    throw CommandFailure(kWorkFailed, "astar on " + scene + ": cost " +
                                          std::to_string(chain.search_result().cost) +
                                          ", but Boost's is " + std::to_string(found.cost));
  }
  const auto run = [boost, &chain] {
    const auto& [start, goal] = boost->queries[boost->next++ % boost->queries.size()];
    static_cast<void>(boost->search.Search(chain.map(), start, goal));
  };
  peers.push_back(std::make_unique<PeerRun>(PeerRun{.name = "boost", .run = run}));
#endif
  return peers;
}

PeerRuns OptimizerPeers([[maybe_unused]] const StageChain& chain) {
  PeerRuns peers;
#ifdef HARDPACK_HAS_CERES
  constexpr int kMostIterations = 100;
  const auto add = [&peers, &chain](const char* name, peers::CeresMethod method) {
    peers.push_back(std::make_unique<PeerRun>(PeerRun{.name = name, .run = {}}));
    PeerRun* const peer = peers.back().get();
    peer->run = [peer, &chain, method] {
      const auto smoothed = peers::Smooth(method, chain.map(), chain.params().optimizer,
                                          chain.seed(), 0.0f, false, kMostIterations);
      peer->path_cost = double{smoothed.after.total()};
    };
  };
  add("ceres_trust_region", peers::CeresMethod::kTrustRegion);
  add("ceres_line_search", peers::CeresMethod::kLineSearch);
#endif
  return peers;
}

}  // namespace hardpack::command
