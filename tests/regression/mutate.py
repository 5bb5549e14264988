#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs headway's programs on mutated rawlogs and maps.

    tests/regression/mutate.py BIN_DIR RAWLOG [COUNT] [--seed N]

Required of every run: exit status 0, 1 or 2 (with one line of error), no more than 60 s and 10
times the processor time of a good run on an input of that size, no more than 300 MB beyond a good
run, and no NaN or inf in any text file. Exit status 1 if a run fails; its input is kept in the
current folder. The same seed gives the same inputs.
"""
import argparse
import concurrent.futures
import dataclasses
import gzip
import os
import pathlib
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import threading
import zlib

TIMEOUT_S = 60
TIMES_LONGER = 10
LEAST_TIMES = 3  # of the whole good run: a cut rawlog may still hold all frames that are run
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


@dataclasses.dataclass
class Run:
    """How a program ended."""
    status: int
    output: bytes
    processor_s: float
    memory_mb: float


def run(command):
    """Runs a program, and kills it after the time that it has."""
    with tempfile.TemporaryFile() as words:
        process = subprocess.Popen(
            ["/usr/bin/env", "bash", "-c", 'ulimit -v 8000000; exec "$@"', "-"] + command,
            stdout=words, stderr=subprocess.STDOUT)
        killer = threading.Timer(TIMEOUT_S, process.kill)
        killer.start()
        _, status, usage = os.wait4(process.pid, 0)
        killer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        words.seek(0)
        return Run(process.returncode, words.read(), usage.ru_utime + usage.ru_stime,
                   usage.ru_maxrss / 1024)


@dataclasses.dataclass
class Limits:
    """What a run may take, from a good one of the same program."""
    size: int
    processor_s: float
    memory_mb: float

    def __init__(self, size, good):
        self.size = size
        self.processor_s = good.processor_s
        self.memory_mb = good.memory_mb + EXTRA_MEMORY_MB

    def seconds(self, size):
        """Of an input of a size."""
        return self.processor_s * max(LEAST_TIMES, TIMES_LONGER * size / self.size)


def fault(ended, folder, size, limits):
    """What is wrong with a run; empty if nothing is."""
    if ended.status not in (0, 1, 2):
        return f"exit status {ended.status}"
    if ended.status != 0 and ended.output.count(b"\n") != 1:
        return f"{ended.output.count(10)} lines of error"
    if ended.memory_mb > limits.memory_mb:
        return f"{ended.memory_mb:.0f} MB of memory, limit {limits.memory_mb:.0f}"
    if ended.processor_s > limits.seconds(size):
        return f"{ended.processor_s:.1f} s, limit {limits.seconds(size):.1f}"
    for path in folder.rglob("*") if folder.is_dir() else []:
        if path.suffix in (".csv", ".tum", ".txt", ".json", ".yaml"):
            found = NOT_A_NUMBER.search(path.read_text(errors="replace"))
            if found:
                return f"{found.group(0)} in {path.name}"
    return ""


def attempt(replay, folder, bad, good_rawlog, limits):
    """What is wrong with a run on a mutated file, with its last words; empty if nothing is."""
    out = folder / (bad.stem + "_out")
    command = ["-i", str(bad)]
    if bad.suffix == ".headway":
        command = ["-i", str(good_rawlog), "--load-map", str(bad)]
    ended = run(replay + command + ["-o", str(out)])
    reason = fault(ended, out, bad.stat().st_size, limits[bad.suffix])
    shutil.rmtree(out, ignore_errors=True)
    if not reason:
        bad.unlink()
        return ""
    shutil.move(bad, bad.name)
    return f"{bad.name}: {reason}: {ended.output[-300:].decode(errors='replace').strip()}"


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
        of_rawlog = run(replay + ["-i", str(good_rawlog), "-o", str(good)])
        good_map = (good / "map.headway").read_bytes()
        of_map = run(replay + ["-i", str(good_rawlog), "--load-map", str(good / "map.headway"),
                               "-o", str(folder / "loaded")])
        limits = {".rawlog": Limits(len(plain), of_rawlog),
                  ".headway": Limits(len(good_map), of_map)}
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
            run_ended = pool.submit(attempt, replay, folder, bad, good_rawlog, limits)
            run_ended.add_done_callback(collect)
            run_ended.add_done_callback(lambda _: free.release())
        pool.shutdown()
    print(f"{options.count} mutated inputs, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
