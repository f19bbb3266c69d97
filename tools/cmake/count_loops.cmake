# SPDX-License-Identifier: Apache-2.0
# The counting build: every loop of core and hal held to its HP_LOOP_BOUND
# (docs/decisions/0002-loop-bounds.md).
#   ON    in copies of core and hal that their tests link as well (test/loop_count), beside those
#         without; a third more of a build's time
#   ONLY  in core and hal themselves, whoever uses them: tests, tools, the onboard program. Counting
#         changes no outcome (test/loop_count), so nothing is built twice
set(HARDPACK_COUNT_LOOPS OFF CACHE STRING
  "Every loop of core and hal held to its bound: OFF, ON (in copies of them for their tests) or ONLY")
set_property(CACHE HARDPACK_COUNT_LOOPS PROPERTY STRINGS OFF ON ONLY)
set(loop_count ${PROJECT_SOURCE_DIR}/test/loop_count)

# The redefined keywords make else branches, which -Wall is about; it goes behind hardpack_options,
# since to clang the last option counts.
add_library(redefined_keywords INTERFACE)
target_compile_options(redefined_keywords INTERFACE -Wno-dangling-else -Wno-misleading-indentation)

add_library(loop_counter_options INTERFACE)
target_compile_options(loop_counter_options INTERFACE -O2)
if(HARDPACK_SANITIZE)
  target_compile_options(loop_counter_options INTERFACE -fno-sanitize=all)
endif()
add_library(loop_counter OBJECT EXCLUDE_FROM_ALL ${loop_count}/loop_counter.cpp)
target_include_directories(loop_counter PRIVATE ${PROJECT_SOURCE_DIR})
target_compile_definitions(loop_counter PRIVATE HP_COUNT_LOOPS)
# Called at every loop's beginning and end: optimised, and no sanitizer looks at it.
target_link_libraries(loop_counter PRIVATE hardpack_options loop_counter_options)
if(HARDPACK_FUZZ)
  target_compile_definitions(loop_counter PRIVATE HP_REWARD_NEARNESS)
endif()

# Comes before every source of core and hal, and is compiled once.
if(HARDPACK_COUNT_LOOPS STREQUAL "ONLY")
  add_library(counted_stage INTERFACE)
  target_compile_definitions(counted_stage INTERFACE HP_COUNT_LOOPS)
  target_link_libraries(counted_stage INTERFACE
    hardpack_core_options hardpack_eigen redefined_keywords)
  if(HARDPACK_FUZZ)  # test/fuzz
    target_compile_options(counted_stage INTERFACE
      -fsanitize=fuzzer-no-link -fno-sanitize-coverage=trace-cmp)
  endif()
  add_library(counted_stage_headers OBJECT ${PROJECT_SOURCE_DIR}/test/test_headers.cpp)
  target_include_directories(counted_stage_headers PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(counted_stage_headers PRIVATE counted_stage)
  target_precompile_headers(counted_stage_headers PRIVATE ${loop_count}/count_loops.h)
  set_property(GLOBAL APPEND PROPERTY hardpack_core_objects $<TARGET_OBJECTS:loop_counter>)
endif()
