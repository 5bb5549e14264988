#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Kills replays at random moments, continues them, and compares with an uninterrupted run.

    kills.py BIN_DIR RAWLOG TRUTH_DIR [KILLS [SEED]]

Ends with status 1 if a continued run fails, lacks a frame or has rows that are not whole, if its
number of tracks or rows differs by more than 5 % from an uninterrupted run's, or the error of its
trajectory by more than 5 % and 10 mm: on the street that error is 12 mm, and lies between 10 and
20 mm if a parameter of SLAM changes by 1 to 4 %.
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


def run(*words):
    return subprocess.run([str(w) for w in words], capture_output=True, text=True, check=False)


def figures(bin_dir, folder, truth):
    result = run(f"{bin_dir}/headway-eval", "trajectory", "-q", "-w", "--truth",
                 f"{truth}/trajectory.tum", "--estimate", f"{folder}/trajectory.tum", "--json",
                 f"{folder}/ate.json")
    if result.returncode != 0:
        raise RuntimeError(result.stderr)
    with open(f"{folder}/ate.json", encoding="utf-8") as file:
        ate = json.load(file)["ate_rmse_m"]
    with open(f"{folder}/summary.json", encoding="utf-8") as file:
        summary = json.load(file)
    with open(f"{folder}/tracks.csv", encoding="utf-8") as file:
        rows = sum(1 for _ in file)
    return {"ate_m": ate, "frames": summary["frames"], "tracked": summary["frames_tracked"],
            "tracks": summary["tracks_confirmed"], "moving": summary["tracks_moving"],
            "rows": rows, "ended_early": summary["ended_early"],
            "continued": len(summary["continued_after"])}


def torn(folder):
    for name in os.listdir(folder):
        if name.endswith((".csv", ".tum", ".txt")) and not name.startswith("."):
            with open(f"{folder}/{name}", "rb") as file:
                content = file.read()
            if content and not content.endswith(b"\n"):
                return name
    return None


def kill_and_continue(bin_dir, rawlog, folder, rng, seconds):
    """One run, killed up to three times. Returns the number of kills, or an error."""
    command = [f"{bin_dir}/headway-replay", "-i", rawlog, "-o", folder] + CHECKPOINT
    kills = 0
    while True:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        if kills < 3:
            time.sleep(rng.uniform(0.0, seconds))
            if process.poll() is None:
                process.send_signal(signal.SIGKILL)
                kills += 1
        errors = process.communicate()[1].decode()
        if process.returncode == 0:
            return kills
        if process.returncode != -signal.SIGKILL:
            return f"status {process.returncode}: {errors.strip()}"
        if os.path.isdir(folder) and torn(folder):
            return f"torn: {torn(folder)}"
        if os.path.exists(f"{folder}/replay.json"):
            command = [f"{bin_dir}/headway-replay", "-q", "--continue", folder]
        else:
            command = [f"{bin_dir}/headway-replay", "-i", rawlog, "-o", folder, "-w"] + CHECKPOINT


def main():
    bin_dir, rawlog, truth = sys.argv[1:4]
    wanted = int(sys.argv[4]) if len(sys.argv) > 4 else 100
    seed = int(sys.argv[5]) if len(sys.argv) > 5 else 1
    rng = random.Random(seed)
    errors_m, failures, kills, worst = [], [], 0, {"ate_m": 0.0, "tracks": 0.0, "moving": 0.0, "rows": 0.0}
    with tempfile.TemporaryDirectory() as temporary:
        whole = f"{temporary}/whole"
        start = time.time()
        result = run(f"{bin_dir}/headway-replay", "-i", rawlog, "-o", whole, *CHECKPOINT)
        seconds = time.time() - start
        if result.returncode != 0:
            sys.exit(f"{rawlog}: {result.stderr}")
        expected = figures(bin_dir, whole, truth)
        for number in range(10 * wanted):
            if kills >= wanted:
                break
            folder = f"{temporary}/{number}"
            outcome = kill_and_continue(bin_dir, rawlog, folder, rng, seconds)
            if isinstance(outcome, str):
                failures.append(f"run {number}: {outcome}")
                kills += 1
                continue
            kills += outcome
            got = figures(bin_dir, folder, truth)
            errors_m.append(got["ate_m"])
            if (got["frames"], got["ended_early"]) != (expected["frames"], None):
                failures.append(f"run {number}: {got}")
            for name in worst:
                floor = ERROR_FLOOR_M if name == "ate_m" else 2
                difference = max(0.0, abs(got[name] - expected[name]) - floor)
                worst[name] = max(worst[name], difference / expected[name])
                if difference > 0.05 * expected[name]:
                    failures.append(f"run {number}: {name} {got[name]}, not {expected[name]}")
            subprocess.run(["rm", "-rf", folder], check=True)
    print(f"{kills} kills, seed {seed}, {len(errors_m)} runs; uninterrupted {expected}; ate_m mean "
          f"{sum(errors_m) / len(errors_m):.4f}, {min(errors_m):.4f} to {max(errors_m):.4f}; largest "
          "relative differences beyond the floor "
          + ", ".join(f"{name} {value:.3f}" for name, value in worst.items()))
    for failure in failures:
        print(failure, file=sys.stderr)
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
