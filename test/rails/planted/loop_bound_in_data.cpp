// SPDX-License-Identifier: Apache-2.0
int planted = 3;

int* Planted() {
#if __SIZEOF_POINTER__ == 8
  asm volatile(".pushsection .note.hardpack.loops,\"\",%note\n.quad planted, 3, 1\n.popsection");
#else
  asm volatile(".pushsection .note.hardpack.loops,\"\",%note\n.long planted, 3, 1\n.popsection");
#endif
  return &planted;
}
