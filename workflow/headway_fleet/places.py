# SPDX-License-Identifier: BSD-3-Clause
"""Which recordings are of one place: given in the list, found by satellite fixes, or candidates for
headway-replay, which recognises places by images."""
from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Iterable, Sequence

from .results import DONE, Row

# Cameras that see the same facades or shelves; standalone fixes are off by up to 5 m each.
NEAR_M = 15.0
_EARTH_M = 6371008.8  # mean radius
_EAST, _NORTH = 0, 1


def find_places(rows: Iterable[Row], out: Path, how: str) -> dict[str, list[str]]:
    """Names of the recordings of each place that has several, in the order of their start.

    Recordings with a place in the list belong to it. With `how` = "gnss", others belong together
    if their paths on the earth come within NEAR_M; with "recognised", those of one camera are
    candidates, which headway-replay joins where it recognises a place; "none": no places.
    """
    if how == "none":
        return {}
    done = [row for row in rows if row.status == DONE]
    groups: dict[str, list[Row]] = {}
    for row in done:
        if row.place:
            groups.setdefault(row.place, []).append(row)
    others = [row for row in done if not row.place]
    if how == "gnss":
        groups.update(_by_fixes(others, out))
    elif how == "recognised":
        groups.update(_by_camera(others, out))
    return {_file_name(place): [row.name for row in sorted(group, key=lambda r: _start(r, out))]
            for place, group in sorted(groups.items()) if len(group) > 1}


def paths_meet(first: Sequence[tuple[float, float]], second: Sequence[tuple[float, float]]) -> bool:
    """Whether a point of one path is within NEAR_M of a point of the other (both thinned)."""
    cells: dict[tuple[int, int], list[tuple[float, float]]] = {}
    for point in first:
        cells.setdefault(_cell(point), []).append(point)
    for point in second:
        column, row = _cell(point)
        for near in ((column + i, row + j) for i in (-1, 0, 1) for j in (-1, 0, 1)):
            if any(math.dist(point, other) <= NEAR_M for other in cells.get(near, [])):
                return True
    return False


def _by_fixes(rows: list[Row], out: Path) -> dict[str, list[Row]]:
    """Groups of rows whose paths meet, directly or through others, named by their first one."""
    paths = [(row, _lines(out / row.folder / "trajectory.geojson")) for row in rows]
    paths = [(row, line) for row, line in paths if line]
    if not paths:
        return {}
    origin = paths[0][1][0]
    local = [(row, [_metres(point, origin) for point in line]) for row, line in paths]
    group = list(range(len(local)))
    for i, (_, first) in enumerate(local):
        for j in range(i):
            if group[i] != group[j] and _boxes_near(first, local[j][1]) and \
                    paths_meet(first, local[j][1]):
                old, new = max(group[i], group[j]), min(group[i], group[j])
                group = [new if value == old else value for value in group]
    groups: dict[str, list[Row]] = {}
    for index, (row, _) in zip(group, local):
        groups.setdefault(f"around-{local[index][0].name}", []).append(row)
    return groups


def _by_camera(rows: list[Row], out: Path) -> dict[str, list[Row]]:
    """Groups of rows with the same calibration and mounting, named by their first one."""
    groups: dict[bytes, list[Row]] = {}
    for row in rows:
        try:
            calibration = (out / row.folder / "calibration.yaml").read_bytes()
        except OSError:
            continue  # poses without a camera
        groups.setdefault(calibration, []).append(row)
    return {f"camera-of-{group[0].name}": group for group in groups.values()}


def _lines(file: Path) -> list[tuple[float, float]]:
    """Longitude and latitude [deg] of a path in GeoJSON, one point in about NEAR_M / 3."""
    try:
        features = json.loads(file.read_text(encoding="utf-8"))["features"]
        points = [(float(p[0]), float(p[1])) for feature in features
                  if feature["geometry"]["type"] == "LineString"
                  for p in feature["geometry"]["coordinates"]]
    except (OSError, ValueError, KeyError, TypeError, IndexError):
        return []
    thinned: list[tuple[float, float]] = []
    for point in points:
        if not thinned or math.hypot(*_metres(point, thinned[-1])) >= NEAR_M / 3:
            thinned.append(point)
    return thinned


def _metres(point: tuple[float, float], origin: tuple[float, float]) -> tuple[float, float]:
    """East and north of the origin, equirectangular: exact enough near places that meet."""
    scale = _EARTH_M * math.pi / 180.0
    east = (point[_EAST] - origin[_EAST] + 180.0) % 360.0 - 180.0
    return (east * scale * math.cos(math.radians(point[_NORTH])),
            (point[_NORTH] - origin[_NORTH]) * scale)


def _cell(point: tuple[float, float]) -> tuple[int, int]:
    return math.floor(point[_EAST] / NEAR_M), math.floor(point[_NORTH] / NEAR_M)


def _boxes_near(a: Sequence[tuple[float, float]], b: Sequence[tuple[float, float]]) -> bool:
    return all(min(p[axis] for p in a) - NEAR_M <= max(p[axis] for p in b) and
               min(p[axis] for p in b) - NEAR_M <= max(p[axis] for p in a)
               for axis in (_EAST, _NORTH))


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
