#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs clang-tidy (.clang-tidy) over the sources, two at a time.
#   tools/proof/check_tidy.sh BUILD_DIR [FOLDER...]      default: core hal port_linux
# BUILD_DIR is a configured build: its compile_commands.json says how each file is compiled.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
if [ $# -lt 1 ] || [ ! -f "$1/compile_commands.json" ]; then
  echo "usage: tools/proof/check_tidy.sh BUILD_DIR [FOLDER...]" >&2
  exit 2
fi
commands=$(mktemp -d)
trap 'rm -rf "$commands"' EXIT
# The loop-counting build compiles the same files again, with a macro that is not the real one; and
# clang reads no precompiled header of g++.
python3 - "$1/compile_commands.json" >"$commands/compile_commands.json" <<'TEXT'
import json, re, sys
entries = [e for e in json.load(open(sys.argv[1])) if "-DHP_COUNT_LOOPS" not in e["command"]]
for entry in entries:
    entry["command"] = re.sub(r"-Winvalid-pch -include \S+/cmake_pch\.hxx", "", entry["command"])
json.dump(entries, sys.stdout)
TEXT
shift
[ $# -gt 0 ] || set -- core hal port_linux
for folder; do
  find "$root/$folder" -name '*.cpp' -print0
done | xargs -0 -n 2 -P 2 \
  clang-tidy-14 -p "$commands" --quiet --extra-arg=-Wno-unknown-warning-option
