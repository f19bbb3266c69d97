# SPDX-License-Identifier: Apache-2.0
# cmake -DSOURCE=<root> -DFILE=<file> -P revision.cmake: writes which commit is being built, where that
# has changed.
cmake_minimum_required(VERSION 3.22)
execute_process(COMMAND git describe --always --dirty --abbrev=12 --exclude "*"
  WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE revision ERROR_QUIET
  OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed)
if(failed OR revision STREQUAL "")
  set(revision unknown)
endif()
file(CONFIGURE OUTPUT ${FILE} @ONLY CONTENT
"#include \"port_linux/hardpackd/revision.h\"

namespace hardpack {

const char* const kRevision = \"@revision@\";

}  // namespace hardpack
")
