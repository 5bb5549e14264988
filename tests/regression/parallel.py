#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs programs side by side and compares their results with those of a run alone.

    tests/regression/parallel.py BIN_DIR RAWLOG [--processes 100] [--replays 8]

100 short replays of a few frames at once, and 8 whole replays at once, each into a folder of its
own, must leave the same bytes as one alone; of two replays into one folder, the second is refused.
Exit status 1 if not. Slow: it is run by hand and nightly.
"""
import argparse
import concurrent.futures
import pathlib
import subprocess
import sys
import tempfile

RESULTS = ["trajectory.tum", "trajectory_online.tum", "tracks.csv", "tracks_smoothed.csv",
           "predictions.csv", "detections.csv", "map_points.ply", "map.headway"]


def replay(program, rawlog, folder, options):
    """Exit status and output of a replay."""
    done = subprocess.run([program, "-q", "-i", rawlog, "-o", folder, "--snapshots", "0", *options],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    return done.returncode, done.stdout.decode(errors="replace")


def bytes_of(folder):
    return {name: (folder / name).read_bytes() for name in RESULTS if (folder / name).exists()}


def compare(program, rawlog, folder, count, options, what):
    """Runs one replay alone and `count` at once; number of differences."""
    status, output = replay(program, rawlog, folder / "alone", options)
    if status != 0:
        print(f"{what}: alone: status {status}: {output.strip()}")
        return 1
    expected = bytes_of(folder / "alone")
    faults = 0
    with concurrent.futures.ThreadPoolExecutor(count) as pool:
        runs = [pool.submit(replay, program, rawlog, folder / str(i), options)
                for i in range(count)]
        for i, run in enumerate(runs):
            status, output = run.result()
            found = bytes_of(folder / str(i))
            different = [name for name in expected if found.get(name) != expected[name]]
            if status != 0 or different:
                print(f"{what} {i}: status {status}, different: {different} {output.strip()}")
                faults += 1
    print(f"{count} {what} at once: {faults} faults, {len(expected)} files each")
    return faults


def second_into_one_folder(program, rawlog, folder):
    """Number of faults of two replays into one folder."""
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        runs = [pool.submit(replay, program, rawlog, folder, ["--realtime", "2", "-w"])
                for _ in range(2)]
        results = sorted((run.result() for run in runs), key=lambda result: result[0])
    is_right = results[0][0] == 0 and results[1][0] == 1 and (
        "is writing its results there" in results[1][1] or "exists already" in results[1][1])
    print("two replays into one folder:", "one is refused" if is_right else results)
    return 0 if is_right else 1


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("bin_dir", type=pathlib.Path)
    parser.add_argument("rawlog")
    parser.add_argument("--processes", type=int, default=100)
    parser.add_argument("--replays", type=int, default=8)
    arguments = parser.parse_args()
    program = arguments.bin_dir / "headway-replay"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        faults = compare(program, arguments.rawlog, folder / "short", arguments.processes,
                         ["--to-index", "3"], "short replays")
        faults += compare(program, arguments.rawlog, folder / "whole", arguments.replays, [],
                          "whole replays")
        faults += second_into_one_folder(program, arguments.rawlog, folder / "one")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
