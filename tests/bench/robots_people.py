#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints one row of robots.sh's table of people: the figures of `headway-eval people --json` added up.

    robots_people.py TITLE FIGURES.json...
"""
import json
import sys

from robots_grid import percent

RANGES = ("0.5-1.5", "1.5-3", "3-7", "7-")


def main():
    figures = []
    for path in sys.argv[2:]:
        with open(path, encoding="utf-8") as file:
            figures.append(json.load(file))

    def total(key):
        return sum(f[key] for f in figures)

    cells = []
    for group in ("walking", "standing"):
        for name in RANGES:
            found, persons = (sum(f[group].get(name, {}).get(key, 0) for f in figures)
                              for key in ("found", "person_frames"))
            cells.append(f"{percent(found, persons)} ({persons})" if persons else "-")
    false_tracks = sum(len(f["false_moving_tracks"]) for f in figures)
    cells += [percent(total("false_rows"), total("rows")),
              percent(total("person_rows_right"), total("person_rows")), str(false_tracks)]
    print(f"| {sys.argv[1]} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
