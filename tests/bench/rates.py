#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs `headway-eval suite` at several frame rates and compares the figures with those at 10 Hz.

    rates.py BIN OUT [--worlds DIR] [--frames N] [--rates 5,10,15,30]

Prints a row for each figure. The status is 1 if a figure is more than 15 % worse than at 10 Hz and by more than what it
can be measured to, unless LIMITS says what physics asks for at that rate.
"""
import argparse
import json
import math
import statistics
import subprocess
import sys

# name: (path in the figures of a world, resolution)
FIGURES = {
    "ATE [m]": (("camera", "both", "ate_rmse_m"), 0.01),
    "lost frames [s]": (("camera", "both", "frames_lost"), 0.2),
    "objects [m]": (("objects", "ours", "all", "rmse_m"), 0.02),
    "prediction ADE [m]": (("predictions_on_tracks", "mixture", "all", "ade_m"), 0.05),
}
# (figure, rate): the physical limit that the table names instead of a failure, and how much worse it lets a figure be.
LIMITS = {
    ("ATE [m]", 5): ("twice the motion between frames", math.inf),
    # Of 16 drives of other seeds the logarithms of the ratios of two rates have a deviation of 0.5: two of them.
    ("ATE [m]", 15): ("the drift of one drive, by chance", math.exp(2 * 0.5)),
    ("ATE [m]", 30): ("the drift of one drive, by chance", math.exp(2 * 0.5)),
    # The same of predictions in one world, over the 13 worlds with objects: 0.14.
    ("prediction ADE [m]", 15): ("a dozen objects, by chance", math.exp(2 * 0.14)),
    ("prediction ADE [m]", 30): ("a dozen objects, by chance", math.exp(2 * 0.14)),
    ("objects [m]", 5): ("half the boxes a second", 1.5),  # 2 ** 0.5 of the noise, and of its spread
    ("prediction ADE [m]", 5): ("half the boxes a second", 1.5),
}
MAX_WORSE = 1.15
REFERENCE_HZ = 10


def value(figures, path):
    for key in path:
        if not isinstance(figures, dict) or key not in figures:
            return None
        figures = figures[key]
    return figures


def suite(options, rate):
    folder = f"{options.out}/{rate}hz"
    path = f"{options.out}/{rate}hz.json"
    command = [f"{options.bin}/headway-eval", "suite", "-q", "-w", "--reuse", "--rate", str(rate), "--frames",
               str(options.frames), "--worlds", options.worlds, "-o", folder, "--json", path]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def mean_ratio(results, rate, path):
    """Geometric mean over the worlds of a figure's ratio to that at 10 Hz, and the factor of two standard errors."""
    logs = []
    for world, figures in results[REFERENCE_HZ].items():
        reference, figure = value(figures, path), value(results[rate].get(world, {}), path)
        if reference and figure:
            logs.append(math.log(figure / reference))
    if len(logs) < 2:
        return None
    return math.exp(statistics.mean(logs)), math.exp(2 * statistics.stdev(logs) / len(logs) ** 0.5)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bin")
    parser.add_argument("out")
    parser.add_argument("--worlds", default="config/worlds")
    parser.add_argument("--frames", type=int, default=120, help="at the rig's own rate")
    parser.add_argument("--rates", default="5,10,15,30")
    options = parser.parse_args()
    rates = [int(rate) for rate in options.rates.split(",")]
    subprocess.run(["mkdir", "-p", options.out], check=True)
    results = {rate: suite(options, rate) for rate in sorted({REFERENCE_HZ, *rates})}
    print("| world | figure | " + " | ".join(f"{rate} Hz" for rate in rates) + " |")
    print("| --- | --- |" + " ---: |" * len(rates))
    worse = 0
    for world in results[REFERENCE_HZ]:
        for name, (path, resolution) in FIGURES.items():
            figures = {rate: value(results[rate].get(world, {}), path) for rate in results}
            if name.startswith("lost"):
                figures = {rate: lost if lost is None else lost / rate for rate, lost in figures.items()}
            reference = figures[REFERENCE_HZ]
            if reference is None:
                continue
            cells = []
            for rate in rates:
                figure = figures[rate]
                is_worse = figure is None or (figure > MAX_WORSE * reference and figure > reference + resolution)
                note = ""
                limit, factor = LIMITS.get((name, rate), ("", 0.0))
                if is_worse and figure is not None and figure <= factor * reference:
                    note = f" ({limit})"
                elif is_worse:
                    note = " **worse**"
                    worse += 1
                cells.append(("-" if figure is None else f"{figure:.3f}") + note)
            print(f"| {world} | {name} | " + " | ".join(cells) + " |")
    ratios = []
    for rate in rates:
        mean = None if rate == REFERENCE_HZ else mean_ratio(results, rate, FIGURES["ATE [m]"][0])
        is_worse = mean is not None and mean[0] > MAX_WORSE * mean[1]
        worse += is_worse
        cell = "-" if mean is None else f"{mean[0]:.2f} (/ or x {mean[1]:.2f})"
        ratios.append(cell + (" **worse**" if is_worse else ""))
    print("| all | ATE, ratio to that at 10 Hz | " + " | ".join(ratios) + " |")
    print(f"\n{worse} figures are more than 15 % worse than at {REFERENCE_HZ} Hz")
    return 1 if worse else 0


if __name__ == "__main__":
    sys.exit(main())
