# SPDX-License-Identifier: Apache-2.0
# Bare-metal Cortex-M7 with a single-precision FPU; programs run on QEMU's mps2-an500 board. The
# start-up code and the linker script that a program needs are in test/bare_metal.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR cortex-m7)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
include(${CMAKE_CURRENT_LIST_DIR}/analysable_flags.cmake)
list(JOIN HARDPACK_ANALYSABLE_FLAGS " " analysable)
set(CMAKE_CXX_FLAGS_INIT
  "-mcpu=cortex-m7 -mthumb -mfpu=fpv5-sp-d16 -mfloat-abi=hard ${analysable} \
-fcallgraph-info=su,da -fstack-usage")  # the compiler's own account of frames and calls
set(CMAKE_CROSSCOMPILING_EMULATOR
  qemu-system-arm -M mps2-an500 -nographic -monitor none -serial none
  -semihosting-config enable=on,target=native -kernel)

# There is no system to link a compiler test against.
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)

set(CMAKE_FIND_ROOT_PATH /usr/lib/arm-none-eabi)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
