# SPDX-License-Identifier: BSD-3-Clause
"""One run at a time in a folder of results."""
from __future__ import annotations

import contextlib
import fcntl
import shutil
from pathlib import Path
from typing import Iterator

from .errors import FleetError
from .plan import STATE


@contextlib.contextmanager
def locked(out: Path) -> Iterator[None]:
    """One run at a time in a folder of results. The lock ends with the process, even if killed."""
    state = out / STATE
    try:
        state.mkdir(parents=True, exist_ok=True)
        file = (state / "lock").open("a", encoding="utf-8")
    except OSError as error:
        raise FleetError(f"{out}: cannot be written: {error.strerror}") from error
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise FleetError(f"{out}: another headway-fleet is writing its results there; wait "
                             "for its end or choose another folder") from error
        shutil.rmtree(state / "scratch", ignore_errors=True)  # of runs that were killed
        yield
