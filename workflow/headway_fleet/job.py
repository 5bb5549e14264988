# SPDX-License-Identifier: BSD-3-Clause
"""Runs one job of a plan: `python3 -m headway_fleet.job PLAN STAGE/ID`, as the Snakefile does.

Exit status 0: its result exists, and so does its stamp. Otherwise `.fleet/failed/STAGE/ID.json`
has the cause.
"""
from __future__ import annotations

import json
import os
import shutil
import signal
import sys
import time
from pathlib import Path
from types import FrameType
from typing import Callable

from .attempt import Attempt, JobFailure
from .figures import has_truth, place_maps, replay_figures
from .files import publish, write_atomically
from .plan import STATE, Job, Plan, Settings, is_id_of, result_folder

RECORD = "result.json"  # in each folder of results, written last
MAX_RESTARTS = 1        # of a job whose node ended
THUMBNAILS = {"top": ("top.png", "top_small.png"), "follow": ("follow.png", "follow_small.png")}


def stamp(settings: Settings, full_id: str) -> Path:
    return settings.out / STATE / "done" / full_id


def failure_record(settings: Settings, full_id: str) -> Path:
    return settings.out / STATE / "failed" / f"{full_id}.json"


def log_file(settings: Settings, full_id: str) -> Path:
    return settings.out / STATE / "logs" / f"{full_id}.txt"


def run_job(plan: Plan, full_id: str) -> bool:
    """Whether the job's result exists afterwards. One that exists is not computed again."""
    job, settings = plan.jobs[full_id], plan.settings
    target = result_folder(settings, job)
    if not (target / RECORD).is_file():
        try:
            _refuse_another_restart()
            _compute(job, settings, target)
        except JobFailure as failure:
            text = json.dumps({"step": failure.step, "cause": failure.cause})
            write_atomically(failure_record(settings, full_id), text)
            return False
    failure_record(settings, full_id).unlink(missing_ok=True)
    _remove_superseded(job, target)
    write_atomically(stamp(settings, full_id), "")
    return True


def _refuse_another_restart() -> None:
    restarts = int(os.environ.get("SLURM_RESTART_COUNT", "0"))
    if restarts > MAX_RESTARTS:
        raise JobFailure("start", f"its node ended {restarts} times; it was requeued "
                                  f"{MAX_RESTARTS} time")


def _compute(job: Job, settings: Settings, target: Path) -> None:
    started = time.time()
    with Attempt(settings, job) as attempt:
        result = attempt.folder / job.id
        try:
            record = STAGES[job.stage](attempt, job, settings, result)
            record.update(name=job.name, id=job.id, seconds=round(time.time() - started, 1),
                          job_memory_mb=round(attempt.peak_memory_mb, 1),
                          node=os.environ.get("SLURMD_NODENAME", ""))
            shutil.copyfile(attempt.log, result / "log.txt")
            write_atomically(result / RECORD, json.dumps(record, indent=1) + "\n")
            publish(result, target)
        finally:
            kept = log_file(settings, job.full_id)
            kept.parent.mkdir(parents=True, exist_ok=True)
            if attempt.log.exists():
                shutil.copyfile(attempt.log, kept)


def _import(attempt: Attempt, job: Job, settings: Settings, result: Path) -> dict[str, object]:
    result.mkdir()
    folder = Path(job.arguments["path"]) if job.arguments["kind"] == "images" else None
    attempt.run("import", "headway-import",
                [job.arguments["kind"], *job.arguments["options"], "-q",
                 "-o", str(result / f"{job.name}.rawlog")], folder)
    return {}


def _process(attempt: Attempt, job: Job, settings: Settings, result: Path) -> dict[str, object]:
    arguments = job.arguments
    truth = ["--truth", arguments["truth"]] if arguments["truth"] else []
    attempt.run("replay", "headway-replay", ["-q", "-i", arguments["rawlog"], "-o", str(result),
                                             *truth, *settings.replay_options])
    notes = _evaluate(attempt, job, result) + _draw(attempt, result, result)
    return {"figures": replay_figures(result), "notes": notes, "rawlog": arguments["rawlog"]}


def _evaluate(attempt: Attempt, job: Job, result: Path) -> list[str]:
    """Errors against the truth there is; what cannot be evaluated is a note."""
    arguments, steps = job.arguments, []
    estimate = ["--estimate", str(result / "trajectory.tum")]
    if arguments["truth"]:
        steps.append(["trajectory", "--truth", f"{arguments['truth']}/trajectory.tum", *estimate])
    elif has_truth(result):
        steps.append(["trajectory", "--truth", arguments["rawlog"], *estimate])
    if arguments["labels"] and arguments["poses"]:
        steps.append(["movers", "--truth", arguments["labels"], "--poses", arguments["poses"],
                      "--estimate", str(result)])
    notes = []
    for step in steps:
        try:
            attempt.run("evaluation", "headway-eval",
                        [*step, "-q", "--json", str(result / f"{step[0]}_error.json"),
                         "--plot", str(result / f"{step[0]}_error.png")])
        except JobFailure as failure:
            if not failure.cause.endswith("contains no poses labelled truth_pose"):
                notes.append(failure.cause)
    return notes


def _draw(attempt: Attempt, result: Path, source: Path) -> list[str]:
    """Pictures of a replay or a map, and small ones for the page; a note if there are none."""
    try:
        for view, (whole, small) in THUMBNAILS.items():
            for name, size in ((whole, "1280x960"), (small, "256x192")):
                attempt.run("pictures", "headway-render",
                            ["-q", "-i", str(source), "-o", str(result / name), "--view", view,
                             "--size", size])
    except JobFailure as failure:
        return [failure.cause]
    return []


def _map_place(attempt: Attempt, job: Job, settings: Settings, result: Path) -> dict[str, object]:
    inputs = [word for rawlog in job.arguments["rawlogs"] for word in ("-i", rawlog)]
    attempt.run("map", "headway-replay", ["-q", *inputs, "-o", str(result),
                                          *settings.replay_options])
    maps = place_maps(result, job.arguments["members"])
    if not maps:
        _keep_record_only(result)
    notes = [note for each in maps
             for note in _draw(attempt, result / each.folder, result / each.folder / "map.headway")]
    return {"notes": sorted(set(notes))}


def _keep_record_only(result: Path) -> None:
    """Removes the rest of what was not joined: each recording has its own replay."""
    for entry in result.iterdir():
        if entry.is_dir():
            shutil.rmtree(entry)
        elif entry.name != "recordings.json":
            entry.unlink()


def _run_world(attempt: Attempt, job: Job, settings: Settings, result: Path) -> dict[str, object]:
    attempt.run("world", "headway-eval",
                ["suite", "--only-runs", "-q", "--worlds", job.arguments["world"], "-o",
                 str(result), *job.arguments["options"], *settings.replay_options])
    return {}


STAGES: dict[str, Callable[[Attempt, Job, Settings, Path], dict[str, object]]] = {
    "import": _import, "process": _process, "place": _map_place, "world": _run_world}


def _remove_superseded(job: Job, target: Path) -> None:
    """Results of the same name with another key, now that there is a newer one."""
    for entry in target.parent.iterdir():
        if entry != target and is_id_of(job.name, entry.name) and (entry / RECORD).is_file():
            shutil.rmtree(entry, ignore_errors=True)


def _end(number: int, frame: FrameType | None) -> None:
    sys.exit(128 + number)


def main() -> int:
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(number, _end)
    plan = Plan.read(Path(sys.argv[1]))
    return 0 if run_job(plan, sys.argv[2]) else 1


if __name__ == "__main__":
    sys.exit(main())
