# SPDX-License-Identifier: Apache-2.0
# cmake -DFILE=<file.cpp> -DNAMESPACE=<a::b> -DTEXTS=<kName>=<file>,... -P embed_text.cmake: writes a
# source with the text of each file as a std::string_view of that name.
cmake_minimum_required(VERSION 3.22)
set(content "// Written by tools/cmake/embed_text.cmake.\n#include <string_view>\n\nnamespace ${NAMESPACE} {\n")
string(REPLACE "," ";" texts "${TEXTS}")
foreach(text IN LISTS texts)
  string(REPLACE "=" ";" text "${text}")
  list(GET text 0 name)
  list(GET text 1 path)
  file(READ ${path} bytes HEX)
  string(LENGTH "${bytes}" digits)
  math(EXPR size "${digits} / 2")
  string(REGEX REPLACE "(..)" "'\\\\x\\1'," bytes "${bytes}")
  string(APPEND content "static constexpr char ${name}Bytes[] = {${bytes}};\n"
    "extern const std::string_view ${name};\n"
    "const std::string_view ${name}(${name}Bytes, ${size});\n")
endforeach()
string(APPEND content "}\n")
file(WRITE ${FILE} "${content}")
