# SPDX-License-Identifier: BSD-3-Clause
"""Which recordings are of one place: given in the list, found by satellite fixes, or candidates for
headway-replay, which recognises places by images."""
from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Iterable

from .fixes import groups_that_meet, read_path
from .results import DONE, Row

AUTO, GIVEN, GNSS, RECOGNISED, NONE = "auto", "given", "gnss", "recognised", "none"
WAYS = (AUTO, GIVEN, GNSS, RECOGNISED, NONE)
# Candidates are replayed once more, with all their maps in memory at once.
MAX_AUTO_CANDIDATES = 20


@dataclass(frozen=True)
class Place:
    """Recordings for one map. `found_by` is GIVEN, GNSS or RECOGNISED."""

    name: str
    found_by: str
    recordings: tuple[str, ...]  # names, in the order of their start


def find_places(rows: Iterable[Row], out: Path, how: str) -> list[Place]:
    """Places that have several recordings.

    Recordings with a place in the list belong to it, unless `how` is NONE. Of the others, those of
    one camera belong together

    - with AUTO or GNSS, if their paths on the earth come within NEAR_M;
    - with AUTO, if no path on the earth is known, as candidates: headway-replay joins those in
      which it recognises a place;
    - with RECOGNISED, as candidates, with or without a path on the earth.
    """
    if how == NONE:
        return []
    done = [row for row in rows if row.status == DONE]
    given: dict[str, list[Row]] = {}
    for row in done:
        if row.place:
            given.setdefault(row.place, []).append(row)
    groups = [(name, GIVEN, group) for name, group in given.items()]
    others = [row for row in done if not row.place]
    on_earth, candidates = _by_path(others, out) if how in (AUTO, GNSS) else ([], others)
    for meeting in on_earth:
        groups += [(f"around-{group[0].name}", GNSS, group) for group in _by_camera(meeting, out)]
    if how in (AUTO, RECOGNISED):
        groups += [(f"camera-of-{group[0].name}", RECOGNISED, group)
                   for group in _by_camera(candidates, out)]
    return _places([each for each in groups if len(each[2]) > 1], out)


def untried(place: Place, how: str, memory_mb: int, usable_mb: int | None) -> str:
    """Why a place is not tried by default, though it can be with RECOGNISED; empty: it is tried."""
    if how != AUTO or place.found_by != RECOGNISED:
        return ""
    count = len(place.recordings)
    hint = "give their places in the list, or --places recognised to try all the same"
    if count > MAX_AUTO_CANDIDATES:
        return (f"{count} recordings of one camera without satellite fixes were not compared: more "
                f"than {MAX_AUTO_CANDIDATES}; {hint}")
    if usable_mb is not None and memory_mb > usable_mb:
        return (f"{count} recordings of one camera without satellite fixes were not compared: this "
                f"may take {memory_mb} MB, more than the {usable_mb} MB to be used here; {hint}")
    return ""


def _by_path(rows: list[Row], out: Path) -> tuple[list[list[Row]], list[Row]]:
    """Groups of rows whose paths on the earth meet, and the rows without such a path."""
    paths = [read_path(out / row.folder / "trajectory.geojson") for row in rows]
    known = [(row, path) for row, path in zip(rows, paths) if path]
    groups = [[known[index][0] for index in group]
              for group in groups_that_meet([path for _, path in known])]
    return groups, [row for row, path in zip(rows, paths) if not path]


def _by_camera(rows: list[Row], out: Path) -> list[list[Row]]:
    """Groups of rows with the same calibration and mounting; headway-replay refuses others."""
    groups: dict[bytes, list[Row]] = {}
    for row in rows:
        try:
            calibration = (out / row.folder / "calibration.yaml").read_bytes()
        except OSError:
            continue  # poses without a camera
        groups.setdefault(calibration, []).append(row)
    return list(groups.values())


def _places(groups: list[tuple[str, str, list[Row]]], out: Path) -> list[Place]:
    """With names that are different names of files; those in the list keep theirs."""
    places: list[Place] = []
    used: set[str] = set()
    for name, found_by, group in groups:
        unique = wanted = _file_name(name)
        number = 1
        while unique in used:
            number += 1
            unique = f"{wanted}-{number}"
        used.add(unique)
        starts = sorted(group, key=lambda row: _start(row, out))
        places.append(Place(unique, found_by, tuple(row.name for row in starts)))
    return sorted(places, key=lambda place: place.name)


def _start(row: Row, out: Path) -> tuple[float, str]:
    """Time of the first pose, then the name."""
    try:
        with (out / row.folder / "trajectory.tum").open(encoding="utf-8") as file:
            words = next(line for line in file if not line.startswith("#")).split()
        return float(words[0]), row.name
    except (OSError, StopIteration, ValueError, IndexError):
        return 0.0, row.name


def _file_name(place: str) -> str:
    return "".join(c if c.isalnum() and c.isascii() or c in "._-" else "_" for c in place)
