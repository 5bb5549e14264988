#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures what a right camera costs that is turned against its calibration.

    tests/bench/slam/turned_camera.py [--seeds 1,2,3] [--worlds street] [--degrees 0.1,0.3] [--out DIR]

Each world is recorded with the exact rig and with the right camera turned by each angle about each
axis (headway-sim, [calibration_error]), while the calibration claims the exact rig. The table has
medians over the seeds: ATE RMSE (mean and worst beside it), its ratio to that of the exact rig and
to the path, and recall and precision of moving objects. A world is one of config/worlds, or straight
of this folder, where nothing moves. The last column is the verdict of the first seed. A replay that
is refused counts as such. Existing recordings in DIR (default out/turned_camera) are used again.
"""
from __future__ import annotations

import argparse
import json
import math
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[3]
BIN = ROOT / "build/release/bin"
AXES = ("pitch", "yaw", "roll")


def run(program: str, *arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([BIN / program, *map(str, arguments)], capture_output=True, text=True,
                          check=False)


def required(program: str, *arguments: object) -> str:
    done = run(program, *arguments)
    if done.returncode != 0:
        sys.exit(f"{program}: {done.stderr.strip()}")
    return done.stdout


def record(rawlog: pathlib.Path, world: str, seed: int, axis: str, degrees: float,
           options: argparse.Namespace) -> None:
    if rawlog.exists():
        return
    folder = pathlib.Path(__file__).parent if world == "straight" else ROOT / "config/worlds"
    arguments = ["-q", "-c", folder / f"{world}.ini", "--seed", seed, "-o", rawlog,
                 "--frames", options.frames, "--set", "camera.colour=false",
                 "--set", "recording.storage=external_png"]
    for setting in options.sim:
        arguments += ["--set", setting]
    if options.rig:
        arguments += ["--rig", options.rig]
    if options.odometry:
        arguments += ["--set", "camera.odometry=true"]
    # Nothing but the turned camera is wrong.
    for key in ("focal_ratio", "baseline_ratio", "flex_deg", *(f"right_{a}_deg" for a in AXES)):
        value = degrees if key == f"right_{axis}_deg" else 0
        arguments += ["--set", f"calibration_error.{key}={value}"]
    required("headway-sim", *arguments)


def path_length(trajectory: pathlib.Path) -> float:
    points = [tuple(map(float, line.split()[1:4]))
              for line in trajectory.read_text(encoding="utf-8").splitlines()
              if line and not line.startswith("#")]
    return sum(math.dist(a, b) for a, b in zip(points, points[1:]))


def measure(rawlog: pathlib.Path, options: argparse.Namespace) -> dict[str, object]:
    """Figures of one replay; only "refused" if it was refused."""
    out = rawlog.with_suffix("")
    truth = out.with_suffix(".truth")
    extra = [word for setting in options.set for word in ("--set", setting)]
    done = run("headway-replay", "-q", "-w", "-i", rawlog, "-o", out, "--snapshots", 0,
               "--detector", options.detector, *extra)
    if done.returncode != 0:
        return {"refused": done.stderr.strip().splitlines()[-1]}
    required("headway-eval", "trajectory", "-w", "--truth", truth / "trajectory.tum", "--estimate",
             out / "trajectory.tum", "--json", out / "ate.json")
    required("headway-eval", "movers", "-w", "--truth", truth / "label_02.txt", "--poses",
             truth / "trajectory.tum", "--estimate", out, "--json", out / "movers.json")
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    movers = json.loads((out / "movers.json").read_text(encoding="utf-8"))
    ate = json.loads((out / "ate.json").read_text(encoding="utf-8"))["ate_rmse_m"]
    return {"ate": ate, "path": path_length(truth / "trajectory.tum"),
            "recall": movers["within_40m"]["recall"], "precision": movers["within_40m"]["precision"],
            "tracked": summary["frames_tracked"] if "frames_tracked" in summary else "",
            "cpu": summary["cpu_ms_per_frame"], "verdict": summary.get("rectification", "")}


def median(rows: list[dict[str, object]], key: str) -> float:
    return statistics.median([row[key] for row in rows if row.get(key) is not None] or [math.nan])


def report(world: str, name: str, rows: list[dict[str, object]], exact: float) -> float:
    """Prints one row of the table; returns the ATE."""
    measured = [row for row in rows if "refused" not in row]
    refused = [row["refused"] for row in rows if "refused" in row]
    verdict = refused[0] if refused else rows[0]["verdict"]
    if not measured:
        print(f"| {world} | {name} | refused | | | | | | | {verdict} |", flush=True)
        return math.nan
    ate = median(measured, "ate")
    count = f" ({len(refused)} refused)" if refused else ""
    ates = [row["ate"] for row in measured]
    print(f"| {world} | {name} | {ate:.4f}{count} | {statistics.mean(ates):.4f}, {max(ates):.4f} | "
          f"{ate / (exact or ate):.2f} | {100 * ate / median(measured, 'path'):.3f} | "
          f"{100 * median(measured, 'recall'):.1f} | {100 * median(measured, 'precision'):.1f} | {median(measured, 'cpu'):.1f} | {verdict} |",
          flush=True)
    for row in measured:
        print(f"#   {row['ate']:.4f} m, recall {row['recall']}, precision {row['precision']}",
              file=sys.stderr)
    return ate


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--worlds", default="street")
    parser.add_argument("--rig", default="", help="predefined rig of headway-sim")
    parser.add_argument("--degrees", default="0.1,0.3")
    parser.add_argument("--axes", default=",".join(AXES))
    parser.add_argument("--frames", type=int, default=120)
    parser.add_argument("--odometry", action="store_true", help="record wheel odometry")
    parser.add_argument("--set", action="append", default=[], help="parameters of the replay")
    parser.add_argument("--sim", action="append", default=[], help="parameters of the recording")
    parser.add_argument("--detector", default="stereo_motion")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/turned_camera")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    print("| world | right camera | ATE m | mean, worst | ratio | % of the path | recall % | "
          "precision % | CPU ms | verdict |")
    print("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |", flush=True)
    cases = [("exact", "", 0.0)]
    for degrees in options.degrees.split(","):
        cases += [(f"{axis} {degrees}", axis, float(degrees)) for axis in options.axes.split(",")]
    for world in options.worlds.split(","):
        exact = 0.0
        for name, axis, degrees in cases:
            rows = []
            for seed in map(int, options.seeds.split(",")):
                rig = f"-{options.rig}" if options.rig else ""
                case = name.replace(' ', '-').replace('.', '_')
                rawlog = options.out / f"{world}{rig}-{seed}-{case}.rawlog"
                record(rawlog, world, seed, axis, degrees, options)
                rows.append(measure(rawlog, options))
            ate = report(world, name, rows, exact)
            exact = exact or ate


if __name__ == "__main__":
    main()
