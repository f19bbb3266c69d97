// SPDX-License-Identifier: Apache-2.0
// What the counting build does with its counts: stops at a loop that runs more often than it says,
// and, at the end of the program, adds a line `file:line bound largest_count` for each loop that
// was entered to the file that the environment variable HARDPACK_LOOP_REPORT names. A loop has a
// line a program run (ctest runs each test on its own) and a line a bound; the largest counts.
//
//   HARDPACK_LOOP_REPORT=/tmp/loops ctest -R counted/ && tools/proof/loop_report.py /tmp/loops
//
// For libFuzzer (HP_REWARD_NEARNESS, test/fuzz) it also says how near each loop came to its bound:
// an input that brings one nearer is new to it, though no other code was reached, and is built
// upon.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "core/base/loop_bound.h"
#include "core/measurements/measurements.h"

namespace hardpack {
namespace {

struct Site {
  const char* file = nullptr;  // null: free
  int line = 0;
  uint32_t number = 0;  // in the order of their first entries, which is the same in every run
  unsigned long long bound = 0;
  unsigned long long largest = 0;
};

constexpr int kMostOpen = 64;
constexpr int kMostSums = 256;

struct InnerSum {
  const char* file = nullptr;
  int line = 0;
  unsigned long long count = 0;
};

constexpr uint32_t kSites = 4096;  // a power of two, several times the loops there are

Site g_sites[kSites];
uint32_t g_sites_used = 0;

void WriteReport() {
  const char* name = std::getenv("HARDPACK_LOOP_REPORT");
  std::FILE* report = name == nullptr ? nullptr : std::fopen(name, "a");
  if (report == nullptr) return;
  std::setvbuf(report, nullptr, _IOLBF, BUFSIZ);  // whole lines, whoever else writes
  for (const Site& site : g_sites) {
    if (site.file == nullptr || site.line < 0) continue;  // free, or a sum's
    std::fprintf(report, "%s:%d %llu %llu\n", site.file, site.line, site.bound, site.largest);
  }
  std::fclose(report);
}

[[noreturn]] void Stop() {
  std::fflush(nullptr);
  std::abort();
}

// Open addressing; the file by its address: one header may have several, one a translation unit.
Site& SiteOf(const char* file, int line, unsigned long long bound) {
  uint64_t hash = reinterpret_cast<uintptr_t>(file);
  hash = (hash ^ static_cast<uint64_t>(line) ^ (bound << 20)) * 0x9e3779b97f4a7c15u;
  uint32_t at = static_cast<uint32_t>(hash >> 40) % kSites;
  while (g_sites[at].file != nullptr) {
    Site& site = g_sites[at];
    if (site.file == file && site.line == line && site.bound == bound) return site;
    at = (at + 1) % kSites;
  }
  if (++g_sites_used == kSites) {
    std::fprintf(stderr, "loop_count: more than %u loops: raise kSites\n", kSites);
    Stop();
  }
  if (g_sites_used == 1) std::atexit(WriteReport);
  g_sites[at] = {file, line, g_sites_used - 1, bound, 0};
  return g_sites[at];
}

#if defined(HP_REWARD_NEARNESS)
// Of a byte libFuzzer tells eight values apart, and clears all of them before each input.
constexpr uint8_t kTellable[] = {1, 2, 3, 4, 8, 16, 32, 128};
constexpr unsigned kLevelsPerByte = sizeof(kTellable);
constexpr unsigned kLevelsBytes = 4;
__attribute__((section("__libfuzzer_extra_counters"))) uint8_t g_nearness[kSites][kLevelsBytes];

// Sixteenths of the bound up to its half, then whenever what lacks is halved: near the bound, where
// it matters, every step is told apart.
unsigned NearnessOf(unsigned long long count, unsigned long long bound) {
  constexpr unsigned long long kSteps = 16;
  constexpr unsigned kMost = kLevelsPerByte * kLevelsBytes - 1;
  if (count < bound - count) return static_cast<unsigned>(count * kSteps / bound);
  const auto halvings =
      static_cast<unsigned>(std::bit_width(bound) - std::bit_width(bound - count));
  return std::min<unsigned>(kSteps / 2 + halvings, kMost);
}

void Reward(const Site& site, unsigned long long count) {
  if (count == 0 || count > site.bound) return;
  const unsigned level = NearnessOf(count, site.bound);
  uint8_t& byte = g_nearness[site.number][level / kLevelsPerByte];
  byte = std::max(byte, kTellable[level % kLevelsPerByte]);
}

// A sum has a place beside its loop's own: that of the line's negative, which no loop has.
void RewardSum(const InnerSum& sum, unsigned long long bound) {
  Reward(SiteOf(sum.file, -sum.line, bound), sum.count);
}
#else
void Reward(const Site&, unsigned long long) {}
void RewardSum(const InnerSum&, unsigned long long) {}
#endif

}  // namespace

// Loops that are gone round now, from the outermost; sums of those that are directly inside one
// with a bound for them.
thread_local const LoopCounter* g_open[kMostOpen];
thread_local int g_opened = 0;
thread_local InnerSum g_sums[kMostSums];
thread_local int g_summed = 0;
thread_local int g_beams = kMaxBeams;

void LoopCounter::SetBeams(int beams) {
  g_beams = beams;
}

void LoopCounter::LessTheBeamsLacking() {
  const auto lacking = static_cast<unsigned long long>(kMaxBeams - g_beams);
  bound_ = bound_ > lacking ? bound_ - lacking : 0;
  if (inner_ > 0) inner_ = inner_ > lacking ? inner_ - lacking : 0;
}

void LoopCounter::Enter() {
  if (g_opened == kMostOpen) {
    std::fprintf(stderr, "loop_count: more than %d loops in each other\n", kMostOpen);
    Stop();
  }
  g_open[g_opened++] = this;
  inner_from_ = g_summed;
}

// To the sum of the loop of that line, of those around it that have a bound for the ones inside.
void LoopCounter::AddToOuter(const LoopCounter& outer) const {
  int at = outer.inner_from_;
  while (at < g_summed && (g_sums[at].file != file_ || g_sums[at].line != line_)) ++at;
  if (at == kMostSums) {
    std::fprintf(stderr, "loop_count: more than %d sums\n", kMostSums);
    Stop();
  }
  if (at == g_summed) g_sums[g_summed++] = {file_, line_, 0};
  g_sums[at].count += count_;
  if (g_sums[at].count <= outer.inner_) return RewardSum(g_sums[at], outer.inner_);
  std::fprintf(stderr, "%s:%d: the loop runs more often than %llu in all of that of %s:%d\n", file_,
               line_, outer.inner_, outer.file_, outer.line_);
  Stop();
}

void LoopCounter::Record() const {
  --g_opened;
  g_summed = inner_from_;
  const LoopCounter* outer = g_opened > 0 ? g_open[g_opened - 1] : nullptr;
  if (outer != nullptr && outer->inner_ > 0) AddToOuter(*outer);
  Site& site = SiteOf(file_, line_, bound_);
  if (count_ > site.largest) site.largest = count_;
  Reward(site, count_);
}

void LoopCounter::Exceed() const {
  std::fprintf(stderr, "%s:%d: the loop runs more often than its bound of %llu\n", file_, line_,
               bound_);
  Stop();
}

}  // namespace hardpack
