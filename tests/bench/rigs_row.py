#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints one row of rigs.sh's table: the figures of all recordings of a rig added up.

    rigs_row.py RIG NAME.path.json...

Beside NAME.path.json are NAME.people.json, NAME.grid.json, and the results in NAME/.
"""
import json
import sys

from robots_grid import counts, percent

RANGES = ("0.5-1.5", "1.5-3", "3-7")


def read(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def main():
    names = [path[:-len(".path.json")] for path in sys.argv[2:]]
    errors = [read(f"{name}.path.json")["ate_rmse_m"] for name in names]
    people = [read(f"{name}.people.json") for name in names]
    grids = [read(f"{name}.grid.json") for name in names]
    times = [read(f"{name}/summary.json")["cpu_ms_per_frame"] for name in names]
    cells = [f"{sum(errors) / len(errors):.3f} ({max(errors):.3f})"]
    for group in ("walking", "standing"):
        for distance in RANGES:
            found, persons = (sum(f[group].get(distance, {}).get(key, 0) for f in people)
                              for key in ("found", "person_frames"))
            cells.append(f"{percent(found, persons)} ({persons})" if persons else "-")
    cells.append(percent(sum(f["false_rows"] for f in people), sum(f["rows"] for f in people)))
    _, judged, found, _ = (sum(column) for column in zip(*(counts(f["in_reach"]) for f in grids)))
    called, right = (sum(f["touch"][key] for f in grids) for key in ("called_occupied", "right"))
    cells += [percent(found, judged), percent(right, called), f"{sum(times) / len(times):.0f}"]
    print(f"| {sys.argv[1]} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
