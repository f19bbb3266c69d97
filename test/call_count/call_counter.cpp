// SPDX-License-Identifier: Apache-2.0
#include "test/call_count/call_counter.h"

#include <cxxabi.h>
#include <dlfcn.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/base/loop_bound.h"
#include "core/measurements/measurements.h"

namespace hardpack {
namespace timing {
namespace {

// A function's loop in no other one of it, and how often it has been gone round in all.
struct Loop {
  int line = 0;
  unsigned long long bound = 0;
  uint64_t rounds = 0;
};

struct Function {
  std::string name;
  uint64_t calls = 0;
  std::vector<Loop> loops;
  std::vector<size_t> facts;  // that are of one call of it
};

struct Fact {
  Counted what;
  size_t within;
  size_t of;
  uint64_t calls_before = 0;  // the call that is under way
  std::vector<Loop> loops_before;
  uint64_t most_calls = 0;
  std::vector<Loop> most_rounds;
  uint64_t entered = 0;
};

constexpr int kNobody = -1;  // no function of a fact

// A function that is being called.
struct Frame {
  int which = kNobody;
  int open_loops = 0;
};

struct Known {
  const void* address = nullptr;  // nullptr: free
  int which = kNobody;
};
constexpr size_t kPlaces = 1u << 14;  // several times the functions there are

// Plain arrays: the hooks run at each of hundreds of millions of calls.
constexpr int kMostOpen = 256;
Known g_known[kPlaces];  // by address, open addressing
Frame g_open[kMostOpen];
int g_opened = 0;  // the innermost is the last of them

struct State {
  std::vector<Function> functions;
  std::vector<Fact> facts;
};

State& state() {
  static State instance;
  return instance;
}

size_t FunctionNamed(const std::string& name) {
  std::vector<Function>& all = state().functions;
  const auto found =
      std::find_if(all.begin(), all.end(), [&name](const Function& f) { return f.name == name; });
  if (found != all.end()) return static_cast<size_t>(found - all.begin());
  all.push_back({name, 0, {}, {}});
  return all.size() - 1;
}

// Of one that the program exports; a neighbour's name is nobody's.
std::string NameOf(const void* address) {
  Dl_info info{};
  if (dladdr(address, &info) == 0 || info.dli_saddr != address) return "";
  int status = 0;
  char* const whole = abi::__cxa_demangle(info.dli_sname, nullptr, nullptr, &status);
  const std::string name = status == 0 ? whole : "";
  std::free(whole);
  return name.substr(0, name.find('('));
}

int WhichNamed(const std::string& name) {
  const std::vector<Function>& all = state().functions;
  for (size_t i = 0; i < all.size(); ++i) {
    if (all[i].name == name) return static_cast<int>(i);
  }
  return kNobody;
}

int WhichIs(const void* address) {
  const uint64_t hash = reinterpret_cast<uintptr_t>(address) * 0x9e3779b97f4a7c15u;
  size_t at = static_cast<size_t>(hash >> 40) % kPlaces;
  while (g_known[at].address != address) {
    if (g_known[at].address == nullptr) {
      g_known[at] = {address, WhichNamed(NameOf(address))};
      break;
    }
    at = (at + 1) % kPlaces;
  }
  return g_known[at].which;
}

void Begin(Function& function) {
  ++function.calls;
  for (const size_t i : function.facts) {
    Fact& fact = state().facts[i];
    const Function& of = state().functions[fact.of];
    fact.calls_before = of.calls;
    fact.loops_before = of.loops;
    ++fact.entered;
  }
}

void KeepMost(const std::vector<Loop>& before, const std::vector<Loop>& now,
              std::vector<Loop>& most) {
  most.resize(now.size());
  for (size_t i = 0; i < now.size(); ++i) {
    const uint64_t rounds = now[i].rounds - (i < before.size() ? before[i].rounds : 0);
    most[i] = {now[i].line, now[i].bound, std::max(most[i].rounds, rounds)};
  }
}

void End(const Function& function) {
  for (const size_t i : function.facts) {
    Fact& fact = state().facts[i];
    const Function& of = state().functions[fact.of];
    fact.most_calls = std::max(fact.most_calls, of.calls - fact.calls_before);
    KeepMost(fact.loops_before, of.loops, fact.most_rounds);
  }
}

void Enter(const void* address) {
  const int which = WhichIs(address);
  if (g_opened == kMostOpen) std::abort();
  g_open[g_opened++] = {which, 0};
  if (which >= 0) Begin(state().functions[static_cast<size_t>(which)]);
}

void Leave() {
  const int which = g_open[--g_opened].which;
  if (which >= 0) End(state().functions[static_cast<size_t>(which)]);
}

void EnterLoop() {
  if (g_opened > 0) ++g_open[g_opened - 1].open_loops;
}

void LeaveLoop(int line, unsigned long long bound, unsigned long long rounds) {
  if (g_opened == 0) return;
  Frame& frame = g_open[g_opened - 1];
  if (--frame.open_loops > 0 || frame.which < 0) return;
  std::vector<Loop>& loops = state().functions[static_cast<size_t>(frame.which)].loops;
  auto loop = std::find_if(loops.begin(), loops.end(),
                           [line](const Loop& one) { return one.line == line; });
  if (loop == loops.end()) loop = loops.insert(loop, {line, 0, 0});
  loop->bound = std::max(loop->bound, bound);
  loop->rounds += rounds;
}

uint64_t RoundsOfLargest(const std::vector<Loop>& loops) {
  const auto largest = std::max_element(
      loops.begin(), loops.end(), [](const Loop& a, const Loop& b) { return a.bound < b.bound; });
  return largest == loops.end() ? 0 : largest->rounds;
}

}  // namespace

void Count(Counted what, const std::string& within, const std::string& of) {
  const Fact fact = {what, FunctionNamed(within), FunctionNamed(of), 0, {}, 0, {}, 0};
  state().functions[fact.within].facts.push_back(state().facts.size());
  state().facts.push_back(fact);
}

void PrintCounts() {
  for (const Fact& fact : state().facts) {
    const bool calls = fact.what == Counted::kCalls;
    const uint64_t most = calls ? fact.most_calls : RoundsOfLargest(fact.most_rounds);
    std::printf("%s %s %s %llu %llu\n", calls ? "calls" : "rounds",
                state().functions[fact.within].name.c_str(),
                state().functions[fact.of].name.c_str(), static_cast<unsigned long long>(most),
                static_cast<unsigned long long>(fact.entered));
  }
}

}  // namespace timing

// Bounds are held elsewhere (test/loop_count): here only the sums matter.
void LoopCounter::SetBeams(int) {}
void LoopCounter::LessTheBeamsLacking() {
  inner_ = 0;
}
void LoopCounter::Enter() {
  inner_from_ = 0;
  timing::EnterLoop();
}
void LoopCounter::AddToOuter(const LoopCounter&) const {}
void LoopCounter::Record() const {
  timing::LeaveLoop(line_, bound_, count_);
}
void LoopCounter::Exceed() const {
  std::fprintf(stderr, "%s:%d: more rounds than its bound of %llu\n", file_, line_, bound_);
  std::abort();
}

}  // namespace hardpack

// What the compiler calls at the beginning and the end of each function.
extern "C" {
void __cyg_profile_func_enter(void* function, void* call_site);
void __cyg_profile_func_exit(void* function, void* call_site);
void __cyg_profile_func_enter(void* function, void*) {
  hardpack::timing::Enter(function);
}
void __cyg_profile_func_exit(void*, void*) {
  hardpack::timing::Leave();
}
}
