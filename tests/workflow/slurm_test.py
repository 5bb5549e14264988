#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A fleet on a real Slurm whose node ends: nothing is lost, and nothing is done twice.

    tests/workflow/slurm_test.py BIN_DIR PLUGIN RAWLOGS

40 recordings on two virtual nodes: 38 cuts of the bundled rawlogs, a corrupt rawlog, and one whose
job may use too little memory. One node ends midway. Exit status 1 and a line for each fault.
Minutes long: label nightly. It needs slurmctld, slurmd, slurm-client, munge and snakemake.
"""
from __future__ import annotations

import csv
import pathlib
import subprocess
import sys
import tempfile
import time

from cuts import cut
from small_slurm import SmallSlurm

GOOD, FRAMES = 38, 12
faults: list[str] = []


def expect(holds: bool, claim: str) -> None:
    print(("ok:    " if holds else "FAULT: ") + claim, flush=True)
    if not holds:
        faults.append(claim)


def make_recordings(folder: pathlib.Path, plugin: pathlib.Path, rawlogs: pathlib.Path) -> None:
    rows = []
    for i in range(GOOD + 1):
        name = f"{'street' if i % 2 else 'hall'}{i:02}"
        source = rawlogs / ("street.rawlog" if i % 2 else "hall.rawlog")
        cut(source, plugin, 5 * (i // 2), FRAMES, folder / f"{name}.rawlog")
        rows.append([f"{name}.rawlog", "60" if i == GOOD else ""])
    (folder / "corrupt.rawlog").write_bytes(b"no rawlog" * 1000)
    rows.append(["corrupt.rawlog", ""])
    with (folder / "list.csv").open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([["path", "memory_mb"], *rows])


def finished(out: pathlib.Path) -> dict[str, tuple[int, int]]:
    """Inode and time of each recording's result."""
    return {file.parent.name: (file.stat().st_ino, file.stat().st_mtime_ns)
            for file in out.glob("recordings/*/result.json")}


def table(out: pathlib.Path) -> list[dict[str, str]]:
    with (out / "fleet.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def end_a_node_midway(slurm: SmallSlurm, out: pathlib.Path,
                      fleet: subprocess.Popen[bytes]) -> tuple[list[str], dict[str, tuple[int, int]]]:
    """The jobs that ran on it, and what was finished before."""
    while fleet.poll() is None:
        before = finished(out)
        ended = slurm.end_node("node2") if len(before) >= 10 else []
        if ended:
            return ended, before
        time.sleep(0.5)
    return [], {}


def check(slurm: SmallSlurm, command: list[str], out: pathlib.Path) -> None:
    with subprocess.Popen(command, env=slurm.environment) as fleet:
        ended, before = end_a_node_midway(slurm, out, fleet)
        status = fleet.wait()
    rows = table(out)
    causes = {row["name"]: row["cause"] for row in rows if row["status"] == "failed"}
    expect(status == 1, "the exit status tells that something failed")
    expect(len(rows) == GOOD + 2, f"all {GOOD + 2} recordings are in the table")
    expect(sum(row["status"] == "done" for row in rows) == GOOD, f"{GOOD} results")
    expect(len(causes) == 2, f"two causes: {causes}")
    expect("is not a rawlog" in causes.get("corrupt", ""), "the corrupt rawlog is named")
    expect(any("more than the 60 MB" in cause for cause in causes.values()),
           "the job over its memory is named")
    expect(len(ended) == 1, f"a job ran on the node that ended: {ended}")
    restarts = slurm.restarts()
    expect({job for job, count in restarts.items() if count} == set(ended) and
           all(restarts[job] == 1 for job in ended),
           "the ended node's jobs, and no others, were requeued once")
    expect(len(restarts) == GOOD + 2, "each recording was submitted once")
    after = finished(out)
    expect(bool(before) and all(after.get(name) == value for name, value in before.items()),
           f"the {len(before)} recordings that were finished did not run again")
    expect(all(float(row["frames"]) == FRAMES for row in rows if row["status"] == "done"),
           "every result has all frames")

    subprocess.run(command, env=slurm.environment, check=False)
    expect(finished(out) == after, "run again, no finished recording runs")
    expect(len(slurm.restarts()) == GOOD + 4, "run again, the two failed ones are tried")


def main() -> int:
    bin_dir, plugin, rawlogs = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
    with tempfile.TemporaryDirectory(prefix="headway-fleet-test-") as temporary:
        folder = pathlib.Path(temporary)
        (folder / "recordings").mkdir()
        make_recordings(folder / "recordings", plugin, rawlogs)
        out = folder / "out"
        command = [str(bin_dir / "headway-fleet"), str(folder / "recordings" / "list.csv"), "-o", str(out),
                   "--profile", "slurm", "--memory", "1000", "--places", "none"]
        with SmallSlurm(folder / "slurm") as slurm:
            check(slurm, command, out)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
