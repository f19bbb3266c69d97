#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Everything that is promised, measured: see tools/proof/assure.py --help.
set -euo pipefail
exec python3 "$(dirname "$0")/assure.py" "$@"
