#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs the installed programs where the sources that they come from are hidden: without_sources.sh
# SOURCES PREFIX, in a mount name space of its own (unshare -rm).
set -eu
mount -t tmpfs none "$1"
cd "$2"
bin/hardpack experiment open --runs 1 --jobs 1 --out runs >runs.md
bin/hardpackctl --help >/dev/null
# It says which keys have no default.
if bin/hardpackd --check-config share/hardpack/warthog.toml 2>check.txt; then exit 1; fi
grep -q "must be set" check.txt
echo "installed: runs without its sources"
