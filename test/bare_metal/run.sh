#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Runs a program of hp_bare_metal on the board that it is for, each instruction taking the same time
# (instruction_clock.h). Arguments: the program, and its command line. Its exit code is the program's.
set -euo pipefail
program=$1
argument=${2-}
case $(od -An -tu2 -j18 -N2 "$program" | tr -d ' ') in  # the ELF file's machine
  40) board=(qemu-system-arm -M mps2-an500 -icount shift=7) ;;
  183) board=(qemu-system-aarch64 -M virt -cpu cortex-a72 -nic none -icount shift=4) ;;
  *) echo "run.sh: no board for $program" >&2; exit 2 ;;
esac
exec "${board[@]}" -nographic -monitor none -serial none \
  -semihosting-config "enable=on,target=native,arg=$argument" -kernel "$program" </dev/null
