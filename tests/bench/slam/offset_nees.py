#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares what is said of the disparities' offset with the truth of simulated rigs.

    tests/bench/slam/offset_nees.py [--seeds 51] [--worlds hall,campus,...] [--rigs small,robot] [--out DIR]

The calibration of such a rig is wrong as real ones are (headway-sim, [calibration_error]). A row has
the true offset by the right camera's yaw, the one that headway-replay prints with its standard
deviation, and their normalised squared error; the mean of the latter is 1 if what is said is honest.
"""
from __future__ import annotations

import argparse
import json
import math
import pathlib
import re
import statistics
import subprocess

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


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", default="51")
    parser.add_argument("--worlds", default="hall,campus,warehouse,yard-loop")
    parser.add_argument("--rigs", default="small,robot")
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/offset_nees")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    squared = []
    print("| world | rig | seed | true px | said px | sigma px | NEES |")
    print("| --- | --- | ---: | ---: | ---: | ---: | ---: |", flush=True)
    for world in options.worlds.split(","):
        for rig in options.rigs.split(","):
            for seed in options.seeds.split(","):
                rawlog = options.out / f"{world}-{rig}-{seed}.rawlog"
                run("headway-sim", "-c", ROOT / f"config/worlds/{world}.ini", "--rig", rig, "--seed",
                    seed, "--frames", options.frames, "-o", rawlog, "--set", "camera.colour=false")
                run("headway-replay", "-i", rawlog, "-o", rawlog.with_suffix(""), "--snapshots", 0,
                    "--detector", "none")
                summary = json.loads((rawlog.with_suffix("") / "summary.json").read_text("utf-8"))
                said = re.search(r"disparities (\S+) \+- (\S+) px", summary["rectification"])
                truth = true_offset((rawlog.with_suffix(".truth") / "world.ini").read_text("utf-8"))
                squared.append(((float(said[1]) - truth) / float(said[2])) ** 2)
                print(f"| {world} | {rig} | {seed} | {truth:.3f} | {said[1]} | {said[2]} | "
                      f"{squared[-1]:.2f} |", flush=True)
    print(f"mean NEES {statistics.mean(squared):.2f} of {len(squared)}")


if __name__ == "__main__":
    main()
