# SPDX-License-Identifier: BSD-3-Clause
"""The command line of headway-fleet."""
from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import FrameType
from typing import Any

from .attempt import one_line
from .deciding_files import PROGRAMS, network_files, program_files
from .digests import Digests, digest_of
from .engine import run_engine, usable_memory_mb
from .errors import FleetError
from .files import write_atomically
from .lock import locked
from .page import page
from .place_rows import place_rows, untried_row, with_places
from .places import AUTO, WAYS, find_places, untried
from .plan import STATE, Job, Plan, Resources, Settings, place_job, recording_jobs
from .recordings import Found, Recording, find_recordings, read_list
from .results import DONE, FAILED, WAITING, Row, rows_of, table_csv, used_by
from .suite import run_suite

_PAGE_S, _PROGRESS_S = 30.0, 10.0


def main(arguments: list[str] | None = None) -> int:
    """Exit status 0: all done, 1: something failed or the input is at fault, 2: usage."""
    words = sys.argv[1:] if arguments is None else arguments
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, _interrupt)
    try:
        if words[:1] == ["--suite"]:
            return run_suite(words[1:])
        options = _parser().parse_args(words)
        with locked(options.output.resolve()):
            return Fleet(options).run()
    except FleetError as error:
        print(f"headway-fleet: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 128 + signal.SIGINT


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="headway-fleet", usage="%(prog)s FOLDER|LIST.csv [OPTION]...", allow_abbrev=False,
        formatter_class=_Help,
        description="Imports, replays, evaluates and draws all recordings of a folder or list, here "
                    "or on a cluster, into one page and one CSV. Run again, it does what is missing "
                    "or has changed.")
    add = parser.add_argument
    add("recordings", metavar="FOLDER|LIST.csv", type=Path, help="folder or list of recordings")
    add("-o", "--output", metavar="OUTDIR", type=Path, default=Path("fleet"),
        help="folder of results; default fleet")
    add("-j", "--jobs", metavar="N", type=_positive,
        help="cores to use here (default: all), or jobs at once with --profile")
    add("--profile", metavar="NAME|DIR", default="",
        help="run on a cluster: slurm, or a folder with a profile of Snakemake")
    add("-c", "--config", metavar="FILE.ini", type=Path, help="configuration of headway-replay")
    add("--set", metavar="SECTION.KEY=VALUE", action="append", default=[],
        help="one parameter (repeatable, overrides the file)")
    add("--detector", metavar="NAME", default="", help="as of headway-replay")
    add("--cores", metavar="N", type=_positive, default=Resources.cores,
        help=f"cores of a recording's job; default {Resources.cores}")
    add("--memory", metavar="MB", type=_positive, default=Resources.memory_mb,
        help=f"memory of a recording's job; default {Resources.memory_mb}")
    add("--minutes", metavar="N", type=_positive, default=Resources.minutes,
        help=f"longest time of a recording's job on a cluster; default {Resources.minutes}")
    add("--places", choices=WAYS, default=AUTO,
        help="one map for the recordings of each place: given in the list; or also found by satellite "
             "fixes (gnss), by images (recognised), or by images where there are no fixes (auto, the "
             "default); or none")
    add("--programs", metavar="DIR", type=Path, default=Path(sys.argv[0]).absolute().parent,
        help="folder of headway's programs; default: that of this one")
    add("-q", "--quiet", action="store_true", help="no progress")
    add("--version", action=_Version, nargs=0, help="that of headway's programs")
    return parser


class _Help(argparse.HelpFormatter):
    """Writes "Usage:" as headway's other programs do; help2man requires it."""

    def add_usage(self, usage: Any, actions: Any, groups: Any, prefix: str | None = "Usage: ") -> None:
        super().add_usage(usage, actions, groups, prefix)


class _Version(argparse.Action):
    """Asks the program beside this one, so that the version is in one place."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        replay = Path(sys.argv[0]).absolute().parent / "headway-replay"
        try:
            done = subprocess.run([replay, "--version"], capture_output=True, text=True, check=True)
        except (OSError, subprocess.CalledProcessError):
            parser.exit(1, f"headway-fleet: {replay}: cannot be run\n")
        print(f"headway-fleet {done.stdout.split()[-1]}")
        parser.exit()


def _positive(text: str) -> int:
    if not text.isdigit() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a positive whole number")
    return int(text)


class Fleet:
    """One run over all recordings."""

    def __init__(self, options: argparse.Namespace) -> None:
        self._options = options
        self._out: Path = options.output.resolve()
        self._started = time.time()
        self._shown_at = self._page_at = self._started
        found = self._found()
        self._recordings = found.recordings
        self._note(self._description(found))
        self._settings = self._read_settings()
        self._plan, self._recordings = self._planned(self._recordings)
        self._done_before = self._count(DONE)

    def run(self) -> int:
        places: list[Job] = []
        maps: list[Row] = []
        try:
            run_engine(self._plan, self._options.jobs, self._options.profile, self._watch)
            places, maps = self._place_jobs()
            if places:
                self._note(f"{len(places)} places with several recordings")
                jobs = {**self._plan.jobs, **{job.full_id: job for job in places}}
                self._plan = Plan(self._settings, jobs)
                run_engine(self._plan, self._options.jobs, self._options.profile, self._watch)
        except KeyboardInterrupt:
            self._write_page(self._rows(ended=False), [])
            raise
        maps = [*place_rows(places, self._plan), *maps]
        rows = with_places(self._rows(ended=True), maps)
        self._write_page(rows, maps)
        return self._report(rows, maps)

    # Preparation

    def _found(self) -> Found:
        source: Path = self._options.recordings
        if source.is_file() and source.suffix == ".csv":
            return read_list(source)
        return find_recordings(source, self._out)

    def _read_settings(self) -> Settings:
        options = self._options
        for program in PROGRAMS:
            if not os.access(options.programs / program, os.X_OK):
                raise FleetError(f"{options.programs}: has no {program}; give the folder of "
                                 "headway's programs by --programs")
        replay = [word for value in options.set for word in ("--set", value)]
        if options.config is not None:
            replay += ["-c", str(self._kept_configuration())]
        effective = subprocess.run(
            [options.programs / "headway-replay", *replay, "--dump-config", "--expert"],
            capture_output=True, text=True, check=False)
        if effective.returncode != 0:
            raise FleetError(one_line(effective.stderr))
        if options.detector:
            replay += ["--detector", options.detector]
        digests = Digests(self._out / STATE / "digests.json")
        program_digest = digests.of(program_files(options.programs))
        networks = digests.of(network_files(effective.stdout))
        kept = [word for word in replay if not word.startswith(str(self._out))]
        return Settings(self._out, options.programs.resolve(), Path.cwd(), replay,
                        digest_of([effective.stdout, kept, networks]), program_digest,
                        Resources(options.cores, options.memory, options.minutes))

    def _kept_configuration(self) -> Path:
        """A copy, so that all jobs read the same file whatever becomes of it."""
        try:
            text = self._options.config.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise FleetError(f"{self._options.config}: cannot be read: {error}") from error
        copy = self._out / STATE / "configuration.ini"
        write_atomically(copy, text)
        return copy

    def _planned(self, recordings: list[Recording]) -> tuple[Plan, list[Recording]]:
        digests = Digests(self._out / STATE / "digests.json")
        digests.read((path for recording in recordings for path in recording.inputs),
                     os.cpu_count() or 1)
        jobs: dict[str, Job] = {}
        checked = []
        for recording in recordings:
            if not recording.error:
                try:
                    for job in recording_jobs(recording, self._settings, digests):
                        jobs[job.full_id] = job
                except OSError as error:
                    text = f"{error.filename}: cannot be read: {error.strerror}"
                    recording = Recording(recording.name, recording.path, recording.kind,
                                          place=recording.place, error=text)
            checked.append(recording)
        return Plan(self._settings, jobs), checked

    def _place_jobs(self) -> tuple[list[Job], list[Row]]:
        """The jobs of places, and rows of those that are not tried."""
        jobs = {job.name: job for job in self._plan.jobs.values() if job.stage == "process"}
        rows = {row.name: row for row in self._rows(ended=True)}
        largest = max((job.resources.memory_mb for job in jobs.values()), default=0)
        usable_mb = None if self._options.profile else max(usable_memory_mb(), largest)
        tried, rest = [], []
        for place in find_places(rows.values(), self._out, self._options.places):
            job = place_job(place.name, place.found_by, [jobs[name] for name in place.recordings],
                            [used_by(rows[name]) for name in place.recordings])
            why = untried(place, self._options.places, job.resources.memory_mb, usable_mb)
            if why:
                self._note(f"{place.name}: {why}")
                rest.append(untried_row(job, why))
            else:
                tried.append(job)
        return tried, rest

    # Output

    def _rows(self, ended: bool) -> list[Row]:
        return rows_of(self._recordings, self._plan, ended)

    def _count(self, status: str) -> int:
        return sum(row.status == status for row in self._rows(ended=False))

    def _watch(self) -> None:
        now = time.time()
        if now - self._shown_at < _PROGRESS_S:
            return
        self._shown_at = now
        rows = self._rows(ended=False)
        count = {status: sum(row.status == status for row in rows)
                 for status in (DONE, FAILED, WAITING)}
        rate = self._rate(count[DONE])
        left = f", {count[WAITING] / rate * 60:.0f} min left" if rate else ""
        self._note(f"{count[DONE]} of {len(rows)} done, {count[FAILED]} failed{left}")
        if now - self._page_at >= _PAGE_S:
            self._page_at = now
            self._write_page(rows, [])

    def _rate(self, done: int) -> float | None:
        """Recordings an hour in this run; None before the first."""
        new = done - self._done_before
        return 3600.0 * new / (time.time() - self._started) if new > 0 else None

    def _write_page(self, rows: list[Row], maps: list[Row]) -> None:
        rate = self._rate(sum(row.status == DONE for row in rows))
        title = f"Recordings of {self._options.recordings}"
        write_atomically(self._out / "fleet.csv", table_csv([*rows, *maps]))
        write_atomically(self._out / "index.html", page(title, rows, maps, self._out, rate))

    def _report(self, rows: list[Row], maps: list[Row]) -> int:
        failed = [row for row in [*rows, *maps] if row.status == FAILED]
        for row in failed:
            print(f"headway-fleet: {row.name}: {row.step}: {row.cause}", file=sys.stderr)
        done = sum(row.status == DONE for row in rows)
        rate = self._rate(done)
        note = f", {rate:.0f} recordings/hour" if rate else ", none was new"
        self._note(f"{done} of {len(rows)} recordings done{note}")
        if not self._options.quiet:
            print(f"page: {self._out / 'index.html'}\ntable: {self._out / 'fleet.csv'}")
        return 1 if failed else 0

    def _description(self, found: Found) -> str:
        kinds: dict[str, int] = {}
        for recording in found.recordings:
            kinds[recording.kind] = kinds.get(recording.kind, 0) + 1
        text = ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items()))
        other = f"; {found.other_files} other files" if found.other_files else ""
        return f"{len(found.recordings)} recordings ({text}){other}"

    def _note(self, text: str) -> None:
        if not self._options.quiet:
            print(f"fleet: {text}", file=sys.stderr, flush=True)
