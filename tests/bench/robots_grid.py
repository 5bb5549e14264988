#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints one row of robots.sh's table: the figures of `headway-eval grid --json` added up.

    robots_grid.py TITLE FIGURES.json...
"""
import json
import sys


def percent(part, whole):
    return f"{100 * part / whole:.1f} %" if whole else "-"


def read(paths):
    figures = []
    for path in paths:
        with open(path, encoding="utf-8") as file:
            figures.append(json.load(file))
    return figures


def counts(figures):
    """Obstacles: visible, observed, found and free alone, from the ratios."""
    visible = figures["occupied"]
    judged = round(figures["judged_ratio"] * visible)
    return [visible, judged, round(figures["found_ratio"] * judged),
            round(figures["free_alone_ratio"] * judged)]


def main():
    all_figures = read(sys.argv[2:])
    total = {key: [sum(column) for column in zip(*(counts(f[key]) for f in all_figures))]
             for key in ("in_reach", "ahead")}
    visible, judged, found, free_alone = total["in_reach"]
    ahead = total["ahead"]
    called, right, strict, phantoms = (sum(f["touch"][key] for f in all_figures) for key in
                                       ("called_occupied", "right", "strictly_right", "phantoms"))
    trodden = sum(f["trodden"] for f in all_figures)
    ghosts = sum(f["ghosts"] for f in all_figures)
    drops = sum(f["drops"] for f in all_figures)
    free = sum(f["drops_free"] for f in all_figures)
    print(f"| {sys.argv[1]} | {visible} | {percent(judged, visible)} | {percent(found, judged)} "
          f"| {percent(free_alone, judged)} | {ahead[0]}, {percent(ahead[2], ahead[1])} "
          f"| {percent(right, called)} ({percent(strict, called)}) of {called} | {phantoms} "
          f"| {percent(ghosts, trodden)} | {drops}, {free} |")


if __name__ == "__main__":
    main()
