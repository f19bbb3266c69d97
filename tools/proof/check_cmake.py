#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds the CMake files to the version that they say they need: 3.22, which Ubuntu 22.04 has.

usage: tools/proof/check_cmake.py [ROOT]

CMake does not tell: a newer one takes newer commands whatever cmake_minimum_required says. Prints one
line a finding and exits 1 when there is one. What is newer is from CMake's release notes.
"""

import json
import pathlib
import re
import subprocess
import sys

import tree_check

MINIMUM = (3, 22)
PRESETS = 3  # the version of CMakePresets.json that CMake 3.21 brought
NEWER = [
    (r"^\s*block\s*\(", "block() is of 3.25"),
    (r"\bPROPAGATE\b", "return(PROPAGATE) is of 3.25"),
    (r"^\s*cmake_file_api\s*\(", "cmake_file_api() is of 3.27"),
    (r"\$<(LINK_LIBRARY|LINK_GROUP):", "$<LINK_LIBRARY:> and $<LINK_GROUP:> are of 3.24"),
    (r"\$<(COMPILE_ONLY|PATH|LIST|BUILD_LOCAL_INTERFACE|QUOTE|TARGET_PROPERTY_EXISTS)[:>]",
     "this generator expression is of 3.24 or later"),
    (r"\bFIND_PACKAGE_ARGS\b|\bOVERRIDE_FIND_PACKAGE\b", "of FetchContent in 3.24"),
    (r"\bCOMPILE_WARNING_AS_ERROR\b", "COMPILE_WARNING_AS_ERROR is of 3.24"),
    (r"\b(FILE_SET|CXX_MODULES)\b", "file sets are of 3.23"),
    (r"\bVALIDATOR\b", "find_program(VALIDATOR) is of 3.25"),
    (r"^\s*add_library\s*\([^)]*\bSYSTEM\b|^\s*add_subdirectory\s*\([^)]*\bSYSTEM\b",
     "SYSTEM of a target or a folder is of 3.25"),
]


def cmake_files(root):
    names = subprocess.run(["git", "-C", root, "ls-files", "--", "*CMakeLists.txt", "*.cmake",
                            "*.cmake.in"], capture_output=True, text=True, check=False)
    if names.returncode == 0 and names.stdout:
        return [root / name for name in names.stdout.splitlines()]
    return [path for path in sorted(root.rglob("*")) if "build" not in path.relative_to(root).parts
            and (path.name == "CMakeLists.txt" or ".cmake" in path.suffixes)]


def check_file(path, name):
    found = []
    text = path.read_text("utf-8")
    for number, line in enumerate(text.splitlines(), 1):
        code = line.split("#")[0]
        needed = re.search(r"cmake_minimum_required\s*\(VERSION (\d+)\.(\d+)", code)
        if needed and tuple(map(int, needed.groups())) != MINIMUM:
            found.append(f"{name}:{number}: says {'.'.join(needed.groups())}: "
                         f"{'.'.join(map(str, MINIMUM))} everywhere")
        found += [f"{name}:{number}: {why}" for pattern, why in NEWER if re.search(pattern, code)]
    return found


def check_tree(root):
    files = cmake_files(root)
    found = []
    for path in files:
        found += check_file(path, path.relative_to(root).as_posix())
    presets = root / "CMakePresets.json"
    if presets.exists():
        content = json.loads(presets.read_text("utf-8"))
        if content["version"] > PRESETS:
            found.append(f"CMakePresets.json: version {content['version']}: at most {PRESETS}")
        needed = content.get("cmakeMinimumRequired", {})
        if (needed.get("major"), needed.get("minor")) != MINIMUM:
            found.append("CMakePresets.json: cmakeMinimumRequired is another version")
    return found, len(files)


if __name__ == "__main__":
    sys.exit(tree_check.main("check_cmake", __doc__, check_tree, sys.argv[1:]))
