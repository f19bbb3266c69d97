#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Checks that sources are formatted as .clang-format says; prints each place that is not.
#   tools/proof/check_format.sh [FILE...]      without files: all of the project's own
#   tools/proof/check_format.sh --fix          formats all of the project's own
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
formatter=$(command -v clang-format-14 || true)
if [ -z "$formatter" ]; then
  echo "check_format: clang-format-14 is not installed (tools/check.sh --deps)" >&2
  exit 2
fi

own_sources() {
  find "$root/core" "$root/hal" "$root/port_linux" "$root/config" "$root/test" "$root/tools" \
    \( -name '*.h' -o -name '*.cpp' \) -not -path '*/planted/*' -print0
}

if [ "${1-}" = --fix ]; then
  own_sources | xargs -0 "$formatter" -i
elif [ $# -gt 0 ]; then
  "$formatter" --style="file:$root/.clang-format" --dry-run -Werror "$@"
else
  own_sources | xargs -0 "$formatter" --dry-run -Werror
fi
