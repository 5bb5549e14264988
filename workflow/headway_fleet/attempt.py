# SPDX-License-Identifier: BSD-3-Clause
"""One attempt at a job: programs within their memory, a scratch folder, a log."""
from __future__ import annotations

import ctypes
import os
import shutil
import signal
import subprocess
import tempfile
from pathlib import Path
from types import TracebackType

from .plan import STATE, Job, Settings

_POLL_S = 0.1
_PR_SET_PDEATHSIG = 1


class JobFailure(Exception):
    """Why a job has no result: one line, and the step in which it failed."""

    def __init__(self, step: str, cause: str) -> None:
        super().__init__(cause)
        self.step = step
        self.cause = cause


class Attempt:
    """Runs programs in a scratch folder that is removed at the end.

        with Attempt(settings, job) as attempt:
            attempt.run("replay", "headway-replay", ["-i", rawlog, "-o", str(attempt.folder / "r")])
    """

    def __init__(self, settings: Settings, job: Job) -> None:
        self._settings = settings
        self._job = job
        self.peak_memory_mb = 0.0
        place = scratch_place(settings)
        place.mkdir(parents=True, exist_ok=True)
        self.folder = Path(tempfile.mkdtemp(prefix="headway-fleet-", dir=place))
        self.log = self.folder / "log.txt"
        self._libc = ctypes.CDLL(None, use_errno=True)

    def __enter__(self) -> Attempt:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        shutil.rmtree(self.folder, ignore_errors=True)

    def run(self, step: str, program: str, arguments: list[str],
            folder: Path | None = None) -> None:
        """Runs a program to its end. Raises JobFailure with the program's own error line."""
        command = [str(self._settings.programs / program), *arguments]
        errors = self.folder / "errors.txt"
        with self.log.open("a", encoding="utf-8") as log:
            log.write(f"$ {' '.join(command)}\n")
        with self.log.open("ab") as out, errors.open("wb") as err:
            try:
                process = subprocess.Popen(command, stdout=out, stderr=err,
                                           stdin=subprocess.DEVNULL, preexec_fn=self._die_with_us,
                                           cwd=folder or self._settings.working_folder)
            except OSError as error:
                raise JobFailure(step, f"{command[0]}: cannot be run: {error.strerror}") from error
            used = self._watch(process)
        text = errors.read_text(encoding="utf-8", errors="replace")
        with self.log.open("a", encoding="utf-8") as log:
            log.write(text)
        limit = self._job.resources.memory_mb
        if used > limit:
            raise JobFailure(step, f"{program} used {used:.0f} MB, more than the {limit} MB of its "
                                   "job; give more by --memory, or by memory_mb in the list")
        if process.returncode != 0:
            raise JobFailure(step, _cause(program, process.returncode, text))

    def _watch(self, process: subprocess.Popen[bytes]) -> float:
        """Waits for the end, and ends a program that exceeds its memory; its resident MB."""
        used = 0.0
        try:
            while True:
                used = _resident_mb(process.pid) or used
                self.peak_memory_mb = max(self.peak_memory_mb, used)
                if used > self._job.resources.memory_mb:
                    process.kill()
                    process.wait()
                    return used
                try:
                    process.wait(_POLL_S)
                    return 0.0
                except subprocess.TimeoutExpired:
                    continue
        except BaseException:  # an interrupt: the program must not outlive its job
            process.kill()
            process.wait()
            raise

    def _die_with_us(self) -> None:
        self._libc.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def scratch_place(settings: Settings) -> Path:
    """The node's own disk in a job of Slurm, the folder of results otherwise."""
    chosen = os.environ.get("HEADWAY_FLEET_SCRATCH")
    if chosen:
        return Path(chosen)
    if "SLURM_JOB_ID" in os.environ:
        return Path(os.environ.get("SLURM_TMPDIR") or tempfile.gettempdir())
    return settings.out / STATE / "scratch"


def one_line(text: str, length: int = 400) -> str:
    """The last line that is not empty, printable and short."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    line = "".join(c if c.isprintable() else "?" for c in lines[-1]) if lines else ""
    return line if len(line) <= length else line[: length - 1] + "…"


def _cause(program: str, status: int, errors: str) -> str:
    if status < 0:
        number = -status
        try:
            name = signal.Signals(number).name
        except ValueError:
            name = f"signal {number}"
        if number == signal.SIGKILL:
            return f"{program} was killed ({name}), by the system if its memory was short"
        return f"{program} ended by {name}"
    return one_line(errors) or f"{program} ended with status {status} and no message"


def _resident_mb(pid: int) -> float:
    """0 if the process has ended."""
    try:
        with open(f"/proc/{pid}/statm", encoding="ascii") as file:
            pages = int(file.read().split()[1])
    except (OSError, IndexError, ValueError):
        return 0.0
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


