# SPDX-License-Identifier: BSD-3-Clause
"""Figures of a finished replay, for the table."""
from __future__ import annotations

import csv
import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Iterable, Sequence

Figures = dict[str, Any]


def read_json(path: Path) -> dict[str, Any]:
    """Empty if the file is missing or damaged."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return data if isinstance(data, dict) else {}


def replay_figures(folder: Path) -> Figures:
    """From the files that headway-replay and headway-eval left in a folder; None: not known."""
    summary = read_json(folder / "summary.json")
    trajectory = read_json(folder / "trajectory_error.json")
    movers = read_json(folder / "movers_error.json").get("all", {})
    length, duration = _path(folder / "trajectory.tum")
    return {
        "frames": summary.get("frames"),
        "frames_lost": summary.get("frames_lost"),
        "duration_s": duration,
        "path_m": length,
        "ate_rmse_m": trajectory.get("ate_rmse_m"),
        "drift_percent": _drift(trajectory),
        "loops": summary.get("loops"),
        "moving_tracks": summary.get("tracks_moving", _moving_tracks(folder / "tracks.csv")),
        "movers_recall": movers.get("recall"),
        "movers_precision": movers.get("precision"),
        "frame_ms_median": summary.get("frame_ms_median"),
        "cpu_ms_per_frame": summary.get("cpu_ms_per_frame"),
        "peak_memory_mb": summary.get("peak_memory_mb"),
        **_origin(folder),
        "warnings": ", ".join(sorted(summary.get("warnings") or {})),
        "version": summary.get("version"),
    }


@dataclass(frozen=True)
class PlaceMap:
    """A map of several recordings of a place."""

    folder: str                  # in that of the place; "." for the first map
    recordings: tuple[str, ...]  # names of the fleet
    folders: tuple[str, ...]     # of their replays, in that of the place
    figures: Figures = field(default_factory=dict)


def place_maps(folder: Path, members: Sequence[str]) -> list[PlaceMap]:
    """Maps that more than one recording became. `members`: names, in the order of the inputs."""
    record = read_json(folder / "recordings.json")
    recordings = list(zip(members, record.get("recordings", [])))
    maps = []
    for index, each in enumerate(record.get("maps", [])):
        joined = [(name, entry) for name, entry in recordings if entry["map"] == index]
        if len(joined) < 2:
            continue
        figures = {**_frames(entry for _, entry in joined), **_origin(folder / each["folder"]),
                   "recordings": len(members), "recordings_joined": len(joined),
                   "keyframes": each["keyframes"], "landmarks": each["landmarks"],
                   "keyframes_recognised": each["keyframes_recognised"],
                   "version": record.get("version")}
        maps.append(PlaceMap(each["folder"], tuple(name for name, _ in joined),
                             tuple(entry["folder"] for _, entry in joined), figures))
    return maps


def apart_figures(folder: Path, members: Sequence[str]) -> Figures:
    """Of recordings none of which became one map with another."""
    record = read_json(folder / "recordings.json")
    return {**_frames(record.get("recordings", [])), "recordings": len(members),
            "recordings_joined": 0, "keyframes_recognised": 0, "version": record.get("version")}


def _frames(recordings: Iterable[dict[str, Any]]) -> Figures:
    counts = [(each["frames"], each["frames_tracked"]) for each in recordings]
    frames = sum(count for count, _ in counts)
    return {"frames": frames, "frames_lost": frames - sum(tracked for _, tracked in counts)}


def _origin(folder: Path) -> Figures:
    origin = read_json(folder / "map_geo.json").get("map_origin", {})
    return {name: origin.get(name) for name in ("latitude_deg", "longitude_deg")}


def has_truth(folder: Path) -> bool:
    """Whether the replayed rawlog contains observations labelled truth_."""
    return bool(read_json(folder / "summary.json").get("observations_skipped", {}).get("truth"))


def _drift(trajectory: dict[str, Any]) -> float | None:
    """KITTI's relative error where the path is long enough, else ATE over the path."""
    if trajectory.get("kitti_trans_percent") is not None:
        return float(trajectory["kitti_trans_percent"])
    ate, path = trajectory.get("ate_rmse_m"), trajectory.get("path_m")
    return 100.0 * ate / path if ate is not None and path else None


def _path(file: Path) -> tuple[float | None, float | None]:
    """Length [m] and duration [s] of a trajectory; None without two poses."""
    poses = []
    try:
        for line in file.read_text(encoding="utf-8").splitlines():
            if line and not line.startswith("#"):
                poses.append([float(word) for word in line.split()[:4]])
    except (OSError, ValueError):
        return None, None
    if len(poses) < 2:
        return None, None
    length = sum(math.dist(a[1:], b[1:]) for a, b in zip(poses, poses[1:]))
    return length, poses[-1][0] - poses[0][0]


def _moving_tracks(file: Path) -> int | None:
    try:
        with file.open(newline="", encoding="utf-8") as rows:
            return len({row["track_id"] for row in csv.DictReader(rows)
                        if row["moving"] == "1" and row["status"] == "confirmed"})
    except (OSError, KeyError, csv.Error, UnicodeDecodeError):
        return None
