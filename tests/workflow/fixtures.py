# SPDX-License-Identifier: BSD-3-Clause
"""What tests of the fleet without Snakemake have in common."""
from __future__ import annotations

import os
import pathlib
import tempfile
import unittest


class InFolder(unittest.TestCase):
    def setUp(self) -> None:
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name).resolve()

    def write(self, name: str, text: str = "x") -> pathlib.Path:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path


ENGINE = """#!/usr/bin/python3
import json, pathlib, subprocess, sys
folder = pathlib.Path(sys.argv[sys.argv.index("--directory") + 1])
for name, job in json.loads((folder / "plan.json").read_text())["jobs"].items():
    if all((folder / "done" / other).exists() for other in job["after"]):
        if not (folder / "done" / name).exists():
            subprocess.run([sys.executable, "-m", "headway_fleet.job", "plan.json", name], cwd=folder)
"""


class WithEngine(InFolder):
    """A stand-in for Snakemake, which runs one job after the other."""

    def setUp(self) -> None:
        super().setUp()
        self.write("engine/snakemake", ENGINE).chmod(0o755)
        path = os.environ["PATH"]
        os.environ["PATH"] = f"{self.folder / 'engine'}:{path}"
        self.addCleanup(lambda: os.environ.update(PATH=path))
