#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs clang-tidy (.clang-tidy) over the sources, two at a time.
#   tools/proof/check_tidy.sh BUILD_DIR [FOLDER...]      default: core hal port_linux
# BUILD_DIR is a configured build: its compile_commands.json says how each file is compiled.
#
# A folder of core or hal is checked as one source that includes the folder's: what they all include
# is then read once. The port's folders have names that would meet in one source.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
if [ $# -lt 1 ] || [ ! -f "$1/compile_commands.json" ]; then
  echo "usage: tools/proof/check_tidy.sh BUILD_DIR [FOLDER...]" >&2
  exit 2
fi
database=$1/compile_commands.json
shift
[ $# -gt 0 ] || set -- core hal port_linux
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# clang-tidy takes the rules of the folder that a source is in, and of those above it.
mkdir "$work/core" "$work/hal"
cp "$root/.clang-tidy" "$work"
cp "$root/core/.clang-tidy" "$work/core"

# Writes the joined sources and the compile commands, and prints what is to be checked. The
# loop-counting build compiles the same files again, with a macro that is not the real one; and clang
# reads no precompiled header of g++.
cat >"$work/join.py" <<'TEXT'
import json, pathlib, re, sys

root, work, database = (pathlib.Path(argument) for argument in sys.argv[1:4])
folders = {}
for name in sys.argv[4:]:
    for source in sorted((root / name).resolve().rglob("*.cpp")):
        folders.setdefault(source.parent.relative_to(root), []).append(source)
entries = [e for e in json.loads(database.read_text()) if "-DHP_COUNT_LOOPS" not in e["command"]]
commands = {pathlib.Path(e["file"]): e for e in entries}
for entry in entries:
    entry["command"] = re.sub(r"-Winvalid-pch -include \S+/cmake_pch\.hxx", "", entry["command"])
for folder, sources in folders.items():
    if folder.parts[0] == "port_linux":
        print(*sources, sep="\n")
        continue
    joined = work / folder.parts[0] / ("_".join(folder.parts[1:]) + ".cpp")
    joined.write_text("".join(f'#include "{s.relative_to(root)}"\n' for s in sources))
    one = commands[sources[0]]
    entries.append({"directory": one["directory"], "file": str(joined),
                    "command": one["command"].replace(one["file"], str(joined))})
    print(joined)
(work / "compile_commands.json").write_text(json.dumps(entries))
TEXT
python3 "$work/join.py" "$root" "$work" "$database" "$@" >"$work/sources"
xargs -n 1 -P 2 clang-tidy-14 -p "$work" --quiet --checks=-bugprone-suspicious-include \
  --extra-arg=-Wno-unknown-warning-option <"$work/sources"
