// SPDX-License-Identifier: Apache-2.0
#pragma once

// HP_LOOP_BOUND(n) goes immediately before every loop of core and hal, on a line of its own and
// without a semicolon. n is a compile-time constant: the largest number of times the loop's body
// can run each time the loop is entered.
//
//   HP_LOOP_BOUND(kMapRows)
//   for (int row = 0; row < rows; ++row) { ... }
//
// In a normal build it writes one record (address of the loop's entry, n, the macro's line) into
// the non-loaded section .note.hardpack.loops of the object file and adds no instruction. A static
// timing analyser reads the records from the linked image, where every inlined copy has its own. If
// several records are candidates, the line identifies the loop's: it is the line before the loop.
// The record of a loop in a template or an inline function joins that function's section group
// ("?"), so that the linker keeps or drops both together. In a counting build (test/loop_count) the
// same macros count the iterations instead and stop the test when a loop runs more often than
// stated. A loop without the macro does not compile there.
//
// HP_LOOP_BOUND_INNER(n, m) is used instead where the loops directly inside share their work among
// the iterations: during one entry of this loop, each of them iterates at most m times in total
// over all iterations. The second record goes into .note.hardpack.inner. Loops in called functions
// that are not inlined do not count.
//
//   HP_LOOP_BOUND_INNER(kRuns, kMapSize_cells)
//   while (left != 0) Fill(TakeRun(left));
//
// HP_LOOP_BOUND_BEAMS(n) and HP_LOOP_BOUND_INNER_BEAMS(n, m) go before a loop over the beams of the
// configured lidar: n and m are for kMaxBeams beams, and decrease by one for each beam fewer.
// .note.hardpack.beams records this, with kMaxBeams as the second word, so that the analyser can
// compute its bounds for a given number of beams. LoopCounter::SetBeams sets it in the counting
// build.
//
// During constant evaluation the macros do nothing.

#if defined(HP_COUNT_LOOPS)

namespace hardpack {

// Counts one loop's iterations during one entry. Its out-of-line members belong to the counting
// build (test/loop_count/loop_counter.cpp). During constant evaluation nothing is recorded, and one
// iteration too many is not a constant expression. Where functions are hooked (test/call_count) its
// own are excluded: a loop belongs to its function.
class LoopCounter {
 public:
  enum class Of { kAll, kBeams };
  [[gnu::no_instrument_function]] constexpr LoopCounter(unsigned long long bound, const char* file,
                                                        int line, unsigned long long inner = 0,
                                                        Of of = Of::kAll)
      : bound_(bound), inner_(inner), file_(file), line_(line) {
    if (__builtin_is_constant_evaluated()) return;
    if (of == Of::kBeams) LessTheBeamsLacking();
    Enter();
  }
  [[gnu::no_instrument_function]] constexpr ~LoopCounter() {
    if (!__builtin_is_constant_evaluated()) Record();
  }
  LoopCounter(const LoopCounter&) = delete;
  LoopCounter& operator=(const LoopCounter&) = delete;

  // Sets the beams of this thread's lidar, until the next call; kMaxBeams by default.
  static void SetBeams(int beams);

  // Called before each iteration. Returns true, so that it can be part of a condition.
  [[gnu::no_instrument_function]] constexpr bool Tick() {
    if (++count_ > bound_) Exceed();
    return true;
  }

 private:
  void LessTheBeamsLacking();
  void Enter();
  void AddToOuter(const LoopCounter& outer) const;
  void Record() const;
  [[noreturn]] void Exceed() const;

  unsigned long long bound_;
  unsigned long long inner_;  // 0: its inner loops have no total bound
  unsigned long long count_ = 0;
  const char* file_;
  int line_;
  int inner_from_ = 0;  // where its own inner sums begin
};

}  // namespace hardpack

#define HP_LOOP_BOUND(n) if (::hardpack::LoopCounter hp_loop{(n), __FILE__, __LINE__}; true)
#define HP_LOOP_BOUND_INNER(n, m) \
  if (::hardpack::LoopCounter hp_loop{(n), __FILE__, __LINE__, (m)}; true)
#define HP_LOOP_BOUND_BEAMS(n) HP_LOOP_BOUND_INNER_BEAMS(n, 0)
#define HP_LOOP_BOUND_INNER_BEAMS(n, m)                                     \
  if (::hardpack::LoopCounter hp_loop{(n), __FILE__, __LINE__, (m),         \
                                      ::hardpack::LoopCounter::Of::kBeams}; \
      true)

#else

#if __SIZEOF_POINTER__ == 8
#define HP_LOOP_BOUND_WORD ".quad"
#else
#define HP_LOOP_BOUND_WORD ".long"
#endif

#define HP_LOOP_BOUND_NUMBER(name, n) [name] "i"(static_cast<unsigned long>(n))

// A record of three words in one of the sections; records of the same place share a label.
#define HP_LOOP_BOUND_RECORD(kind, name)                                                     \
  ".pushsection .note.hardpack." kind ",\"?\",%%note\n" HP_LOOP_BOUND_WORD " 771b, %c[" name \
  "], %c[line]\n.popsection\n"

#define HP_LOOP_BOUND(n)                                                                 \
  if (!__builtin_is_constant_evaluated()) {                                              \
    asm volatile("771:\n" HP_LOOP_BOUND_RECORD("loops", "most")                          \
                 : /* no outputs */                                                      \
                 : HP_LOOP_BOUND_NUMBER(most, n), HP_LOOP_BOUND_NUMBER(line, __LINE__)); \
  }

#define HP_LOOP_BOUND_INNER(n, m)                                                  \
  if (!__builtin_is_constant_evaluated()) {                                        \
    asm volatile("771:\n" HP_LOOP_BOUND_RECORD("loops", "most")                    \
                     HP_LOOP_BOUND_RECORD("inner", "shared")                       \
                 : /* no outputs */                                                \
                 : HP_LOOP_BOUND_NUMBER(most, n), HP_LOOP_BOUND_NUMBER(shared, m), \
                   HP_LOOP_BOUND_NUMBER(line, __LINE__));                          \
  }

#define HP_LOOP_BOUND_BEAMS(n)                                                                \
  if (!__builtin_is_constant_evaluated()) {                                                   \
    asm volatile(                                                                             \
        "771:\n" HP_LOOP_BOUND_RECORD("loops", "most") HP_LOOP_BOUND_RECORD("beams", "beams") \
        : /* no outputs */                                                                    \
        : HP_LOOP_BOUND_NUMBER(most, n), HP_LOOP_BOUND_NUMBER(beams, ::hardpack::kMaxBeams),  \
          HP_LOOP_BOUND_NUMBER(line, __LINE__));                                              \
  }

#define HP_LOOP_BOUND_INNER_BEAMS(n, m)                                               \
  if (!__builtin_is_constant_evaluated()) {                                           \
    asm volatile("771:\n" HP_LOOP_BOUND_RECORD("loops", "most") HP_LOOP_BOUND_RECORD( \
                     "inner", "shared") HP_LOOP_BOUND_RECORD("beams", "beams")        \
                 : /* no outputs */                                                   \
                 : HP_LOOP_BOUND_NUMBER(most, n), HP_LOOP_BOUND_NUMBER(shared, m),    \
                   HP_LOOP_BOUND_NUMBER(beams, ::hardpack::kMaxBeams),                \
                   HP_LOOP_BOUND_NUMBER(line, __LINE__));                             \
  }

#endif
