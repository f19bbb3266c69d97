// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <boost/graph/graph_traits.hpp>
#include <boost/iterator/counting_iterator.hpp>
#include <boost/iterator/iterator_facade.hpp>
#include <cstdint>
#include <utility>

#include "core/costmap/costmap.h"

// A costmap as Boost.Graph sees it: an implicit graph of 8-connected cells that models its
// IncidenceGraph and VertexListGraph. A vertex is a cell's index. The edges out of a cell are
// derived on request, by core/astar's rules: to cells on the map that are not lethal, and
// diagonally only past two such cells.

namespace hardpack::peers {

// A step to a neighbour.
struct GridEdge {
  uint32_t from = 0;
  uint32_t direction = 0;  // anticlockwise from +x; the odd ones are diagonal
  bool operator==(const GridEdge&) const = default;
};

inline constexpr int32_t kGridStep[8] = {
    1,  kMapSize_cells + 1,  kMapSize_cells,  kMapSize_cells - 1,
    -1, -kMapSize_cells - 1, -kMapSize_cells, -kMapSize_cells + 1};

class GridEdgeIterator : public boost::iterator_facade<GridEdgeIterator, GridEdge,
                                                       boost::forward_traversal_tag, GridEdge> {
 public:
  GridEdgeIterator() = default;
  GridEdgeIterator(uint32_t from, uint32_t directions) : from_(from), directions_(directions) {}

 private:
  friend class boost::iterator_core_access;
  GridEdge dereference() const {
    return {from_, static_cast<uint32_t>(std::countr_zero(directions_))};
  }
  void increment() { directions_ &= directions_ - 1; }
  bool equal(const GridEdgeIterator& other) const { return directions_ == other.directions_; }

  uint32_t from_ = 0;
  uint32_t directions_ = 0;  // remaining, one bit each
};

class GridGraph {
 public:
  explicit GridGraph(const Costmap& map) : map_(&map) {}

  const Costmap& map() const { return *map_; }

  // One bit per direction: the steps allowed out of a cell.
  uint32_t DirectionsFrom(uint32_t cell) const {
    const uint32_t x = cell % kMapSize_cells;
    const uint32_t y = cell / kMapSize_cells;
    uint32_t blocked = 0;
    if (x - 1 < kMapSize_cells - 2 && y - 1 < kMapSize_cells - 2) {
      for (uint32_t i = 0; i < 8; ++i) blocked |= LethalBit(Neighbour(cell, i)) << i;
    } else {
      if (x == 0) blocked |= 0x38;
      if (x == kMapSize_cells - 1) blocked |= 0x83;
      if (y == 0) blocked |= 0xe0;
      if (y == kMapSize_cells - 1) blocked |= 0x0e;
      for (uint32_t i = 0; i < 8; ++i) {
        if ((blocked >> i & 1u) == 0) blocked |= LethalBit(Neighbour(cell, i)) << i;
      }
    }
    const uint32_t wrapped = blocked | blocked << 8;
    const uint32_t beside = (wrapped >> 1 | wrapped >> 7) & 0xaa;  // of the diagonal steps
    return ~(blocked | beside) & 0xff;
  }

  static uint32_t Neighbour(uint32_t cell, uint32_t direction) {
    return cell + static_cast<uint32_t>(kGridStep[direction]);
  }

 private:
  uint32_t LethalBit(uint32_t cell) const { return map_->Lethal(static_cast<int>(cell)) ? 1 : 0; }

  const Costmap* map_;
};

}  // namespace hardpack::peers

// Functions that Boost finds by name. NOLINTBEGIN(readability-identifier-naming)

template <>
struct boost::graph_traits<hardpack::peers::GridGraph> {
  struct traversal_category : incidence_graph_tag, vertex_list_graph_tag {};
  using directed_category = directed_tag;
  using edge_parallel_category = disallow_parallel_edge_tag;
  using vertex_descriptor = uint32_t;
  using edge_descriptor = hardpack::peers::GridEdge;
  using vertex_iterator = counting_iterator<uint32_t>;
  using out_edge_iterator = hardpack::peers::GridEdgeIterator;
  using vertices_size_type = uint32_t;
  using edges_size_type = uint32_t;
  using degree_size_type = uint32_t;
  static vertex_descriptor null_vertex() { return ~0u; }
};

namespace hardpack::peers {

inline uint32_t source(GridEdge edge, const GridGraph&) {
  return edge.from;
}

inline uint32_t target(GridEdge edge, const GridGraph&) {
  return GridGraph::Neighbour(edge.from, edge.direction);
}

inline std::pair<GridEdgeIterator, GridEdgeIterator> out_edges(uint32_t cell,
                                                               const GridGraph& graph) {
  return {GridEdgeIterator(cell, graph.DirectionsFrom(cell)), GridEdgeIterator(cell, 0)};
}

inline uint32_t out_degree(uint32_t cell, const GridGraph& graph) {
  return static_cast<uint32_t>(std::popcount(graph.DirectionsFrom(cell)));
}

inline std::pair<boost::counting_iterator<uint32_t>, boost::counting_iterator<uint32_t>> vertices(
    const GridGraph&) {
  return {boost::counting_iterator<uint32_t>(0), boost::counting_iterator<uint32_t>(kMapCells)};
}

inline uint32_t num_vertices(const GridGraph&) {
  return kMapCells;
}

}  // namespace hardpack::peers

// NOLINTEND(readability-identifier-naming)
