# SPDX-License-Identifier: BSD-3-Clause
"""Runs the programs of doc/python.md, in order: document_test.py BIN_DIR RAWLOGS_DIR DOC_DIR."""

import os
import pathlib
import re
import sys
import tempfile

BIN, RAWLOGS, DOC = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
os.environ["PATH"] = f"{BIN}:{os.environ['PATH']}"

programs = re.findall(r"^```python\n(.*?)^```", (DOC / "python.md").read_text(), re.S | re.M)
assert len(programs) >= 5, "doc/python.md has lost its programs"
with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    for item in ("street.rawlog", "street.truth", "street_Images"):
        if (RAWLOGS / item).exists():
            os.symlink(RAWLOGS / item, item)
    names = {}  # as in a notebook, later programs use what earlier ones made
    for number, program in enumerate(programs):
        exec(compile(program, f"doc/python.md, program {number + 1}", "exec"), names)
    os.chdir("/")
