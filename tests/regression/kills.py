#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Kills replays at random moments, and replays what is left in the map of the last checkpoint.

    kills.py BIN_DIR RAWLOG TRUTH_DIR [KILLS [SEED]]

Ends with status 1 if a killed run leaves rows that are not whole or is not called unfinished, if
the second run fails, if both trajectories together lack a frame, or if their error differs by more
than 5 % and 10 mm from an uninterrupted run's: on the street that error is 12 mm, and lies between
10 and 20 mm if a parameter of SLAM changes by 1 to 4 %.
"""
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

CHECKPOINT = ["--set", "output.checkpoint_s=0.3", "--snapshots", "0", "-q"]
ERROR_FLOOR_M = 0.01  # differences of the error below it do not count
OVERLAP = 3  # frames


def run(*words):
    return subprocess.run([str(w) for w in words], capture_output=True, text=True, check=False)


def read_json(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def rows_of(path):
    with open(path, encoding="utf-8") as file:
        return file.readlines()


def ate_m(bin_dir, trajectory, truth):
    result = run(f"{bin_dir}/headway-eval", "trajectory", "-q", "-w", "--truth",
                 f"{truth}/trajectory.tum", "--estimate", trajectory, "--json", f"{trajectory}.json")
    if result.returncode != 0:
        raise RuntimeError(result.stderr)
    return read_json(f"{trajectory}.json")["ate_rmse_m"]


def torn(folder):
    for name in os.listdir(folder):
        if name.endswith((".csv", ".tum", ".txt")) and not name.startswith("."):
            with open(f"{folder}/{name}", "rb") as file:
                content = file.read()
            if content and not content.endswith(b"\n"):
                return name
    return None


def kill_and_go_on(bin_dir, rawlog, folder, rng, seconds):
    """Returns the rows of both trajectories, None if there was no checkpoint, or an error."""
    command = [f"{bin_dir}/headway-replay", "-i", rawlog, "-o", folder] + CHECKPOINT
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    time.sleep(rng.uniform(0.0, seconds))
    process.send_signal(signal.SIGKILL)
    errors = process.communicate()[1].decode()
    if process.returncode != -signal.SIGKILL:
        return None if process.returncode == 0 else f"status {process.returncode}: {errors.strip()}"
    if os.path.isdir(folder) and torn(folder):
        return f"torn: {torn(folder)}"
    if not os.path.exists(f"{folder}/summary.json"):
        return None
    summary = read_json(f"{folder}/summary.json")
    if not str(summary["ended_early"]).startswith("killed after the checkpoint"):
        return f"ended_early: {summary['ended_early']}"
    before = rows_of(f"{folder}/trajectory.tum")
    after = f"{folder}/after"
    # The last frames again, by whose images the camera is recognised.
    first = max(len(before) - OVERLAP, 0)
    result = run(f"{bin_dir}/headway-replay", "-i", rawlog, "-o", after, "--from-index", first,
                 "--load-map", f"{folder}/map.headway", *CHECKPOINT)
    if result.returncode != 0:
        return result.stderr.strip()
    rows = rows_of(f"{after}/trajectory.tum")
    begin = float(rows[0].split()[0])
    return [row for row in before if float(row.split()[0]) < begin - 1e-4] + rows


def main():
    bin_dir, rawlog, truth = sys.argv[1:4]
    wanted = int(sys.argv[4]) if len(sys.argv) > 4 else 100
    seed = int(sys.argv[5]) if len(sys.argv) > 5 else 1
    rng = random.Random(seed)
    errors_m, failures = [], []
    with tempfile.TemporaryDirectory() as temporary:
        start = time.time()
        result = run(f"{bin_dir}/headway-replay", "-i", rawlog, "-o", f"{temporary}/whole",
                     *CHECKPOINT)
        seconds = time.time() - start
        if result.returncode != 0:
            sys.exit(f"{rawlog}: {result.stderr}")
        whole = rows_of(f"{temporary}/whole/trajectory.tum")
        expected = ate_m(bin_dir, f"{temporary}/whole/trajectory.tum", truth)
        for number in range(10 * wanted):
            if len(errors_m) + len(failures) >= wanted:
                break
            folder = f"{temporary}/{number}"
            outcome = kill_and_go_on(bin_dir, rawlog, folder, rng, seconds)
            if isinstance(outcome, str):
                failures.append(f"run {number}: {outcome}")
            elif outcome is not None and len(outcome) != len(whole):
                failures.append(f"run {number}: {len(outcome)} of {len(whole)} frames")
            elif outcome is not None:
                with open(f"{folder}/both.tum", "w", encoding="utf-8") as file:
                    file.writelines(outcome)
                errors_m.append(ate_m(bin_dir, f"{folder}/both.tum", truth))
                if abs(errors_m[-1] - expected) > 0.05 * expected + ERROR_FLOOR_M:
                    failures.append(f"run {number}: {errors_m[-1]} m, not {expected} m")
            subprocess.run(["rm", "-rf", folder], check=True)
    print(f"{len(errors_m)} runs, seed {seed}; uninterrupted {expected:.4f} m; mean "
          f"{sum(errors_m) / len(errors_m):.4f}, {min(errors_m):.4f} to {max(errors_m):.4f}")
    for failure in failures:
        print(failure, file=sys.stderr)
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
