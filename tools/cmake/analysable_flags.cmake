# SPDX-License-Identifier: Apache-2.0
# What tools/proof/wcet needs of g++ 12 to bound what it compiles (docs/decisions/0029):
# no jumps through tables, loops that stay one loop with the record that stands before them (two that
# share its iterations are bounded as one, two that do them all are not), no loop that becomes a call of
# memset; and debug information, which tells whose line a jump is of.
set(HARDPACK_ANALYSABLE_FLAGS -g -fno-jump-tables -fno-reorder-blocks-and-partition
  -fno-tree-loop-distribution -fno-tree-loop-distribute-patterns -fno-thread-jumps
  -fno-split-loops -fno-unswitch-loops -fno-predictive-commoning)
