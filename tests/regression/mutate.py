#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs headway's programs on mutated rawlogs and maps.

    tests/regression/mutate.py BIN_DIR RAWLOG [COUNT] [--seed N]

Required of every run: exit status 0, 1 or 2 (with one line of error), no more than 60 s, no more
than 300 MB beyond a good run, and no NaN or inf in any text file. Exit status 1 if a run fails; its
input is kept in the current folder. The same seed gives the same inputs.
"""
import argparse
import concurrent.futures
import gzip
import os
import pathlib
import random
import re
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import threading
import zlib

TIMEOUT_S = 60
EXTRA_MEMORY_MB = 300
NOT_A_NUMBER = re.compile(r"(?<![\w.])[-+]?(nan|inf|infinity)(?![\w.])", re.IGNORECASE)
NUMBERS = [0, 1, 0x7F, 0x80, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF]
DOUBLES = [float("nan"), float("inf"), -1e300, 1e300, 1e-300, 0.0]


def mutated(data, dice):
    """One to eight changes: bits, numbers, doubles, cuts, repetitions."""
    data = bytearray(data)
    for _ in range(dice.choice([1, 1, 1, 2, 3, 8])):
        if len(data) < 16:
            break
        at = dice.randrange(len(data) - 8)
        kind = dice.randrange(7)
        if kind <= 1:
            data[at] ^= 1 << dice.randrange(8)
        elif kind == 2:
            data[at:at + 4] = struct.pack("<I", dice.choice(NUMBERS))
        elif kind == 3:
            data[at:at + 8] = struct.pack("<d", dice.choice(DOUBLES))
        elif kind == 4:
            del data[at:at + dice.choice([1, 4, 100, 10000])]
        elif kind == 5:
            piece = data[at:at + dice.choice([4, 100, 10000])]
            data[at:at] = piece
        else:
            data[at:at + 64] = bytes(dice.randrange(256) for _ in range(64))
    if dice.randrange(20) == 0:
        del data[dice.randrange(len(data)):]
    return bytes(data)


def headers(data):
    """Places of class names, near which mutations matter more than in pixels."""
    return [found.start() for found in re.finditer(rb"mrpt::|headway::", data)]


def near_headers(data, dice):
    """Mutates 300 bytes behind a class name."""
    places = headers(data)
    if not places or dice.randrange(3) == 0:
        return mutated(data, dice)
    at = dice.choice(places)
    return data[:at] + mutated(data[at:at + 300], dice) + data[at + 300:]


def checksum(data):
    """As core/byte_archive.h: CRC-32 without inversion."""
    return zlib.crc32(data, 0xFFFFFFFF) ^ 0xFFFFFFFF


def mutated_map(data, dice):
    """A map file with valid checksums whose contents are mutated."""
    content = mutated(zlib.decompress(data[36:]), dice)
    packed = zlib.compress(content)
    header = data[:12] + struct.pack("<QQI", len(packed), len(content), checksum(packed))
    return header + struct.pack("<I", checksum(header)) + packed


def run(command):
    """Exit status, output and peak memory [MB] of a program."""
    process = subprocess.Popen(["/usr/bin/env", "bash", "-c", 'ulimit -v 8000000; exec "$@"', "-"]
                               + command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    try:
        output, _ = process.communicate(timeout=TIMEOUT_S)
    except subprocess.TimeoutExpired:
        process.kill()
        output, _ = process.communicate()
        return "timeout", output
    return process.returncode, output


def peak_memory_mb():
    """Largest of all programs run so far."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024


def fault(status, output, folder, memory_limit_mb):
    """What is wrong with a run; empty if nothing is."""
    if status not in (0, 1, 2):
        return f"exit status {status}"
    if status != 0 and output.count(b"\n") != 1:
        return f"{output.count(10)} lines of error"
    if peak_memory_mb() > memory_limit_mb:
        return f"{peak_memory_mb():.0f} MB of memory"
    for path in folder.rglob("*") if folder.is_dir() else []:
        if path.suffix in (".csv", ".tum", ".txt", ".json", ".yaml"):
            found = NOT_A_NUMBER.search(path.read_text(errors="replace"))
            if found:
                return f"{found.group(0)} in {path.name}"
    return ""


def attempt(replay, folder, bad, good_rawlog, memory_limit_mb):
    """What is wrong with a run on a mutated file, with its last words; empty if nothing is."""
    out = folder / (bad.stem + "_out")
    command = ["-i", str(bad)]
    if bad.suffix == ".headway":
        command = ["-i", str(good_rawlog), "--load-map", str(bad)]
    status, output = run(replay + command + ["-o", str(out)])
    reason = fault(status, output, out, memory_limit_mb)
    shutil.rmtree(out, ignore_errors=True)
    if not reason:
        bad.unlink()
        return ""
    shutil.move(bad, bad.name)
    return f"{bad.name}: {reason}: {output[-300:].decode(errors='replace').strip()}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bin_dir", type=pathlib.Path)
    parser.add_argument("rawlog", type=pathlib.Path)
    parser.add_argument("count", type=int, nargs="?", default=200)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    replay = [str(options.bin_dir / "headway-replay"), "-q", "--snapshots", "0", "--to-index", "12"]
    dice = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as name, \
            concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        folder = pathlib.Path(name)
        good = folder / "good"
        source = options.rawlog.read_bytes()
        plain = gzip.decompress(source) if source[:2] == b"\x1f\x8b" else source
        plain = plain[:6_000_000]
        good_rawlog = folder / "good.rawlog"
        good_rawlog.write_bytes(plain)
        run(replay + ["-i", str(good_rawlog), "-o", str(good)])
        memory_limit_mb = peak_memory_mb() + EXTRA_MEMORY_MB
        good_map = (good / "map.headway").read_bytes()
        faults = []

        def collect(run_ended):
            if run_ended.result():
                faults.append(run_ended.result())
                print(run_ended.result(), flush=True)

        free = threading.Semaphore(2 * os.cpu_count())  # so that few inputs are on the disk
        for index in range(options.count):
            is_map = index % 4 == 3
            bad = folder / f"mutated_{options.seed}_{index}{'.headway' if is_map else '.rawlog'}"
            if is_map:
                change = mutated if dice.randrange(4) == 0 else mutated_map
                bad.write_bytes(change(good_map, dice))
            else:
                bad.write_bytes(near_headers(plain, dice))
            free.acquire()
            run_ended = pool.submit(attempt, replay, folder, bad, good_rawlog, memory_limit_mb)
            run_ended.add_done_callback(collect)
            run_ended.add_done_callback(lambda _: free.release())
        pool.shutdown()
    print(f"{options.count} mutated inputs, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
