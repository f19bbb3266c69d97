#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tools/docs.sh [--out DIR] [--help]

Builds the reference of the public headers (core, hal, config, port_linux) and of docs/ with Doxygen:
DIR/index.html (default build/docs). A comment that Doxygen cannot parse and a broken link are errors.

Exit code: 0 done, 1 Doxygen warned, 2 bad usage or doxygen is not installed (tools/packages.txt).
TEXT
}

root=$(cd "$(dirname "$0")/.." && pwd)
out=$root/build/docs
while [ $# -gt 0 ]; do
  case $1 in
    --out) out=${2:?--out needs a folder}; shift ;;
    --help | -h) usage; exit 0 ;;
    *) echo "docs.sh: unknown option $1" >&2; usage >&2; exit 2 ;;
  esac
  shift
done
if ! command -v doxygen >/dev/null; then
  echo "docs.sh: doxygen is not installed; tools/check.sh --deps installs it" >&2
  exit 2
fi
mkdir -p "$out"
out=$(cd "$out" && pwd)
sources=$(mktemp -d)
trap 'rm -rf "$sources"' EXIT
cd "$root"
find core hal config port_linux -name '*.h' -print0 |
  xargs -0 python3 tools/docs/doxygen_filter.py "$sources"
cp -r docs ./*.md tools/docs/reference.css "$sources"
cd "$sources"
if ! doxygen - < <(cat "$root/tools/docs/Doxyfile"; printf 'OUTPUT_DIRECTORY = "%s"\n' "$out") 2>&1 |
  sed "s|$sources/||g"; then
  echo "docs.sh: Doxygen warned (above)" >&2
  exit 1
fi
echo "$out/index.html"
