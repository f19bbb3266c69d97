#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Headers as Doxygen is to read them: our plain // comments as its comments.

usage: doxygen_filter.py OUT FILE...

Writes each FILE to OUT/FILE, with
  - the comment between the includes and the namespace as the description of the file,
  - each // comment on lines of its own as the documentation of what follows it,
  - each // comment behind code as the documentation of what stands before it.
What Doxygen would take for a command or for HTML is escaped, but not in `code`; a drawing or an
equation (indented, behind an empty comment line) is shown as it is. The lines keep their numbers.
Exit code: 0 done, 1 a file cannot be read or written, 2 bad usage.
"""

import pathlib
import re
import sys

WHOLE = re.compile(r"^(\s*)//(?!/)\s?(.*)$")
# Behind code; not in a string: no header has "//" in one.
BEHIND = re.compile(r"^(\s*\S.*?)\s+//(?!/)\s?(.*)$")
DECLARATIONS = ("namespace", "template", "class", "struct", "enum", "inline", "constexpr")
SPECIAL = re.compile(r"[\\@<>#%]")


def escaped(text):
    """`text` with nothing special outside of `code`."""
    parts = text.split("`")
    parts[::2] = [SPECIAL.sub(lambda m: "\\" + m.group(), part) for part in parts[::2]]
    return "`".join(parts)


def with_drawings(comments):
    """The texts of a comment on lines of its own, its drawings between \\code and \\endcode."""
    out = []
    in_drawing = False
    for i, text in enumerate(comments):
        following = comments[i + 1] if i + 1 < len(comments) else ""
        if not in_drawing and text == "" and following.startswith("   "):
            in_drawing = True
            out.append(r"\code{.unparsed}")
        elif in_drawing and following == "":
            in_drawing = False
            out.append(text + r" \endcode")
        else:
            out.append(text if in_drawing else escaped(text))
    return out


def filtered(lines):
    """The lines as Doxygen is to read them."""
    out = []
    in_body = False  # behind the file's first declaration
    behind_column = None  # where a comment behind code began, on the line before
    line_number = 0
    while line_number < len(lines):
        line = lines[line_number]
        line_number += 1
        whole = WHOLE.match(line)
        behind = BEHIND.match(line)
        in_body = in_body or line.startswith(DECLARATIONS)
        if whole and len(whole.group(1)) == behind_column:
            out.append(f"{whole.group(1)}///< {escaped(whole.group(2))}")
            continue
        behind_column = None
        if whole and whole.group(2).startswith("SPDX"):
            out.append("")
        elif whole:
            indent = whole.group(1)
            comments = [whole.group(2)]
            while line_number < len(lines) and (more := WHOLE.match(lines[line_number])):
                comments.append(more.group(2))
                line_number += 1
            if not in_body and out[-1] == "":
                out[-1] = r"/// \file"
            out.extend(f"{indent}/// {text}" for text in with_drawings(comments))
        elif behind and not behind.group(1).lstrip().startswith(("#", "}")):
            behind_column = line.index("//", len(behind.group(1)))
            out.append(f"{behind.group(1)}  ///< {escaped(behind.group(2))}")
        else:
            out.append(line)
    return out


def main():
    if len(sys.argv) < 3:
        print(__doc__, file=sys.stderr)
        return 2
    out = pathlib.Path(sys.argv[1])
    try:
        for name in sys.argv[2:]:
            lines = pathlib.Path(name).read_text(encoding="utf-8").splitlines()
            (out / name).parent.mkdir(parents=True, exist_ok=True)
            (out / name).write_text("\n".join(filtered(lines)) + "\n", encoding="utf-8")
    except OSError as error:
        print(f"doxygen_filter: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
