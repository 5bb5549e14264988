# SPDX-License-Identifier: BSD-3-Clause
"""Runs a plan by Snakemake, here or through a profile."""
from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from typing import Callable

from .errors import FleetError
from .job import RECORD, failure_record, stamp
from .plan import STATE, Plan, result_folder

WORKFLOW = Path(__file__).resolve().parent.parent
_PROFILES = {"slurm": WORKFLOW / "slurm"}
_POLL_S = 1.0


def run_engine(plan: Plan, cores: int | None, profile: str, watch: Callable[[], None]) -> None:
    """Runs the jobs that have no stamp, and calls `watch` once a second until the end.

    The engine's own output is in `.fleet/engine.log`. Failures of jobs are in their records.
    Raises FleetError if Snakemake is missing.
    """
    if shutil.which("snakemake") is None:
        raise FleetError("snakemake: is not installed; apt-get install --no-install-recommends "
                         "snakemake")
    _forget_failures(plan)
    plan.write()
    state = plan.settings.out / STATE
    command = ["snakemake", "--snakefile", str(WORKFLOW / "Snakefile"), "--directory", str(state),
               "--keep-going", "--nolock", "--rerun-incomplete", "--rerun-triggers", "mtime",
               "--scheduler", "greedy", "--nocolor", *_where(cores, profile)]
    environment = dict(os.environ)
    path = environment.get("PYTHONPATH")
    environment["PYTHONPATH"] = f"{WORKFLOW}{os.pathsep + path if path else ''}"
    (state / "logs").mkdir(parents=True, exist_ok=True)
    with (state / "engine.log").open("ab") as log:
        process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT,
                                   stdin=subprocess.DEVNULL, env=environment)
        _wait(process, watch)


def usable_memory_mb() -> int:
    """Of this machine, for all jobs that run at once."""
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 1_000_000
    return memory * 9 // 10


def _where(cores: int | None, profile: str) -> list[str]:
    if not profile:
        return ["--cores", str(cores or os.cpu_count() or 1), "--resources",
                f"mem_mb={usable_memory_mb()}"]
    folder = _PROFILES.get(profile, Path(profile))
    if not (folder / "config.yaml").is_file():
        raise FleetError(f"{profile}: is no profile of Snakemake (a folder with config.yaml); "
                         f"shipped: {', '.join(_PROFILES)}")
    return ["--profile", str(folder.resolve()), *(["--jobs", str(cores)] if cores else [])]


def _wait(process: subprocess.Popen[bytes], watch: Callable[[], None]) -> None:
    """Until the end; an interrupt (Ctrl-C, SIGTERM) ends the engine and its jobs first."""
    try:
        while True:
            try:
                process.wait(_POLL_S)
                return
            except subprocess.TimeoutExpired:
                watch()
    except BaseException:
        process.terminate()
        process.wait()
        raise


def _forget_failures(plan: Plan) -> None:
    """Removes stamps without results, and records of failures, so that these jobs run again."""
    for full_id, job in plan.jobs.items():
        if not (result_folder(plan.settings, job) / RECORD).is_file():
            stamp(plan.settings, full_id).unlink(missing_ok=True)
        for record in (failure_record(plan.settings, full_id),
                       plan.settings.out / STATE / "ended" / f"{full_id}.json"):
            record.unlink(missing_ok=True)


