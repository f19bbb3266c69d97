#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds the sources to the layers and to the rules of core and hal that no compiler checks.

usage: tools/proof/check_layers.py [ROOT]

Prints one line a finding, `file:line: rule: what to do instead`, and exits 1 when there is one.
Which stage may use which is read from the hp_stage() lines of core and hal: the list that builds
the libraries is the list that the includes are held to.
"""

import pathlib
import re
import sys

import tree_check

SOURCE_SUFFIXES = (".h", ".cpp")
MAX_FILE_LINES = 500
MAX_FUNCTION_LINES = 60

# What a layer may include from the project. `test` is used by nothing.
LAYERS = {
    "core": ("core", "config"),
    "hal": ("hal", "core", "config"),
    "port_linux": ("port_linux", "hal", "core", "config"),
    "config": ("config",),
    "tools": ("tools", "port_linux", "hal", "core", "config"),
    "test": ("test", "tools", "port_linux", "hal", "core", "config"),
}
STRICT_LAYERS = ("core", "hal")
SIZED_LAYERS = ("core", "hal", "config", "port_linux", "tools")

STD_HEADERS = ("array", "bit", "concepts", "cstddef", "cstdint", "limits", "span", "type_traits")

MATH = ("acos|asin|atan|atan2|cbrt|ceil|cos|cosh|exp|exp2|expm1|fabs|fdim|floor|fma|fmax|fmin|fmod|"
        "frexp|hypot|ldexp|llrint|llround|log|log10|log1p|log2|lrint|lround|modf|nearbyint|pow|"
        "remainder|rint|round|sin|sincos|sinh|sqrt|tan|tanh|trunc")
CONTAINERS = ("any|basic_string|deque|forward_list|function|list|make_shared|make_unique|map|"
              "multimap|multiset|optional|priority_queue|queue|set|shared_ptr|stack|string|"
              "string_view|unique_ptr|unordered_map|unordered_set|variant|vector")

# (rule, pattern, what to do instead), for the text without comments, strings and directives.
FORBIDDEN = [
    ("heap", r"\bnew\b", "no heap: make it a member of an object that the caller owns"),
    ("heap", r"(?<!= )\bdelete\b", "no heap: nothing here is owned by pointer"),
    ("heap", r"\b(malloc|calloc|realloc|free|alloca|strdup)\s*\(",
     "no heap: make it a member of an object that the caller owns"),
    ("exceptions", r"\b(throw|try|catch)\b", "return a Status or a Result"),
    ("container", rf"\bstd::({CONTAINERS})\b", "use core/base/fixed_vector.h, an array or a span"),
    ("libm", rf"\bstd::({MATH})[fl]?\b", "use core/base/math.h or core/base/saturate.h"),
    ("libm", rf"(?<![\w:.>])(::)?({MATH})[fl]?\s*\(",
     "use core/base/math.h or core/base/saturate.h"),
    ("rtti", r"\b(dynamic_cast|typeid)\b", "no RTTI: say it with a type or an enum"),
    ("virtual-destructor", r"\bvirtual\s+~",
     "make the interface's destructor protected and not virtual"),
    ("cast", r"\breinterpret_cast\b", "read bytes with ByteReader, bits with std::bit_cast"),
    ("union", r"\bunion\b", "use std::bit_cast for bits, two members for two things"),
    ("goto", r"\bgoto\b", "return early, or make it a loop"),
    ("thread", r"\b(thread_local|std::(atomic|mutex|thread))\b", "core and hal are single-threaded"),
    ("double", r"\bdouble\b", "single precision only: float"),
    ("do-loop", r"\bdo\b", "write it as a for or while with HP_LOOP_BOUND"),
    ("assert", r"(?<![\w:])assert\s*\(", "use HP_ASSERT"),
]
# Builtins and assembly have one home.
BUILTIN = re.compile(r"\b(__builtin_\w+|asm|__asm__)\b")
BUILTIN_HOME = "core/base/"
# And so has the parser of TOML: a file with another copy of its inline functions would undo what is
# mended there.
TOML_HOME = "port_linux/files/toml_parser.h"

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
STAGE = re.compile(r"hp_stage\(\s*(\w+)\s+([\w/]+)([^)]*)\)")
CONTROL = re.compile(r"\b(if|for|while|switch|else|do|HP_LOOP_BOUND\w*)\b")
TYPE_OR_SCOPE = re.compile(r"\b(namespace|class|struct|enum|union|extern)\b")


class Finding:
    def __init__(self, path, line, rule, advice):
        self.path, self.line, self.rule, self.advice = path, line, rule, advice

    def __str__(self):
        return f"{self.path}:{self.line}: {self.rule}: {self.advice}"


def strip(text):
    """The text with comments and the insides of literals blanked; same length, same lines."""
    pattern = re.compile(
        r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])+'", re.S)
    return pattern.sub(lambda m: re.sub(r"[^\n]", " ", m.group()), text)


def without_directives(text):
    """Blanks preprocessor lines, continuations included."""
    return re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", lambda m: re.sub(r"[^\n]", " ", m.group()),
                  text, flags=re.M)


def line_of(text, position):
    return text.count("\n", 0, position) + 1


def matching(text, position, step):
    """The position of the bracket that belongs to the one at `position`, or -1."""
    pairs = {"(": ")", "{": "}", ")": "(", "}": "{"}
    own, other = text[position], pairs[text[position]]
    depth = 0
    while 0 <= position < len(text):
        depth += (text[position] == own) - (text[position] == other)
        if depth == 0:
            return position
        position += step
    return -1


def read_stages(root):
    """{layer: {stage: set of stages it may use, itself included}}, transitively closed."""
    direct = {"core": {}, "hal": {}}
    for layer in direct:
        lists = root / layer / "CMakeLists.txt"
        if not lists.exists():
            continue
        for owner, name, rest in STAGE.findall(re.sub(r"#.*", "", lists.read_text())):
            words = rest.split()
            direct[owner][name] = set(words[words.index("DEPENDS") + 1:] if words else ())

    def close(layer, name, seen):
        for used in direct[layer].get(name, ()):
            home = layer if used in direct[layer] else "core"
            if (home, used) not in seen:
                seen.add((home, used))
                close(home, used, seen)
        return seen

    return {layer: {name: close(layer, name, {(layer, name)}) for name in names}
            for layer, names in direct.items()}


def stage_of(path):
    """(layer, stage) of a file: ("hal", "onboard/control"); of one in the layer itself the stage is ""."""
    layer, *folders, _ = path.split("/")
    return layer, "/".join(folders)


def check_includes(root, path, text, stages):
    layer, stage = stage_of(path)
    findings = []

    def report(line, rule, advice):
        findings.append(Finding(path, line, rule, advice))

    if layer in STRICT_LAYERS and stage and stage not in stages[layer]:
        report(1, "stage", f"declare it: hp_stage({layer} {stage} DEPENDS ...) in "
                           f"{layer}/CMakeLists.txt")
    for number, line in enumerate(text.splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        system, name = match.group(1) == "<", match.group(2)
        if system:
            if name.startswith("toml++/"):
                if path != TOML_HOME:
                    report(number, "toml", f"include {TOML_HOME}, which mends the library")
            elif name.startswith("Eigen/"):
                if layer in STRICT_LAYERS and not (path.startswith("core/odometry/")
                                                   and path.endswith(".cpp")):
                    report(number, "eigen", "Eigen is private to the .cpp files of core/odometry")
            elif layer in STRICT_LAYERS and name not in STD_HEADERS:
                report(number, "std-header", f"<{name}> is not among the allowed headers: "
                                             + " ".join(STD_HEADERS))
            continue
        target = name.split("/")
        if ".." in target or len(target) < 2 or target[0] not in LAYERS:
            if not (layer == "test" or layer == "tools"):
                report(number, "include-home", "name the file from the project's root: "
                                               "\"core/base/status.h\"")
            continue
        if not (root / name).exists():
            report(number, "include-home", f"there is no {name}")
        if target[0] not in LAYERS[layer]:
            report(number, "layer", f"{layer} may not use {target[0]}: pass the data in, or move "
                                    f"the code to a layer that may")
        elif layer in STRICT_LAYERS and target[0] in STRICT_LAYERS and len(target) > 2:
            allowed = stages[layer].get(stage, set())
            used = stage_of(name)
            if stage and used not in allowed:
                report(number, "stage", f"{layer}/{stage} does not depend on {'/'.join(used)}; "
                                        "only core/autonomy sees all stages")
    return findings


def check_words(path, code):
    findings = []
    for rule, pattern, advice in FORBIDDEN:
        for match in re.finditer(pattern, code):
            findings.append(Finding(path, line_of(code, match.start()), rule, advice))
    # std's at(index) throws; an at(row, column) of ours has two arguments.
    for match in re.finditer(r"(\.|->)at\s*\(", code):
        end = matching(code, match.end() - 1, 1)
        depth = commas = 0
        for letter in code[match.end():end]:
            depth += letter in "({[" 
            depth -= letter in ")}]"
            commas += letter == "," and depth == 0
        if commas == 0:
            findings.append(Finding(path, line_of(code, match.start()), "at",
                                    "it throws: use [] after a check"))
    if not path.startswith(BUILTIN_HOME):
        for match in BUILTIN.finditer(code):
            findings.append(Finding(path, line_of(code, match.start()), "builtin",
                                    f"compiler builtins and assembly live in {BUILTIN_HOME}"))
    return findings


def check_loops(path, code):
    findings = []

    def report(position, advice):
        findings.append(Finding(path, line_of(code, position), "loop-bound", advice))

    for match in re.finditer(r"\b(for|while)\s*\(", code):
        before = code[:match.start()].rstrip()
        if code[code.rfind("\n", 0, match.start()) + 1:match.start()].strip():
            report(match.start(), "begin the loop on a line of its own")
        opening = matching(code, len(before) - 1, -1) if before.endswith(")") else -1
        if opening < 0 or not re.search(r"\bHP_LOOP_BOUND\w*\s*$", code[:opening]):
            report(match.start(), "put HP_LOOP_BOUND(n) on the line before this loop")
    for match in re.finditer(r"\bHP_LOOP_BOUND\w*\s*\(", code):
        end = matching(code, match.end() - 1, 1)
        if end < 0 or not re.match(r"\s*(for|while)\b", code[end + 1:]):
            report(match.start(), "HP_LOOP_BOUND belongs immediately before a loop")
        # The macro is a statement: without braces it, not the loop, would be the branch.
        before = code[:match.start()].rstrip()
        if before.endswith(")") or re.search(r"\belse$", before):
            report(match.start(), "put braces around a bounded loop that is a branch or a body")
    return findings


def functions(code):
    """(first line, last line) of each function body, by its braces."""
    found = []
    for match in re.finditer(r"\{", code):
        start = max(code.rfind(mark, 0, match.start()) for mark in ";{}") + 1
        # An initialiser's or a default argument's braces lie inside a signature; look further back.
        head = code[start:match.start()]
        if ")" not in head or TYPE_OR_SCOPE.search(head.split("(")[0]) or CONTROL.search(head):
            continue
        if re.search(r"=\s*$|\breturn\b|[,(]\s*$", head.rstrip() + " ") or "[" in head.split("(")[0]:
            continue
        end = matching(code, match.start(), 1)
        if end > 0:
            first = start + len(head) - len(head.lstrip())
            found.append((line_of(code, first), line_of(code, end)))
    return found


def check_shape(path, text, code):
    findings = []
    lines = text.splitlines()
    if not lines or lines[0] != "// SPDX-License-Identifier: Apache-2.0":
        findings.append(Finding(path, 1, "spdx",
                                "begin with // SPDX-License-Identifier: Apache-2.0"))
    if path.endswith(".h") and "#pragma once" not in lines:
        findings.append(Finding(path, 1, "pragma-once", "a header says #pragma once"))
    if path.split("/")[0] not in SIZED_LAYERS:
        return findings
    if len(lines) > MAX_FILE_LINES:
        findings.append(Finding(path, len(lines), "file-length",
                                f"{len(lines)} lines: split it, at most {MAX_FILE_LINES}"))
    for first, last in functions(code):
        if last - first + 1 > MAX_FUNCTION_LINES:
            findings.append(Finding(path, first, "function-length",
                                    f"{last - first + 1} lines: split it, at most "
                                    f"{MAX_FUNCTION_LINES}"))
    return findings


def folders_used(path, text):
    """{folder: line} of the project's other folders that a file includes."""
    used = {}
    for number, line in enumerate(text.splitlines(), 1):
        match = INCLUDE.match(line)
        folder = match and match.group(1) == '"' and match.group(2).rpartition("/")[0]
        if folder and folder != path.rpartition("/")[0] and folder.split("/")[0] in SIZED_LAYERS:
            used.setdefault(folder, number)
    return used


def check_circles(uses):
    """uses: {folder: {folder that it includes: (file, line)}}. One finding an arrow of a circle."""
    def reached(folder):
        seen, left = set(), [folder]
        while left:
            for used in uses.get(left.pop(), ()):
                if used not in seen:
                    seen.add(used)
                    left.append(used)
        return seen

    return [Finding(file, line, "circle", f"{used} uses {folder} too: move what both need")
            for folder, targets in uses.items() for used, (file, line) in targets.items()
            if folder in reached(used)]


def check_tree(root):
    root = pathlib.Path(root)
    stages = read_stages(root)
    findings, count, uses = [], 0, {}
    for layer in LAYERS:
        for file in sorted((root / layer).rglob("*")):
            if file.suffix not in SOURCE_SUFFIXES:
                continue
            path = file.relative_to(root).as_posix()
            text = file.read_text(encoding="utf-8")
            code = without_directives(strip(text))
            count += 1
            findings += check_includes(root, path, text, stages)
            if layer in SIZED_LAYERS:
                for used, line in folders_used(path, text).items():
                    uses.setdefault(path.rpartition("/")[0], {}).setdefault(used, (path, line))
            findings += check_shape(path, text, code)
            if layer in STRICT_LAYERS:
                findings += check_words(path, code)
                findings += check_loops(path, code)
    return findings + check_circles(uses), count


if __name__ == "__main__":
    sys.exit(tree_check.main("check_layers", __doc__, check_tree, sys.argv[1:]))
