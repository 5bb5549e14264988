# SPDX-License-Identifier: BSD-3-Clause
"""Simulated worlds as jobs: what `headway-eval suite --jobs` runs as `headway-fleet --suite`."""
from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
from pathlib import Path

from .digests import Digests, digest_of
from .engine import run_engine
from .errors import FleetError
from .job import RECORD
from .lock import locked
from .plan import STATE, Job, Plan, Resources, Settings, job_id, result_folder
from .results import FAILED, job_row

PROGRAM = "headway-eval"


def run_suite(arguments: list[str]) -> int:
    """Exit status 0: the recordings and runs of all worlds are in the folder."""
    options = _parser().parse_args(arguments)
    out = options.output.resolve()
    with locked(out):
        plan = _plan(options, out)
        waiting = len(plan.jobs) - _count_done(plan)
        _note(options, f"{len(plan.jobs)} worlds, {waiting} to be simulated and replayed")
        run_engine(plan, options.jobs, options.profile, lambda: None)
        failed = 0
        for job in plan.jobs.values():
            row = job_row(job, plan, True)
            if row.status == FAILED:
                failed += 1
                print(f"headway-fleet: {job.name}: {row.step}: {row.cause}", file=sys.stderr)
            else:
                place_results(result_folder(plan.settings, job), out)
        return 1 if failed else 0


def place_results(folder: Path, out: Path) -> None:
    """Gives each file of a result a second name (hard link) below `out`, replacing older ones."""
    for source in sorted(folder.rglob("*")):
        if source.is_dir() or source.name in (RECORD, "log.txt"):
            continue
        target = out / source.relative_to(folder)
        if target.exists() and target.samefile(source):
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=out / STATE) as beside:
            link = Path(beside) / source.name
            try:
                os.link(source, link)
            except OSError:
                shutil.copyfile(source, link)
            os.replace(link, target)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="headway-fleet --suite", allow_abbrev=False,
                                     description=__doc__)
    add = parser.add_argument
    add("worlds", metavar="WORLD.ini", type=Path, nargs="+")
    add("-o", "--output", metavar="OUTDIR", type=Path, required=True)
    add("-c", "--config", metavar="FILE.ini", type=Path, required=True)
    add("-j", "--jobs", metavar="N", type=int)
    add("--profile", metavar="NAME|DIR", default="")
    add("--frames", metavar="N", type=int)
    add("--programs", metavar="DIR", type=Path, required=True)
    add("-q", "--quiet", action="store_true")
    return parser


def _plan(options: argparse.Namespace, out: Path) -> Plan:
    digests = Digests(out / STATE / "digests.json")
    try:
        common = [digests.of([options.config]), digests.of([options.programs / PROGRAM]),
                  options.frames]
        jobs = [_job(world.resolve(), digests.of([world]), common, options.frames)
                for world in options.worlds]
    except OSError as error:
        raise FleetError(f"{error.filename}: cannot be read: {error.strerror}") from error
    settings = Settings(out, options.programs.resolve(), Path.cwd(),
                        ["-c", str(options.config.resolve())])
    return Plan(settings, {job.full_id: job for job in jobs})


def _job(world: Path, contents: str, common: list[object], frames: int | None) -> Job:
    limit = ["--frames", str(frames)] if frames else []
    return Job(job_id(world.stem, digest_of([contents, common])), "world", world.stem, Resources(),
               arguments={"world": str(world), "options": limit})


def _count_done(plan: Plan) -> int:
    return sum((result_folder(plan.settings, job) / RECORD).is_file()
               for job in plan.jobs.values())


def _note(options: argparse.Namespace, text: str) -> None:
    if not options.quiet:
        print(f"fleet: {text}", file=sys.stderr, flush=True)
