#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A fleet by Snakemake on this machine: tests/workflow/local_test.py BIN_DIR PLUGIN RAWLOGS.

A run whose processes are killed is completed by the next; then only what changes runs again. At last
the recordings become a map of their place.
Exit status 1 and a line for each fault. A minute long: label nightly. It needs snakemake.
"""
from __future__ import annotations

import csv
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

from cuts import cut

FRAMES = 12
faults: list[str] = []


def expect(holds: bool, claim: str) -> None:
    print(("ok:    " if holds else "FAULT: ") + claim, flush=True)
    if not holds:
        faults.append(claim)


def results(out: pathlib.Path) -> dict[str, int]:
    """Time of each recording's result."""
    return {file.parent.name.rsplit("-", 1)[0]: file.stat().st_mtime_ns
            for file in out.glob("recordings/*/result.json")}


def rows(out: pathlib.Path) -> dict[str, dict[str, str]]:
    with (out / "fleet.csv").open(newline="", encoding="utf-8") as file:
        return {row["name"]: row for row in csv.DictReader(file)}


def changed(before: dict[str, int], after: dict[str, int]) -> set[str]:
    return {name for name, value in after.items() if before.get(name) != value}


def killed_run(command: list[str], out: pathlib.Path) -> dict[str, int]:
    """Results that exist when all processes of a run are killed after the first two."""
    with subprocess.Popen(command, start_new_session=True) as fleet:
        while fleet.poll() is None and len(results(out)) < 2:
            time.sleep(0.1)
        os.killpg(fleet.pid, signal.SIGKILL)
    return results(out)


def check(command: list[str], recordings: pathlib.Path, out: pathlib.Path) -> None:
    before = killed_run(command, out)
    expect(2 <= len(before) < 6, f"the run is killed midway, after {sorted(before)}")
    status = subprocess.run(command, check=False).returncode
    done = results(out)
    expect(status == 1 and len(done) == 6, "the next run completes it and reports the failures")
    expect(not changed(before, {k: done[k] for k in before}), "what was finished does not run again")
    table = rows(out)
    expect("is not a rawlog" in table["corrupt"]["cause"], "the corrupt rawlog is named")
    expect("cannot be" in table["bag"]["cause"] or "bag" in table["bag"]["cause"],
           f"the bag that cannot be imported is named: {table['bag']['cause']}")
    expect(table["bag"]["step"] == "import", "with its step")

    subprocess.run(command, check=False)
    expect(not changed(done, results(out)), "run again, nothing runs")
    script = pathlib.Path(__file__).resolve().parents[2] / "fleet.sh"
    if pathlib.Path(command[0]).parent == script.parent / "build/release/bin":
        subprocess.run([str(script), *command[1:]], check=False)
        expect(not changed(done, results(out)), "./fleet.sh builds, and finds that nothing is missing")
    (recordings / "s0.rawlog").touch()
    subprocess.run(command, check=False)
    expect(not changed(done, results(out)), "a file that was touched runs nothing")
    (recordings / "s1.rawlog").write_bytes((recordings / "s2.rawlog").read_bytes())
    subprocess.run(command, check=False)
    expect(changed(done, results(out)) == {"s1"}, "a changed recording runs alone")
    done = results(out)
    subprocess.run([*command, "--set", "grid.period_s=0.3"], check=False)
    expect(changed(done, results(out)) == set(done), "another configuration runs all")
    expect(len(list(out.glob("recordings/*/"))) == 6, "and replaces the older results")
    expect("Content-Security-Policy" in (out / "index.html").read_text(encoding="utf-8"),
           "the page is written")


def check_place(command: list[str], out: pathlib.Path) -> None:
    done = results(out)
    subprocess.run(command, check=False)
    expect(not changed(done, results(out)), "for a map of their place, no recording runs again")
    places = [row for row in rows(out).values() if row["kind"] == "place"]
    joined = [row for row in places if "joined" in row["status"] and row["recordings"] == "6"]
    expect(bool(joined) and int(joined[0]["recordings_joined"]) > 1,
           f"recordings of one street become one map: {places}")
    expect(bool(joined) and (out / joined[0]["results"] / "map.headway").is_file(), "which is there")


def main() -> int:
    bin_dir, plugin, rawlogs = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
    with tempfile.TemporaryDirectory(prefix="headway-fleet-test-") as temporary:
        recordings = pathlib.Path(temporary) / "recordings"
        recordings.mkdir()
        for i in range(6):
            cut(rawlogs / "street.rawlog", plugin, 15 * i, FRAMES, recordings / f"s{i}.rawlog")
        (recordings / "corrupt.rawlog").write_bytes(b"no rawlog" * 1000)
        (recordings / "bag.mcap").write_bytes(b"no bag" * 1000)
        out = pathlib.Path(temporary) / "out"
        command = [str(bin_dir / "headway-fleet"), str(recordings), "-o", str(out), "-j", "2"]
        check([*command, "--places", "none"], recordings, out)
        check_place([*command, "--set", "grid.period_s=0.3"], out)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
