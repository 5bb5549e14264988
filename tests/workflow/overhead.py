#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures what the engine adds to the jobs: tests/workflow/overhead.py local|slurm [options].

Stand-ins for the programs sleep for --seconds a recording, so that the figure does not depend on
how fast the machine is: overhead = (time from start to page - ideal time) / ideal time, where the
ideal time is that of the recordings on the cores without any pause. On Slurm, two virtual nodes of
one core each.
"""
from __future__ import annotations

import argparse
import contextlib
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time

from small_slurm import SmallSlurm

FLEET = pathlib.Path(__file__).resolve().parents[2] / "workflow" / "headway-fleet"


def make_programs(folder: pathlib.Path, seconds: float) -> None:
    """headway-replay sleeps, also for what the others take; all succeed."""
    folder.mkdir()
    sleep = f'case "$*" in *--dump-config*) ;; *) mkdir -p "$5"; sleep {seconds};; esac'
    for name in ("import", "replay", "eval", "render"):
        program = folder / f"headway-{name}"
        program.write_text(f"#!/bin/bash\n{sleep if name == 'replay' else ''}\nexit 0\n",
                           encoding="utf-8")
        program.chmod(0o755)


def measure(options: argparse.Namespace, folder: pathlib.Path) -> None:
    make_programs(folder / "bin", options.seconds)
    recordings = folder / "recordings"
    recordings.mkdir()
    for i in range(options.recordings):
        (recordings / f"r{i:03}.rawlog").write_text(str(i), encoding="utf-8")
    cores = 2 if options.where == "slurm" else options.jobs
    where = ["--profile", "slurm"] if options.where == "slurm" else ["-j", str(options.jobs)]
    with contextlib.ExitStack() as stack:
        environment = dict(os.environ)
        if options.where == "slurm":
            environment = stack.enter_context(SmallSlurm(folder / "slurm", 26917)).environment
        start = time.time()
        subprocess.run([str(FLEET), str(recordings), "-o", str(folder / "out"), "-q", "--memory",
                        "500", "--programs", str(folder / "bin"), *where], env=environment,
                       check=True)
        taken = time.time() - start
    ideal = math.ceil(options.recordings / cores) * options.seconds
    print(f"{options.where}: {options.recordings} recordings of {options.seconds:g} s on {cores} "
          f"cores: {taken:.1f} s, ideal {ideal:.1f} s, overhead {100 * (taken / ideal - 1):.1f} %, "
          f"{3600 * options.recordings / taken:.0f} recordings/hour", flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("where", choices=("local", "slurm"))
    parser.add_argument("-j", "--jobs", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--recordings", type=int, default=20)
    with tempfile.TemporaryDirectory(prefix="headway-fleet-overhead-") as folder:
        measure(parser.parse_args(), pathlib.Path(folder))
    return 0


if __name__ == "__main__":
    sys.exit(main())
