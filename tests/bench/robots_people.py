#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints one row of robots.sh's tables of people: the figures of `headway-eval people --json` added up.

    robots_people.py [--ways] TITLE FIGURES.json...

With --ways those who walk by how they come, and the time to their first row: its median and the ratio within a second.
"""
import math
import sys

from robots_grid import percent, read

RANGES = ("0.5-1.5", "1.5-3", "3-7", "7-")
TIME_TOLERANCE_S = 1e-3  # times are rounded
WAYS = ("head-on", "crossing", "leaving", "in a group", "from behind something", "robot turns")


def found_of(figures, group, name):
    found, persons = (sum(f[group].get(name, {}).get(key, 0) for f in figures) for key in ("found", "person_frames"))
    return f"{percent(found, persons)} ({persons})" if persons else "-"


def by_range(figures):
    def total(key):
        return sum(f[key] for f in figures)

    cells = [found_of(figures, group, name) for group in ("walking", "standing") for name in RANGES]
    false_tracks = sum(len(f["false_moving_tracks"]) for f in figures)
    return cells + [percent(total("false_rows"), total("rows")), percent(total("person_rows_right"), total("person_rows")),
                    str(false_tracks)]


def by_way(figures):
    cells = [found_of(figures, "ways", name) for name in WAYS]
    times = sorted(math.inf if time is None else time for f in figures for time in f["first_rows_s"])
    if not times:
        return cells + ["-", "-"]
    within = sum(t <= 1.0 + TIME_TOLERANCE_S for t in times)
    return cells + [f"{times[len(times) // 2]:.2f} s", f"{percent(within, len(times))} ({len(times)})"]


def main():
    arguments = sys.argv[1:]
    row = by_range
    if arguments[0] == "--ways":
        arguments, row = arguments[1:], by_way
    print(f"| {arguments[0]} | " + " | ".join(row(read(arguments[1:]))) + " |")


if __name__ == "__main__":
    main()
