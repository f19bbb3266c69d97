# SPDX-License-Identifier: Apache-2.0
# Options that give the same bits everywhere and keep the promises of core and hal.

# Whatever is compiled: warnings are errors, and no operation is fused or reassociated.
add_library(hardpack_options INTERFACE)
target_compile_options(hardpack_options INTERFACE
  -Wall -Wextra -Wconversion -Werror
  -ffp-contract=off -fno-math-errno)
if(HARDPACK_SANITIZE)
  target_compile_options(hardpack_options INTERFACE
    -fsanitize=${HARDPACK_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(hardpack_options INTERFACE -fsanitize=${HARDPACK_SANITIZE})
  if(HARDPACK_NO_SANITIZE)
    target_compile_options(hardpack_options INTERFACE -fno-sanitize=${HARDPACK_NO_SANITIZE})
  endif()
endif()

# core and hal besides: no exceptions, no RTTI, single precision, small static stack frames.
add_library(hardpack_core_options INTERFACE)
target_link_libraries(hardpack_core_options INTERFACE hardpack_options)
target_compile_options(hardpack_core_options INTERFACE
  -fno-exceptions -fno-rtti -Wdouble-promotion -Wvla -Walloca)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # A sanitizer's instrumentation grows the frames; they are judged in every other build.
  if(NOT HARDPACK_SANITIZE)
    target_compile_options(hardpack_core_options INTERFACE -Wstack-usage=512)
  endif()
endif()
# What flies on an aarch64 is bounded as it is (docs/timing.md); a Cortex-M7's toolchain has the options
# for whatever it compiles.
if(CMAKE_CROSSCOMPILING AND CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
  include(${CMAKE_CURRENT_LIST_DIR}/analysable_flags.cmake)
  # A path that is split there enters a loop behind its header.
  target_compile_options(hardpack_core_options INTERFACE ${HARDPACK_ANALYSABLE_FLAGS}
    -fno-split-paths)
endif()

# hp_joined(<target> [<sources a batch>])
#   compiles several of a target's sources as one (eight unless told), where headers such as JSON's and
#   the templates of them take most of the time: a name of an anonymous name space is then of all of
#   them. A source that cannot be has SKIP_UNITY_BUILD_INCLUSION.
function(hp_joined target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON)
  if(ARGC GREATER 1)
    set_target_properties(${target} PROPERTIES UNITY_BUILD_BATCH_SIZE ${ARGV1})
  endif()
endfunction()

# Eigen, for core/odometry/covariance.cpp alone: headers only, the host's serve every target. Without
# vectors and without a heap; what it does in loops is unrolled.
find_path(HARDPACK_EIGEN_DIR Eigen/Core PATHS /usr/include/eigen3 /usr/local/include/eigen3
  NO_CMAKE_FIND_ROOT_PATH REQUIRED)
add_library(hardpack_eigen INTERFACE)
target_include_directories(hardpack_eigen SYSTEM INTERFACE ${HARDPACK_EIGEN_DIR})
target_compile_definitions(hardpack_eigen INTERFACE EIGEN_DONT_VECTORIZE EIGEN_NO_MALLOC EIGEN_NO_IO
  EIGEN_CACHEFRIENDLY_PRODUCT_THRESHOLD=32 EIGEN_UNROLLING_LIMIT=400)
