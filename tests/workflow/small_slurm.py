# SPDX-License-Identifier: BSD-3-Clause
"""A whole Slurm on one machine: munged, slurmctld and one slurmd for each virtual node."""
from __future__ import annotations

import os
import pathlib
import shutil
import signal
import subprocess
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol")

# The limits of time are far above what a busy machine takes for a message or a start: Slurm takes a
# node or job that exceeds one for lost, and requeues it.
CONFIGURATION = """\
ClusterName=headwaytest
SlurmctldHost=localhost
SlurmctldPort={port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=60
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
MailProg=/bin/true
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherFrequency=1
JobAcctGatherParams=OverMemoryKill
ReturnToService=0
SlurmdTimeout=30
MessageTimeout=60
BatchStartTimeout=60
KillWait=2
MinJobAge=3600
SlurmdParameters=config_overrides
SchedulerParameters=batch_sched_delay=1,sched_interval=5
NodeName=node1 NodeHostname=localhost NodeAddr=127.0.0.1 Port={port1} CPUs=1 RealMemory=4000
NodeName=node2 NodeHostname=localhost NodeAddr=127.0.0.1 Port={port2} CPUs=1 RealMemory=4000
PartitionName=main Nodes=node1,node2 Default=YES MaxTime=INFINITE State=UP
"""


class SmallSlurm:
    """Two nodes of one core each, for the time of a `with`; `environment` leads programs to it."""

    def __init__(self, folder: pathlib.Path, first_port: int = 26817) -> None:
        missing = [name for name in PROGRAMS if not _program(name)]
        if missing:
            raise RuntimeError(f"{', '.join(missing)}: not installed; "
                               "tests/workflow/packages.txt lists the packages")
        self.folder = folder
        self.configuration = folder / "slurm.conf"
        self.environment = {**os.environ, "SLURM_CONF": str(self.configuration)}
        self._daemons: dict[str, int] = {}
        self._first_port = first_port

    def __enter__(self) -> SmallSlurm:
        for name in ("state", "node1", "node2"):
            (self.folder / name).mkdir(parents=True)
        os.chmod(self.folder, 0o755)
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(64))
        key.chmod(0o600)
        user = subprocess.run(["id", "-un"], capture_output=True, text=True, check=True)
        self.configuration.write_text(CONFIGURATION.format(
            folder=self.folder, user=user.stdout.strip(), port=self._first_port,
            port1=self._first_port + 1, port2=self._first_port + 2), encoding="utf-8")
        self._start("munged", f"--key-file={key}", f"--socket={self.folder}/munge.socket",
                    f"--pid-file={self.folder}/munged.pid", f"--log-file={self.folder}/munged.log",
                    f"--seed-file={self.folder}/munge.seed", "--force")
        self._start("slurmctld", "-f", str(self.configuration))
        for node in ("node1", "node2"):
            self._start("slurmd", "-f", str(self.configuration), "-N", node, name=node)
        self._wait_for_nodes()
        return self

    def __exit__(self, *_: object) -> None:
        for node in ("node1", "node2"):
            if node in self._daemons:
                self._kill_node(node)
        for name in reversed(list(self._daemons)):
            _kill(self._daemons.pop(name), signal.SIGTERM)

    def end_node(self, node: str) -> list[str]:
        """Ends a node as a loss of power does: slurmd, and all processes of its jobs; their ids.

        All are stopped before they are ended, so that no job of those ids finishes meanwhile. A node
        without jobs goes on, and the list is empty.
        """
        _signal(self._daemons[node], signal.SIGSTOP)
        processes = self._processes_of(node)
        for process in processes:
            _signal(process, signal.SIGSTOP)
        time.sleep(2.0)  # for messages on their way to slurmctld
        jobs = self._running_on(node)
        if not jobs:
            for process in [*processes, self._daemons[node]]:
                _signal(process, signal.SIGCONT)
            return []
        self._kill_node(node)
        return jobs

    def ask(self, *command: str) -> list[str]:
        """Lines that a command of Slurm prints."""
        done = subprocess.run(command, env=self.environment, capture_output=True, text=True,
                              check=True)
        return done.stdout.splitlines()

    def restarts(self) -> dict[str, int]:
        """How often each job was requeued, by its id."""
        result = {}
        for line in self.ask("scontrol", "show", "job", "-o"):
            fields = dict(word.split("=", 1) for word in line.split() if "=" in word)
            result[fields["JobId"]] = int(fields["Restarts"])
        return result

    def _start(self, program: str, *arguments: str, name: str = "") -> None:
        subprocess.run([_program(program), *arguments], env=self.environment, check=True)
        name = name or program
        file = self.folder / f"{name}.pid"
        for _ in range(100):
            if file.is_file() and file.read_text(encoding="ascii").strip():
                self._daemons[name] = int(file.read_text(encoding="ascii"))
                return
            time.sleep(0.1)
        raise RuntimeError(f"{program} did not start; see {self.folder}/{name}.log")

    def _wait_for_nodes(self) -> None:
        for _ in range(60):
            try:
                if self.ask("sinfo", "-h", "-o", "%D %t") == ["2 idle"]:
                    return
            except subprocess.CalledProcessError:
                pass
            time.sleep(1.0)
        raise RuntimeError(f"the nodes did not come up; see {self.folder}/*.log")

    def _running_on(self, node: str) -> list[str]:
        return [line.split()[0] for line in self.ask("squeue", "-h", "-t", "running", "-o", "%A %N")
                if line.split()[1:] == [node]]

    def _kill_node(self, node: str) -> None:
        processes = self._processes_of(node)
        for process in [self._daemons.pop(node), *processes]:
            _kill(process, signal.SIGKILL)

    def _processes_of(self, node: str) -> list[int]:
        """The processes of the jobs on a node, and their slurmstepd."""
        jobs = self._running_on(node)
        return [int(process.name) for process in pathlib.Path("/proc").iterdir()
                if process.name.isdigit() and self._is_of(process, node, jobs)]

    def _is_of(self, process: pathlib.Path, node: str, jobs: list[str]) -> bool:
        """Whether a process of this Slurm is one of these jobs or their slurmstepd, or any on the node."""
        try:
            environment = (process / "environ").read_bytes().split(b"\0")
            title = (process / "cmdline").read_bytes()
        except OSError:
            return False
        if f"SLURM_CONF={self.configuration}".encode() not in environment:
            return False
        return f"SLURMD_NODENAME={node}".encode() in environment or any(
            f"SLURM_JOB_ID={job}".encode() in environment or
            title.startswith(f"slurmstepd: [{job}.".encode()) for job in jobs)


def _program(name: str) -> str:
    return shutil.which(name, path=f"{os.environ.get('PATH', '')}:/usr/sbin:/sbin") or ""


def _signal(process: int, number: signal.Signals) -> None:
    try:
        os.kill(process, number)
    except ProcessLookupError:
        pass


def _kill(process: int, number: signal.Signals) -> None:
    """Ends a process and waits for its end: slurmctld saves its state before."""
    try:
        os.kill(process, number)
        for _ in range(300):
            os.kill(process, 0)
            time.sleep(0.1)
    except ProcessLookupError:
        pass
