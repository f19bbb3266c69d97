// SPDX-License-Identifier: Apache-2.0
#pragma once

// Which commit was built: written by tools/cmake/revision.cmake.

namespace hardpack {

// As `git describe --always --dirty` has it; "unknown" where the sources came without git.
extern const char* const kRevision;

}  // namespace hardpack
