// SPDX-License-Identifier: Apache-2.0
#include "core/base/loop_bound.h"
#include "test/timing/kernels/kernels.h"

// Graphs, grids and dynamic programming.

namespace hardpack::timing::kernels {

constexpr int kNodes = 24;
constexpr int32_t kFar = 1 << 28;

// On a matrix of weights, the nearest node looked for in an array.
[[gnu::noinline]] void DijkstraOnAnArray() {
  bool is_done[kNodes];
  HP_LOOP_BOUND(kNodes)
  for (int node = 0; node < kNodes; ++node) {
    is_done[node] = false;
    out[node] = node == 0 ? 0 : kFar;
  }
  HP_LOOP_BOUND(kNodes)
  for (int round = 0; round < kNodes; ++round) {
    int nearest = -1;
    HP_LOOP_BOUND(kNodes)
    for (int node = 0; node < kNodes; ++node) {
      if (!is_done[node] && (nearest < 0 || out[node] < out[nearest])) nearest = node;
    }
    is_done[nearest] = true;
    HP_LOOP_BOUND(kNodes)
    for (int node = 0; node < kNodes; ++node) {
      const int32_t way = out[nearest] + in[nearest * kNodes + node];
      if (way < out[node]) out[node] = way;
    }
  }
}

[[gnu::noinline]] void AllShortestWays() {
  constexpr int kSide = 12;
  HP_LOOP_BOUND(kSide)
  for (int by = 0; by < kSide; ++by) {
    HP_LOOP_BOUND(kSide)
    for (int from = 0; from < kSide; ++from) {
      HP_LOOP_BOUND(kSide)
      for (int to = 0; to < kSide; ++to) {
        const int32_t way = in[from * kSide + by] + in[by * kSide + to];
        if (way < in[from * kSide + to]) in[from * kSide + to] = way;
      }
    }
  }
}

void FillZeros() {
  for (int32_t& number : in) number = 0;
}

// Of an empty grid: each cell is taken once.
[[gnu::noinline]] void BreadthFirstSearch() {
  constexpr int kSide = 16;
  int32_t* const queue = out + 512;
  int first = 0;
  int end = 1;
  queue[0] = 0;
  in[0] = 1;
  HP_LOOP_BOUND(kSide * kSide)
  while (first < end) {
    const int cell = queue[first++];
    const int x = cell % kSide;
    const int y = cell / kSide;
    HP_LOOP_BOUND(4)
    for (int side = 0; side < 4; ++side) {
      const int next_x = x + (side == 0 ? 1 : 0) - (side == 1 ? 1 : 0);
      const int next_y = y + (side == 2 ? 1 : 0) - (side == 3 ? 1 : 0);
      if (next_x < 0 || next_x >= kSide || next_y < 0 || next_y >= kSide) continue;
      const int next = next_y * kSide + next_x;
      if (in[next] != 0) continue;
      in[next] = in[cell] + 1;
      queue[end++] = next;
    }
  }
  out[0] = end;
}

[[gnu::noinline]] void EditDistance() {
  constexpr int kLength = 24;
  constexpr int kWidth = kLength + 1;
  HP_LOOP_BOUND(kWidth)
  for (int k = 0; k <= kLength; ++k) {
    out[k] = k;
    out[k * kWidth] = k;
  }
  HP_LOOP_BOUND(kLength)
  for (int row = 1; row <= kLength; ++row) {
    HP_LOOP_BOUND(kLength)
    for (int column = 1; column <= kLength; ++column) {
      const int at = row * kWidth + column;
      int32_t least = out[at - kWidth - 1] + (in[row] == in[512 + column] ? 0 : 1);
      if (out[at - 1] + 1 < least) least = out[at - 1] + 1;
      if (out[at - kWidth] + 1 < least) least = out[at - kWidth] + 1;
      out[at] = least;
    }
  }
}

[[gnu::noinline]] void Knapsack() {
  constexpr int kThings = 16;
  constexpr int kRoom = 128;
  HP_LOOP_BOUND(kRoom + 1)
  for (int room = 0; room <= kRoom; ++room) out[room] = 0;
  HP_LOOP_BOUND(kThings)
  for (int thing = 0; thing < kThings; ++thing) {
    const int weight = 1 + (in[thing] & 7);
    HP_LOOP_BOUND(kRoom)
    for (int room = kRoom; room >= weight; --room) {
      const int32_t with = out[room - weight] + in[100 + thing];
      if (with > out[room]) out[room] = with;
    }
  }
}

[[gnu::noinline]] void GameOfLife() {
  constexpr int kSide = 16;
  HP_LOOP_BOUND(kSide - 2)
  for (int y = 1; y < kSide - 1; ++y) {
    HP_LOOP_BOUND(kSide - 2)
    for (int x = 1; x < kSide - 1; ++x) {
      int32_t around = -(in[y * kSide + x] & 1);
      HP_LOOP_BOUND(3)
      for (int dy = -1; dy <= 1; ++dy) {
        HP_LOOP_BOUND(3)
        for (int dx = -1; dx <= 1; ++dx) around += in[(y + dy) * kSide + x + dx] & 1;
      }
      const bool lives = around == 3 || (around == 2 && (in[y * kSide + x] & 1) != 0);
      out[y * kSide + x] = lives ? 1 : 0;
    }
  }
}

const Kernel kGraphKernels[] = {
    {"DijkstraOnAnArray", FillRandom, DijkstraOnAnArray},
    {"AllShortestWays", FillRandom, AllShortestWays},
    {"BreadthFirstSearch", FillZeros, BreadthFirstSearch},
    {"EditDistance", FillRandom, EditDistance},
    {"Knapsack", FillRandom, Knapsack},
    {"GameOfLife", FillRandom, GameOfLife},
    {},
};

}  // namespace hardpack::timing::kernels
