#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Fails if a document of a folder links to a file, or to a heading of a document, that is not there.

    tests/style/document_links.py FOLDER
"""
import pathlib
import re
import sys

LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
BLOCK = re.compile(r"^```.*?^```", re.M | re.S)


def anchors(document: pathlib.Path) -> set[str]:
    """Names of the headings, as GitHub makes them."""
    text = BLOCK.sub("", document.read_text(encoding="utf-8"))
    headings = re.findall(r"^#+ (.*)$", text, re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def fault_of(document: pathlib.Path, link: str) -> str:
    """What is wrong with a link, or nothing; addresses elsewhere are not looked at."""
    if re.match(r"[a-z]+:", link):
        return ""
    name, _, anchor = link.partition("#")
    target = document.parent / name if name else document
    if not target.exists():
        return "there is no such file"
    if anchor and target.suffix == ".md" and anchor not in anchors(target):
        return "there is no such heading"
    return ""


def main() -> int:
    root = pathlib.Path(sys.argv[1])
    documents = sorted([*root.glob("*.md"), *root.glob("doc/**/*.md")])
    faults = 0
    for document in documents:
        for link in LINK.findall(BLOCK.sub("", document.read_text(encoding="utf-8"))):
            fault = fault_of(document, link)
            if fault:
                print(f"{document}: {link}: {fault}")
                faults += 1
    if len(documents) < 3:
        print(f"only {len(documents)} documents were found in {root}")
    return 1 if faults or len(documents) < 3 else 0


if __name__ == "__main__":
    sys.exit(main())
