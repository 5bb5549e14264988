# SPDX-License-Identifier: BSD-3-Clause
"""State of a Slurm job for Snakemake: prints running, success or failed.

    python3 -m headway_fleet.slurm_status JOBID

All jobs are asked for by one `squeue`, at most every few seconds, whose answer is kept in a file of
the working directory. How a job failed is recorded in `ended/` by its name, for the page.
"""
from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

from .files import write_atomically

_KEPT_S = 5.0
_CACHE = Path("squeue.txt")
_FORMAT = "%A|%T|%N|%r|%j"
_RUNNING = {"PENDING", "RUNNING", "CONFIGURING", "COMPLETING", "SUSPENDED", "REQUEUED",
            "REQUEUE_HOLD", "REQUEUE_FED", "RESIZING", "SIGNALING", "STAGE_OUT", "STOPPED",
            "SPECIAL_EXIT", "PREEMPTED"}
RULES = {"import_recording": "import", "process_recording": "process", "map_place": "place",
         "run_world": "world"}


def state_of(job: str, answer: str) -> tuple[str, str, str, str] | None:
    """State, node, reason and name of a job in an answer of squeue; None if it is not listed."""
    for line in answer.splitlines():
        fields = line.split("|", 4)
        if len(fields) == 5 and fields[0] == job:
            return fields[1], fields[2], fields[3], fields[4]
    return None


def ended_cause(state: str, node: str, reason: str, log: str) -> str:
    """Why a job without a result ended: one line with the remedy."""
    if state == "OUT_OF_MEMORY" or "exceeded memory limit" in log or "oom-kill" in log.lower():
        return ("used more memory than its job has in Slurm; give more by --memory, or by "
                "memory_mb in the list")
    if state == "TIMEOUT":
        return ("took longer than its job has in Slurm; give more by --minutes, or by minutes in "
                "the list")
    if state in ("NODE_FAIL", "BOOT_FAIL"):
        return f"its node {node} ended ({state})"
    if state == "CANCELLED":
        return "was cancelled in Slurm"
    return f"ended in Slurm with state {state}" + (f" ({reason})" if reason != "None" else "")


def _answer() -> str | None:
    """None while Slurm does not answer."""
    try:
        if time.time() - _CACHE.stat().st_mtime < _KEPT_S:
            return _CACHE.read_text(encoding="utf-8")
    except OSError:
        pass
    done = subprocess.run(["squeue", "--noheader", "--states=all", "--user", str(os.getuid()),
                           "--format", _FORMAT], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return None
    write_atomically(_CACHE, done.stdout)
    return done.stdout


def _forgotten(job: str) -> tuple[str, str, str, str]:
    """The state of a job that squeue lists no more, from the accounting, if there is one."""
    done = subprocess.run(["sacct", "-X", "-n", "-P", "-o", "State,NodeList,JobName", "-j", job],
                          capture_output=True, text=True, check=False)
    fields = done.stdout.strip().split("|")
    if done.returncode != 0 or len(fields) != 3:
        return "UNKNOWN", "", "None", ""
    return fields[0].split()[0], fields[1], "None", fields[2]


def main() -> int:
    job = sys.argv[1]
    answer = _answer()
    if answer is None:
        print("running")
        return 0
    state, node, reason, name = state_of(job, answer) or _forgotten(job)
    if state in _RUNNING:
        print("running")
        return 0
    if state == "COMPLETED":
        print("success")
        return 0
    rule, _, identifier = name.partition(".")
    if rule in RULES and identifier:
        try:
            log = Path(f"logs/slurm-{job}.txt").read_text(encoding="utf-8", errors="replace")
        except OSError:
            log = ""
        record = {"step": "Slurm", "cause": ended_cause(state, node, reason, log)}
        write_atomically(Path("ended") / RULES[rule] / f"{identifier}.json", json.dumps(record))
    print("failed")
    return 0


if __name__ == "__main__":
    sys.exit(main())
