#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints one row of robots.sh's table of ellipses: the figures of `headway-eval predictions --json` added up.

    robots_ellipses.py TITLE FIGURES.json...

Of people who go straight on, turn and stand: the ratios of true positions in the 90 % ellipse at 1, 2 and 3 s.
"""
import sys

from robots_grid import read

COURSES = ("straight on", "turns", "stands")


def inside(figures, course):
    """Ratios over all files, each weighted by its cases, and the number of cases."""
    groups = [f["groups"].get(f"Pedestrian, {course}") for f in figures]
    groups = [group for group in groups if group]
    cases = sum(group["cases"] for group in groups)
    if cases == 0:
        return "-"
    ratios = (sum(group["cases"] * group[f"coverage_90_{s}s"] for group in groups) / cases for s in (1, 2, 3))
    return " / ".join(f"{100 * ratio:.0f}" for ratio in ratios) + f" ({cases})"


def main():
    figures = read(sys.argv[2:])
    print(f"| {sys.argv[1]} | " + " | ".join(inside(figures, course) for course in COURSES) + " |")


if __name__ == "__main__":
    main()
