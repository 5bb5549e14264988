#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Prints counts of the code of every library and of the programs:
#   files      .cpp and .h
#   code       lines without blanks and comments
#   comments   lines of comments alone, licences apart, in relation to them and the code [%]
#   constants  named numeric constants: kName, const or constexpr, of an arithmetic type or a duration
#   literals   floating-point literals other than 0, 0.5, 1 and 2, those of the constants included
# Fails if it counts its own example wrongly. Usage: counts.sh SOURCE_DIR
set -eu
exec python3 - "$1" <<'PYTHON'
import pathlib
import re
import sys

# Strings come first, so that what looks like a comment in them is none; digits may be apart by '.
TOKEN = re.compile(r"""R"(?P<end>[^(\s]*)\(.*?\)(?P=end)"|"(?:\\.|[^"\\\n])*"|(?<!\w)'(?:\\.|[^'\\\n])+'"""
                   r"""|(?P<comment>//[^\n]*|/\*.*?\*/)""", re.S)
CONSTANT = re.compile(r"\b(?:const|constexpr)\s+(?:(?:unsigned|long)\s+)*(?:double|float|int|short|long|unsigned|auto"
                      r"|char(?=\s+k\w+\s*=\s*[\d'])|(?:std::)?(?:size_t|ptrdiff_t|u?int(?:8|16|32|64|max)_t)|Time"
                      r"|std::chrono::\w+(?:<[^;={]*>)?)\s+(k[A-Z]\w*\s*[={(][^;]*);")
DECLARATOR = re.compile(r"(?:^|,\s*)k[A-Z]\w*\s*[={(]")
LITERAL = re.compile(r"(?<![\w.])(?:\d[\d']*\.[\d']*|\.\d[\d']*|\d[\d']*(?=[eE]))(?:[eE][+-]?\d+)?[fFlL]?(?![\w.])")
COLUMNS = ("files", "code", "comments", "constants", "literals")


def count(text: str) -> list[int]:
    """The columns of one file."""
    text = re.sub(r"//[^\n]*SPDX-License-Identifier[^\n]*\n", "", text, count=1)
    comment_lines = 0

    def blank(match: re.Match) -> str:
        nonlocal comment_lines
        token = match[0]
        if match["comment"] is None:
            # A string is code on each of its lines.
            return "\n".join('""' for _ in token.split("\n"))
        lines = token.split("\n")
        before = text[text.rfind("\n", 0, match.start()) + 1:match.start()]
        after = text[match.end():].split("\n", 1)[0]
        comment_lines += sum(1 for line in lines if line.strip())
        if before.strip() or (after.strip() and len(lines) == 1):
            comment_lines -= 1
        return "\n" * (len(lines) - 1) or " "

    code = TOKEN.sub(blank, text)
    constants = sum(len(DECLARATOR.findall(m[1])) for m in CONSTANT.finditer(code))
    literals = [float(m[0].replace("'", "").rstrip("fFlL")) for m in LITERAL.finditer(code)]
    return [1, sum(1 for line in code.split("\n") if line.strip()), comment_lines, constants,
            sum(1 for value in literals if value not in (0.0, 0.5, 1.0, 2.0))]


def added(rows: list[list[int]]) -> list[int]:
    return [sum(column) for column in zip(*rows)] if rows else [0] * len(COLUMNS)


EXAMPLE = r'''// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Two lines of
/// comment, 3.25.
namespace a {
/* one that
   has 4.5 /* in it */
constexpr double kOne = 1.5, kTwo = 2.0;  // 7.5 beside code
const std::size_t kThree = 1'000;
constexpr std::chrono::milliseconds kPause(100);
constexpr const char* kName = "no // comment, 8.5";
constexpr char kSlash = '/';  // a name for a character is none for a number
const char* text = R"(raw 9.5

// text)";
const double half = 0.5f + 1e-3 + .25F + 2 + 1.0 + 3. + 0x1p3;
double kept(int k3) { return k3 == 6 ? 1'2.5 : 2.0; }
}  // namespace a
'''
EXPECTED = [1, 13, 4, 4, 5]


def main() -> int:
    if count(EXAMPLE) != EXPECTED:
        print(f"counts.sh: its example has {dict(zip(COLUMNS, EXPECTED))}, counted {count(EXAMPLE)}")
        return 1
    root = pathlib.Path(sys.argv[1])
    groups = {}
    for folder in sorted(root.glob("libs/*/*")) + sorted(root.glob("apps")):
        files = [f for end in ("*.cpp", "*.h") for f in folder.rglob(end)]
        if files:
            groups[folder.name] = added([count(f.read_text(encoding="utf-8")) for f in files])
    if not groups:
        print(f"{root}: contains no sources in libs or apps")
        return 1
    groups["all"] = added(list(groups.values()))
    print(f"{'':<12}" + "".join(f"{name:>10}" for name in COLUMNS))
    for name, (files, code, comments, constants, literals) in groups.items():
        ratio = f"{100 * comments / (code + comments):.1f} %"
        print(f"{name:<12}{files:>10}{code:>10}{ratio:>10}{constants:>10}{literals:>10}")
    return 0


sys.exit(main())
PYTHON
