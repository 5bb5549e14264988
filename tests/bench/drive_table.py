#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints the table of drive.sh from the JSON of its cells, or the bars that they miss, one a line.

    drive_table.py [--missed] FOLDER

Times and near misses are compared over the trials of which both reach the goal.
"""
import json
import pathlib
import sys

COUNTS = ("collisions_by_robot", "collisions_by_others", "collisions_with_things", "near_misses")


def cells(folder):
    """{(world and rig): {sense-policy: figures}}, and {seed: {policy: figures}} of detections."""
    worlds, detections = {}, {}
    for path in sorted(pathlib.Path(folder).glob("*.json")):
        figures = json.loads(path.read_text(encoding="utf-8"))
        if path.stem.startswith("detections-"):
            detections[path.stem.split("-")[1]] = figures
            continue
        where, sense, policy = path.stem.rsplit("-", 2)
        worlds.setdefault(where, {})[f"{sense}-{policy}"] = next(iter(figures.values()))
    return worlds, detections


def paired(one, other, key):
    """Sums of a figure over the trials in which both reach the goal."""
    drives = {drive["seed"]: drive for drive in other["drives"] if drive["goal_reached"]}
    pairs = [(drive[key], drives[drive["seed"]][key]) for drive in one["drives"]
             if drive["goal_reached"] and drive["seed"] in drives]
    return sum(a for a, _ in pairs), sum(b for _, b in pairs)


def mean_time(figures):
    """Over the trials that all policies finish; none may have."""
    return f"{figures['mean_time_to_goal_s']:.1f} s" if figures["mean_time_to_goal_s"] > 0 else "-"


def table(worlds, detections):
    print("| world, rig | by | goals | time | by robot | by others | things | near misses |")
    print("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |")
    for where, by in worlds.items():
        for name, figures in by.items():
            print(f"| {where} | {name.replace('-', ', ')} | {figures['goals_reached']} of {figures['trials']} | "
                  f"{mean_time(figures)} | " + " | ".join(str(figures[key]) for key in COUNTS) + " |")
    for seed, by in detections.items():
        for policy, figures in by.items():
            print(f"| seed {seed} | detections, {policy} | {figures['goals_reached']} of {figures['trials']} | "
                  f"{mean_time(figures)} | {figures['collisions']} | {figures['walked_into']} | "
                  f"{figures['pillars_touched']} | - |")


def missed(worlds, detections):
    blind = 0
    ours_s = static_s = ours_near = static_near = 0
    for where, by in worlds.items():
        ours, truth = by["images-time_gated"], by["truth-time_gated"]
        if ours["goals_reached"] < 0.95 * ours["trials"]:
            yield f"{where}: {ours['goals_reached']} of {ours['trials']} goals, must be 95 %"
        for key in ("collisions_by_robot", "collisions_with_things"):
            if ours[key] > 0:
                yield f"{where}: {key} {ours[key]}, must be 0"
        time_s, true_s = paired(ours, truth, "time_s")
        if time_s > 1.3 * true_s:
            yield f"{where}: {time_s / true_s:.2f} of the time by the truth, must be 1.3"
        blind += sum(by[name][key] for name in ("images-static", "images-map")
                     for key in ("collisions_by_robot", "collisions_with_things"))
        times, nears = (paired(ours, by["images-static"], key) for key in ("time_s", "near_misses"))
        ours_s, static_s = ours_s + times[0], static_s + times[1]
        ours_near, static_near = ours_near + nears[0], static_near + nears[1]
    if blind < 10:
        yield f"{blind} collisions without predictions or layer, must be 10: the trials are too easy"
    if ours_s > 0.95 * static_s:
        yield f"predictions need {ours_s:.0f} s, without them {static_s:.0f} s: must save 5 %"
    if ours_near > static_near:
        yield f"predictions: {ours_near} near misses, without them {static_near}"
    for seed, by in detections.items():
        ours, static = by["time_gated"], by["static"]
        if ours["collisions"] > ours["trials"] / 200:
            yield f"detections, seed {seed}: {ours['collisions']} of {ours['trials']} collide, must be 1 of 200"
        if not 0 < ours["mean_time_to_goal_s"] <= 1.1 * static["mean_time_to_goal_s"]:
            yield f"detections, seed {seed}: {mean_time(ours)}, static {mean_time(static)}: must be 1.1 times that"


def main():
    worlds, detections = cells(sys.argv[-1])
    if sys.argv[1] != "--missed":
        return table(worlds, detections)
    for line in missed(worlds, detections):
        print(line)
    return None


if __name__ == "__main__":
    main()
