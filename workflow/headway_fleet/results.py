# SPDX-License-Identifier: BSD-3-Clause
"""What became of each recording: rows of the page and of the table."""
from __future__ import annotations

import csv
import io
import statistics
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Iterable

from .figures import Figures, read_json
from .job import RECORD, failure_record, log_file
from .plan import STATE, Job, Plan, Used, result_folder
from .recordings import Recording

DONE, FAILED, WAITING = "done", "failed", "waiting"
JOINED, PARTLY_JOINED = "joined", "partly joined"  # of places
NOT_JOINED, NOT_TRIED = "not joined", "not tried"
FIGURES = ("frames", "frames_lost", "duration_s", "path_m", "ate_rmse_m", "drift_percent", "loops",
           "moving_tracks", "movers_recall", "movers_precision", "frame_ms_median",
           "cpu_ms_per_frame", "peak_memory_mb", "recordings", "recordings_joined", "keyframes",
           "landmarks", "keyframes_recognised", "latitude_deg", "longitude_deg", "warnings",
           "version")


@dataclass(frozen=True)
class Row:
    """One recording or one place. Paths are relative to the folder of results."""

    name: str
    kind: str
    status: str
    source: str = ""
    step: str = ""
    cause: str = ""
    folder: str = ""
    log: str = ""
    place: str = ""
    seconds: float | None = None
    figures: Figures = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    joined: tuple[str, ...] = ()   # recordings that became this map
    reports: tuple[str, ...] = ()  # of their replays


def rows_of(recordings: Iterable[Recording], plan: Plan, ended: bool) -> list[Row]:
    """A row for each recording, failures first. `ended`: the engine has no more jobs."""
    jobs: dict[str, list[Job]] = {}
    for job in plan.jobs.values():
        jobs.setdefault(job.name, []).append(job)
    rows = []
    for recording in recordings:
        own = [job for job in jobs.get(recording.name, []) if job.stage in ("import", "process")]
        rows.append(_row(recording, own, plan, ended))
    order = {FAILED: 0, DONE: 1, WAITING: 2}
    return sorted(rows, key=lambda row: (order[row.status], row.name))


def used_by(row: Row) -> Used:
    """Of a recording that is done."""
    return Used(row.figures.get("peak_memory_mb"),
                row.seconds / 60.0 if row.seconds is not None else None)


def table_csv(rows: Iterable[Row]) -> str:
    """All rows with all figures; what is not known is empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["name", "kind", "status", "step", "cause", "source", "place", "seconds",
                     *FIGURES, "notes", "results"])
    for row in rows:
        writer.writerow([row.name, row.kind, row.status, row.step, row.cause, row.source,
                         row.place, _text(row.seconds),
                         *(_text(row.figures.get(name)) for name in FIGURES),
                         "; ".join(row.notes), row.folder])
    return text.getvalue()


def median_of(rows: Iterable[Row], figure: str) -> float | None:
    values = [row.figures[figure] for row in rows if row.figures.get(figure) is not None]
    return statistics.median(values) if values else None


def _text(value: Any) -> str:
    if value is None:
        return ""
    return f"{value:.9g}" if isinstance(value, float) else str(value)


def _row(recording: Recording, jobs: list[Job], plan: Plan, ended: bool) -> Row:
    found = Row(recording.name, recording.kind, FAILED, step="recording", cause=recording.error)
    if not recording.error:
        parts = [job_row(job, plan, ended) for job in jobs]
        failed = [part for part in parts if part.status == FAILED]
        with_cause = [part for part in failed if part.step != "engine"]
        found = (with_cause or failed or parts[-1:])[0]
    return Row(recording.name, recording.kind, found.status, str(recording.path), found.step,
               found.cause, found.folder, found.log, recording.place, found.seconds,
               found.figures, found.notes)


def job_row(job: Job, plan: Plan, ended: bool) -> Row:
    """What became of one job. `ended`: the engine has no more jobs."""
    out = plan.settings.out
    record = read_json(result_folder(plan.settings, job) / RECORD)
    if record:
        folder = result_folder(plan.settings, job).relative_to(out)
        return Row(job.name, job.stage, DONE, folder=str(folder), log=str(folder / "log.txt"),
                   seconds=record.get("seconds"), figures=record.get("figures") or {},
                   notes=tuple(record.get("notes") or ()))
    log = log_file(plan.settings, job.full_id)
    where = str(log.relative_to(out)) if log.is_file() else ""
    for file in (failure_record(plan.settings, job.full_id),
                 out / STATE / "ended" / f"{job.full_id}.json"):
        failure = read_json(file)
        if failure:
            return Row(job.name, job.stage, FAILED, step=str(failure.get("step", "")),
                       cause=str(failure.get("cause", "")), log=where)
    if not ended:
        return Row(job.name, job.stage, WAITING)
    return Row(job.name, job.stage, FAILED, step="engine", log=str(Path(STATE) / "engine.log"),
               cause="its job was killed, by the system if memory was short, or was not run; "
                     "run headway-fleet again")
