# SPDX-License-Identifier: BSD-3-Clause
"""Files and folders that appear whole or not at all."""
from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path


def write_atomically(path: Path, text: str) -> None:
    """Writes a file beside its place and renames it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    descriptor, partial = tempfile.mkstemp(dir=path.parent, prefix=".partial-")
    try:
        with os.fdopen(descriptor, "w", encoding="utf-8", newline="") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
            os.fchmod(file.fileno(), 0o666 & ~_umask())
        os.replace(partial, path)
    except BaseException:
        Path(partial).unlink(missing_ok=True)
        raise


def publish(result: Path, target: Path) -> bool:
    """Moves a finished file or folder to its place by one rename, across file systems too.

    Returns False, and leaves the place as it is, if something is there already.
    """
    if target.exists():
        return False
    target.parent.mkdir(parents=True, exist_ok=True)
    beside = Path(tempfile.mkdtemp(dir=target.parent, prefix=".partial-"))
    try:
        copy = beside / target.name
        shutil.move(result, copy)  # renames within a file system, copies to another
        if target.exists():
            return False
        try:
            os.rename(copy, target)
        except OSError:
            if target.exists():  # another attempt was faster
                return False
            raise
        return True
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
