#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs a build to a fresh prefix, builds the consumer against it alone, and runs it.
#   install_and_run.sh BUILD_DIR WORK_DIR CXX
set -eu
source=$(cd "$(dirname "$0")" && pwd)
build=$1
work=$2
rm -rf "$work"
mkdir -p "$work"
cmake --install "$build" --prefix "$work/prefix" --component development >"$work/install.log"
# A copy outside the project's tree: a header that is found must be an installed one.
cp "$source/CMakeLists.txt" "$source/main.cpp" "$work"
cmake -S "$work" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$3" \
  -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_CXX_FLAGS="-Wall -Wextra -Werror"
cmake --build "$work/build"
"$work/build/plan"
