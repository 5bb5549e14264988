# SPDX-License-Identifier: BSD-3-Clause
"""What a run of the fleet does: jobs with their keys, dependencies and resources."""
from __future__ import annotations

import json
import math
import re
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from .digests import Digests, digest_of
from .files import write_atomically
from .recordings import RAWLOG, Recording

KEY_LENGTH = 10
STATE = ".fleet"  # folder in the results: plan, logs, scratch, records of ended jobs


@dataclass(frozen=True)
class Resources:
    """What one job may use."""

    cores: int = 1
    memory_mb: int = 3000
    minutes: int = 240


@dataclass(frozen=True)
class Used:
    """What a finished job used; None: not known."""

    memory_mb: float | None = None
    minutes: float | None = None


@dataclass(frozen=True)
class Job:
    """One unit of work; `after` names the jobs whose results it reads.

    The key in `id` stands for everything that decides on the result, so that a job is done if and
    only if a result of its id exists.
    """

    id: str
    stage: str  # import, process, place or world
    name: str
    resources: Resources
    after: list[str] = field(default_factory=list)
    arguments: dict[str, Any] = field(default_factory=dict)

    @property
    def full_id(self) -> str:
        return f"{self.stage}/{self.id}"


@dataclass(frozen=True)
class Settings:
    """What all jobs have in common."""

    out: Path
    programs: Path
    working_folder: Path
    replay_options: list[str] = field(default_factory=list)
    configuration: str = ""  # effective parameters, as --dump-config prints them
    program_digest: str = ""
    resources: Resources = Resources()


@dataclass(frozen=True)
class Plan:
    """All jobs by `full_id`, and the settings. Written to `.fleet/plan.json`."""

    settings: Settings
    jobs: dict[str, Job]

    def write(self) -> None:
        settings = asdict(self.settings)
        for key in ("out", "programs", "working_folder"):
            settings[key] = str(settings[key])
        text = json.dumps({"settings": settings,
                           "jobs": {name: asdict(job) for name, job in self.jobs.items()}})
        write_atomically(self.settings.out / STATE / "plan.json", text)

    @staticmethod
    def read(path: Path) -> Plan:
        data = json.loads(path.read_text(encoding="utf-8"))
        settings = data["settings"]
        for key in ("out", "programs", "working_folder"):
            settings[key] = Path(settings[key])
        settings["resources"] = Resources(**settings["resources"])
        jobs = {}
        for name, job in data["jobs"].items():
            job["resources"] = Resources(**job["resources"])
            jobs[name] = Job(**job)
        return Plan(Settings(**settings), jobs)


def job_id(name: str, key: str) -> str:
    return f"{name}-{key[:KEY_LENGTH]}"


def is_id_of(name: str, identifier: str) -> bool:
    """Whether an id is one of this name, with any key."""
    return re.fullmatch(re.escape(name) + f"-[0-9a-f]{{{KEY_LENGTH}}}", identifier) is not None


def result_folder(settings: Settings, job: Job) -> Path:
    """Where a job's result appears, whole."""
    folders = {"import": "imported", "process": "recordings", "place": "places",
               "world": "worlds"}
    return settings.out / folders[job.stage] / job.id


def recording_jobs(recording: Recording, settings: Settings, digests: Digests) -> list[Job]:
    """The import, if the recording is no rawlog, and the processing. Raises OSError."""
    contents = digests.of(recording.inputs)
    resources = Resources(recording.cores or settings.resources.cores,
                          recording.memory_mb or settings.resources.memory_mb,
                          recording.minutes or settings.resources.minutes)
    jobs = []
    after: list[str] = []
    rawlog = str(recording.path)
    if recording.kind != RAWLOG:
        key = digest_of([contents, recording.kind, recording.import_options,
                         settings.program_digest])
        job = Job(job_id(recording.name, key), "import", recording.name, resources,
                  arguments={"kind": recording.kind, "options": list(recording.import_options),
                             "path": str(recording.path)})
        jobs.append(job)
        after = [job.full_id]
        rawlog = str(result_folder(settings, job) / f"{recording.name}.rawlog")
    paths = {name: str(path) if path else "" for name, path in
             (("truth", recording.truth), ("labels", recording.labels),
              ("poses", recording.poses))}
    key = digest_of([contents, recording.kind, recording.import_options, settings.configuration,
                     settings.replay_options, settings.program_digest])
    jobs.append(Job(job_id(recording.name, key), "process", recording.name, resources, after,
                    {"rawlog": rawlog, "kind": recording.kind, "path": str(recording.path),
                     **paths}))
    return jobs


def place_job(place: str, found_by: str, members: list[Job], used: list[Used]) -> Job:
    """One map of the recordings of a place, in the order of `members`.

    @param used  what the job of each member has used
    """
    resources = Resources(
        max(job.resources.cores for job in members),
        _together([job.resources.memory_mb for job in members], [each.memory_mb for each in used]),
        _together([job.resources.minutes for job in members], [each.minutes for each in used]))
    key = digest_of([place, [job.id for job in members]])
    return Job(job_id(place, key), "place", place, resources,
               arguments={"rawlogs": [job.arguments["rawlog"] for job in members],
                          "members": [job.name for job in members], "found_by": found_by})


def _together(declared: list[int], used: list[float | None]) -> int:
    """Twice what the members used, at least what one declares and at most what all declare."""
    known = [each for each in used if each is not None]
    if len(known) < len(declared):
        return sum(declared)
    return min(sum(declared), max(max(declared), math.ceil(2.0 * sum(known))))
