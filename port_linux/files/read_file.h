// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "port_linux/files/read_outcome.h"

namespace hardpack {

// The whole content of a file of at most max_bytes. kInvalidArgument: cannot be opened or read, or
// is a directory; kOversized: is larger (nothing beyond the limit is read, so an endless file does
// no harm). On failure `text` is empty.
ReadOutcome ReadFile(const std::string& path, size_t max_bytes, std::string& text);

}  // namespace hardpack
