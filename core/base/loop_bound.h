// SPDX-License-Identifier: Apache-2.0
#pragma once

// HP_LOOP_BOUND(n) stands immediately before every loop of core and hal, on a line of its own and
// without a semicolon. n is a compile-time constant: the largest number of times the loop's body
// can run each time the loop is entered.
//
//   HP_LOOP_BOUND(kMapRows)
//   for (int row = 0; row < rows; ++row) { ... }
//
// In a normal build it writes one record (address of the loop's entry, n, the macro's line) into
// the non-loaded section .note.hardpack.loops of the object file and no instruction at all; a
// static timing analyser reads the records from the linked image, in which every inlined copy has
// its own, and knows by the line which of several records is a loop's: that of the line before it.
// The record of a template's or an inline function's loop joins that function's section group
// ("?"), so that the linker keeps and drops both together.
// In a counting build (test/loop_count) the same words count the iterations instead and stop the
// test when a loop runs more often than it says. A loop without the macro does not compile there.
//
// HP_LOOP_BOUND_INNER(n, m) stands there instead where the loops directly inside share their work
// among the iterations: each of them iterates at most m times in one entry of this loop, all its
// iterations together. The second record goes into .note.hardpack.inner; what a called function
// loops that is not inlined is not meant.
//
//   HP_LOOP_BOUND_INNER(kRuns, kMapSize_cells)
//   while (left != 0) Fill(TakeRun(left));
//
// HP_LOOP_BOUND_BEAMS(n) and HP_LOOP_BOUND_INNER_BEAMS(n, m) stand before a loop over the beams of
// the lidar that is configured: n, and m, are of kMaxBeams beams, and one less for each that it
// lacks. .note.hardpack.beams tells so, with kMaxBeams as the second word, so that the analyser can
// be told of how many beams its bounds are to be. The counting build is told by
// LoopCounter::SetBeams.
//
// During constant evaluation none of this happens.

#if defined(HP_COUNT_LOOPS)

namespace hardpack {

// Counts one loop's iterations during one entry. Its out-of-line members are the counting build's
// (test/loop_count/loop_counter.cpp). During constant evaluation nothing is recorded, and one
// iteration too many is not a constant expression. Where functions are hooked (test/call_count) its
// own are not: a loop is its function's.
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

  // Of this thread's lidar, until the next call; kMaxBeams without one.
  static void SetBeams(int beams);

  // Before each iteration. Returns true, so that it can stand in a condition.
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
  unsigned long long inner_;  // 0: its inner loops have no bound in all
  unsigned long long count_ = 0;
  const char* file_;
  int line_;
  int inner_from_ = 0;  // of the inner loops' sums, where its own begin
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

// A record of three words in one of the sections; those of one place stand behind the same label.
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
