#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the covariances of a replay's poses with their errors against the truth of headway-sim.

    tests/bench/slam/pose_nees.py OUTDIR NAME.truth [OUTDIR NAME.truth]...

OUTDIR is the folder of a replay, NAME.truth that of its recording. The first poses of both are made
equal. A row has the greatest errors, the normalised squared errors of the position on the ground (of
its two states) and of the heading, by mean 1 if what is said is honest, and the frames in which one
of them lies beyond 3 standard deviations. Needs python3-numpy.
"""
from __future__ import annotations

import math
import pathlib
import sys

import numpy as np


def poses_of(path: pathlib.Path) -> dict[float, np.ndarray]:
    """4x4 poses of a file of TUM rows, by time to a millisecond."""
    poses = {}
    for row in np.atleast_2d(np.loadtxt(path)):
        x, y, z, w = row[4:8]
        pose = np.eye(4)
        pose[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
        pose[:3, 3] = row[1:4]
        poses[round(row[0], 3)] = pose
    return poses


def covariances_of(path: pathlib.Path) -> dict[float, np.ndarray]:
    covariances = {}
    upper = np.triu_indices(6)
    for row in np.atleast_2d(np.loadtxt(path, delimiter=",", skiprows=1)):
        covariance = np.zeros((6, 6))
        covariance[upper] = row[2:]
        covariances[round(row[1], 3)] = covariance + np.triu(covariance, 1).T
    return covariances


def errors_of(out: pathlib.Path, truth: pathlib.Path) -> np.ndarray:
    """Of each frame but the first: error on the ground [m], of the heading [rad], and both NEES."""
    found = poses_of(out / "trajectory_online.tum")
    true = poses_of(truth / "trajectory.tum")
    said = covariances_of(out / "trajectory_covariance.csv")
    times = sorted(time for time in found if time in true and time in said)
    origin = found[times[0]] @ np.linalg.inv(true[times[0]])
    rows = []
    for time in times[1:]:
        error = np.linalg.inv(found[time]) @ origin @ true[time]
        place, heading = error[:2, 3], math.atan2(error[1, 0], error[0, 0])
        covariance = said[time]
        rows.append((np.hypot(*place), abs(heading),
                     place @ np.linalg.solve(covariance[:2, :2], place) / 2,
                     heading ** 2 / covariance[5, 5]))
    return np.array(rows)


def main() -> None:
    print("| replay | frames | at most | mean NEES: place, heading | beyond 3 sigma |")
    print("| --- | ---: | --- | --- | ---: |")
    for out, truth in zip(sys.argv[1::2], sys.argv[2::2]):
        errors = errors_of(pathlib.Path(out), pathlib.Path(truth))
        beyond = np.count_nonzero((errors[:, 2] > 9 / 2) | (errors[:, 3] > 9))
        metres, heading = errors[:, :2].max(axis=0)
        place, turn = errors[:, 2:].mean(axis=0)
        print(f"| {pathlib.Path(out).name} | {len(errors)} | {metres:.3f} m, {math.degrees(heading):.2f} deg | "
              f"{place:.2f}, {turn:.2f} | {beyond} |")


if __name__ == "__main__":
    main()
