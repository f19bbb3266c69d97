#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds the hazard log, the requirements and the tests to each other, and prints which test shows what.

usage: tools/proof/check_requirements.py [ROOT]

docs/hazards.md has a table row for each hazard (HZ-nn), each requirement (SR-AAAnn, with the hazards
it is against) and each hazard that is not, or not wholly, protected against (with the assumption
AU-nn that it puts on the user); docs/safety_manual.md has a row for each assumption. A test says in a
comment directly above it (in Python also within it) which requirements it shows. Prints the matrix, then one line a finding,
`file:line: what is wrong`, and exits 1 when there is one.
"""

import collections
import pathlib
import re
import sys

HAZARDS, MANUAL = "docs/hazards.md", "docs/safety_manual.md"
ID = re.compile(r"\b(?:HZ|AU)-\d\d\b|\bSR-[A-Z]{3}\d\d\b")
ROW = re.compile(rf"\|\s*({ID.pattern})\s*\|")
NOT_PROTECTED = "## What is not protected"

# A test by its declaration, in the files whose comments begin so. What is disabled shows nothing.
CPP_TEST = re.compile(r"(?:TYPED_)?TEST(?:_F|_P)?\(\s*(\w+),\s*(?!DISABLED_)(\w+)\s*\)")
PYTHON_TEST = re.compile(r"()def (test_\w+)\(")
CMAKE_TEST = re.compile(r"()(?:add_test\(NAME|hp_planted\w*\(|hp_\w*test\()\s*([^\s)]+)")
KINDS = {".cpp": ("//", CPP_TEST), ".h": ("//", CPP_TEST), ".py": ("#", PYTHON_TEST),
         ".txt": ("#", CMAKE_TEST)}


class Log:
    """What the two pages say. Maps are from an id to what stands in its row."""

    def __init__(self, root):
        self.findings = []
        self.hazards, self.requirements, self.assumptions = {}, {}, {}  # -> the ids in its row
        self.unprotected = collections.defaultdict(set)  # hazard -> assumptions
        self.mentioned = []  # (place, id)
        for page in (HAZARDS, MANUAL):
            self.read(page, (root / page).read_text(encoding="utf-8"))

    def read(self, page, text):
        section = ""
        for number, line in enumerate(text.splitlines(), 1):
            place = f"{page}:{number}"
            section = line if line.startswith("## ") else section
            ids = ID.findall(line)
            self.mentioned += [(place, one) for one in ids]
            row = ROW.match(line)
            if not row:
                continue
            name, others = row.group(1), set(ids) - {row.group(1)}
            if name.startswith("HZ") and section == NOT_PROTECTED:
                self.unprotected[name] |= {one for one in others if one.startswith("AU")}
                continue
            rows = {"HZ": self.hazards, "SR": self.requirements, "AU": self.assumptions}[name[:2]]
            if name in rows:
                self.findings.append(f"{place}: {name} is there twice")
            rows[name] = (place, others)

    def known(self):
        return {**self.hazards, **self.requirements, **self.assumptions}

    def against(self, hazard):
        """The requirements that name the hazard."""
        return [name for name, (_, ids) in self.requirements.items() if hazard in ids]


def tests_of(path, text, findings):
    """(requirement, test, place) of every requirement in a comment directly above a test; or within
    one, where that is a Python function or a script that has none."""
    comment, declaration = KINDS[pathlib.Path(path).suffix]
    lines = text.splitlines()
    if path.endswith("_test.py") and not PYTHON_TEST.search(text):
        return [(one, pathlib.Path(path).name, f"{path}:{number}")
                for number, line in enumerate(lines, 1) if line.strip().startswith(comment)
                for one in re.findall(r"\bSR-\w+", line)]
    found, pending = [], []
    function, function_indent = None, 0  # the one that the line is in
    for number, line in enumerate(lines, 1):
        code, indent = line.strip(), len(line) - len(line.lstrip())
        if code.startswith(comment):
            pending += [(one, number) for one in re.findall(r"\bSR-\w+", code)]
            continue
        is_function = code.startswith(("def ", "class "))
        if not (pending or is_function) or code.startswith("@"):  # a decorator is its function's
            continue
        match = declaration.match(code + " " + "".join(lines[number:number + 1]).strip())
        test = match and (".".join(part for part in match.groups() if part), f"{path}:{number}")
        if is_function:
            function, function_indent = test, indent
        elif function and indent > function_indent:
            test = function
        for name, line_of_comment in pending:
            if test:
                found.append((name, *test))
            else:
                findings.append(f"{path}:{line_of_comment}: {name} stands above no test that runs")
        pending = []
    return found


def check(root):
    """(findings, the matrix: requirement -> tests)."""
    root = pathlib.Path(root)
    log = Log(root)
    findings, matrix = log.findings, collections.defaultdict(list)
    for file in sorted((root / "test").rglob("*")):
        if file.suffix in KINDS and file.is_file():
            path = file.relative_to(root).as_posix()
            for name, test, place in tests_of(path, file.read_text(encoding="utf-8"), findings):
                matrix[name].append(f"{test} ({place})")
                if name not in log.requirements:
                    findings.append(f"{place}: {test} names {name}, which {HAZARDS} does not have")
    for name, (place, ids) in log.requirements.items():
        if not matrix[name]:
            findings.append(f"{place}: {name} has no test")
        if not any(one.startswith("HZ") for one in ids):
            findings.append(f"{place}: {name} names no hazard")
    for name, (place, _) in log.hazards.items():
        if not log.against(name) and name not in log.unprotected:
            findings.append(f"{place}: {name} has no requirement and is not listed as not protected")
    used = set().union(*log.unprotected.values())
    for name, assumptions in log.unprotected.items():
        if not assumptions:
            findings.append(f"{HAZARDS}: {name} is not protected against, and names no assumption")
    for name, (place, _) in log.assumptions.items():
        if name not in used:
            findings.append(f"{place}: {name} belongs to no hazard")
    findings += [f"{place}: there is no {one}" for place, one in log.mentioned
                 if one not in log.known()]
    return findings, {name: matrix[name] for name in log.requirements}, log


def main(arguments):
    if any(a in ("-h", "--help") for a in arguments) or len(arguments) > 1:
        print(__doc__)
        return 0 if arguments and arguments[0] in ("-h", "--help") else 2
    findings, matrix, log = check(arguments[0] if arguments else ".")
    for name, tests in matrix.items():
        hazards = " ".join(sorted(one for one in log.requirements[name][1] if one[:2] == "HZ"))
        print(f"{name}  {hazards}")
        print("".join(f"    {test}\n" for test in tests), end="")
    for finding in findings:
        print(finding)
    print(f"check_requirements: {len(log.hazards)} hazards, {len(matrix)} requirements, "
          f"{sum(map(len, matrix.values()))} times shown by a test, {len(findings)} findings")
    return 1 if findings or not matrix else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
