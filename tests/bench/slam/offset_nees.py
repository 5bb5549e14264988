#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares what is said of the disparities' offset with the truth of simulated rigs.

    tests/bench/slam/offset_nees.py [--seeds 51,52] [--worlds hall,...] [--rigs small,...] [--out DIR]

The calibration of such a rig is wrong as real ones are (headway-sim, [calibration_error]), focal
length and angles by a Gaussian of its own for each row. A row has the true offset by the right
camera's yaw, the one that headway-replay prints with its standard deviation, and their normalised
squared error; the mean of the latter is 1 if what is said is honest. Recordings are removed.
"""
from __future__ import annotations

import argparse
import json
import math
import pathlib
import random
import re
import shutil
import statistics
import subprocess

SIGMAS = {"focal_ratio": 0.003, "right_yaw_deg": 0.01, "right_pitch_deg": 0.02, "right_roll_deg": 0.03}
ROOT = pathlib.Path(__file__).resolve().parents[3]
BIN = ROOT / "build/release/bin"


def run(program: str, *arguments: object) -> None:
    subprocess.run([BIN / program, "-q", "-w", *map(str, arguments)], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def true_offset(world: str) -> float:
    """In the mean over the image, of the world.ini beside the truth [px]."""
    def value(key: str) -> float:
        found = re.search(rf"^{key} = (\S+)", world, re.MULTILINE)
        return float(found[1]) if found else 0.0
    focal, width = value("focal_px"), value("width")
    yaw = math.radians(value("right_yaw_deg"))
    return yaw * focal * (1 + (width / focal) ** 2 / 12)


def said_offset(world: str, rig: str, seed: str, frames: int, out: pathlib.Path) -> list[float]:
    """True offset, the one that a replay says, and its standard deviation [px]; NaN: it says none."""
    rawlog = out / f"{world}-{rig}-{seed}.rawlog"
    drawn = random.Random(f"{world} {rig} {seed}")
    errors = [word for key, sigma in SIGMAS.items()
              for word in ("--set", f"calibration_error.{key}={drawn.gauss(0, sigma):.5f}")]
    run("headway-sim", "-c", ROOT / f"config/worlds/{world}.ini", "--rig", rig, "--seed", seed,
        "--frames", frames, "-o", rawlog, "--set", "camera.colour=false", *errors)
    results, truth = rawlog.with_suffix(""), rawlog.with_suffix(".truth")
    run("headway-replay", "-i", rawlog, "-o", results, "--snapshots", 0, "--detector", "none",
        "--set", "grid.period_s=0")
    summary = json.loads((results / "summary.json").read_text("utf-8"))
    said = re.search(r"disparities (\S+) \+- (\S+) px", summary.get("rectification", ""))
    row = [true_offset((truth / "world.ini").read_text("utf-8")),
           *(map(float, said.groups()) if said else (math.nan, math.nan))]
    rawlog.unlink()
    for folder in (results, truth, rawlog.with_name(rawlog.stem + "_Images")):
        shutil.rmtree(folder)
    return row


def report(name: str, squared: list[float]) -> None:
    squared = [value for value in squared if not math.isnan(value)]
    within = sum(value < 4 for value in squared)
    print(f"{name}: mean NEES {statistics.mean(squared):.2f}, worst {max(squared):.1f}, "
          f"{within} of {len(squared)} within 2 sigma", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", default="51")
    parser.add_argument("--worlds", default="hall,campus,warehouse,yard-loop")
    parser.add_argument("--rigs", default="small,robot,car")
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/offset_nees")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    rows = {}
    print("| world | rig | seed | true px | said px | sigma px | NEES |")
    print("| --- | --- | ---: | ---: | ---: | ---: | ---: |", flush=True)
    worlds, rigs = options.worlds.split(","), options.rigs.split(",")
    for seed in options.seeds.split(","):
        for world in worlds:
            for rig in rigs:
                truth, said, sigma = said_offset(world, rig, seed, options.frames, options.out)
                rows[world, rig, seed] = ((said - truth) / sigma) ** 2
                print(f"| {world} | {rig} | {seed} | {truth:.3f} | {said:+.2f} | {sigma:.2f} | "
                      f"{rows[world, rig, seed]:.2f} |", flush=True)
    for name in worlds + rigs:
        report(name, [value for key, value in rows.items() if name in key])
    report("all", list(rows.values()))


if __name__ == "__main__":
    main()
