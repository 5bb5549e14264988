# SPDX-License-Identifier: BSD-3-Clause
"""Which paths on the earth meet."""
from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Sequence

# Cameras that see the same facades or shelves; standalone fixes are off by up to 5 m each.
NEAR_M = 15.0
_EARTH_M = 6371008.8  # mean radius
_EAST, _NORTH = 0, 1

Line = list[tuple[float, float]]


def read_path(file: Path) -> Line:
    """Longitude and latitude [deg] of a path in GeoJSON, one point in about NEAR_M / 3."""
    try:
        features = json.loads(file.read_text(encoding="utf-8"))["features"]
        points = [(float(p[0]), float(p[1])) for feature in features
                  if feature["geometry"]["type"] == "LineString"
                  for p in feature["geometry"]["coordinates"]]
    except (OSError, ValueError, KeyError, TypeError, IndexError):
        return []
    thinned: Line = []
    for point in points:
        if not thinned or math.hypot(*_metres(point, thinned[-1])) >= NEAR_M / 3:
            thinned.append(point)
    return thinned


def groups_that_meet(paths: Sequence[Line]) -> list[list[int]]:
    """Indices of paths that come within NEAR_M of each other, directly or through others."""
    if not paths:
        return []
    origin = paths[0][0]
    local = [[_metres(point, origin) for point in line] for line in paths]
    group = list(range(len(local)))
    for i, first in enumerate(local):
        for j in range(i):
            if group[i] != group[j] and _boxes_near(first, local[j]) and \
                    _paths_meet(first, local[j]):
                old, new = max(group[i], group[j]), min(group[i], group[j])
                group = [new if value == old else value for value in group]
    return [[i for i, value in enumerate(group) if value == index] for index in sorted(set(group))]


def _paths_meet(first: Sequence[tuple[float, float]], second: Sequence[tuple[float, float]]) -> bool:
    """Whether a point of one path is within NEAR_M of a point of the other (both thinned)."""
    cells: dict[tuple[int, int], Line] = {}
    for point in first:
        cells.setdefault(_cell(point), []).append(point)
    for point in second:
        column, row = _cell(point)
        for near in ((column + i, row + j) for i in (-1, 0, 1) for j in (-1, 0, 1)):
            if any(math.dist(point, other) <= NEAR_M for other in cells.get(near, [])):
                return True
    return False


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
