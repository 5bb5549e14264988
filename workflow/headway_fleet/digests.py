# SPDX-License-Identifier: BSD-3-Clause
"""SHA-256 of files and folders; what has not changed since is not read again."""
from __future__ import annotations

import concurrent.futures
import hashlib
import json
import os
from pathlib import Path
from typing import Any, Iterable

from .files import write_atomically


def digest_of(value: Any) -> str:
    """Of a value that JSON can express."""
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()


class Digests:
    """Digests of contents, kept in a file with size and time of change of each file.

    A file whose size, time and inode are those of its last reading is not read again; a file that
    was only touched is read again and has the same digest.
    """

    def __init__(self, store: Path) -> None:
        self._store = store
        self._known: dict[str, list[Any]] = {}
        try:
            self._known = json.loads(store.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            self._known = {}

    def read(self, paths: Iterable[Path], threads: int) -> None:
        """Reads the files, and those in the folders, by several threads."""
        files = sorted({file for path in paths for file in _files(path)})
        with concurrent.futures.ThreadPoolExecutor(max(1, threads)) as pool:
            list(pool.map(self._tried, files))
        write_atomically(self._store, json.dumps(self._known))

    def of(self, paths: Iterable[Path]) -> str:
        """Of names and contents below each path. Raises OSError if one cannot be read."""
        contents = []
        for path in paths:
            contents.append([[os.path.relpath(file, path), self._of_file(file)]
                             for file in _files(path)])
        return digest_of(contents)

    def _tried(self, file: Path) -> None:
        try:
            self._of_file(file)
        except OSError:
            pass  # of() reports it for the recording that needs it

    def _of_file(self, file: Path) -> str:
        stat = file.stat()
        state = [stat.st_size, stat.st_mtime_ns, stat.st_ino]
        known = self._known.get(str(file))
        if known and known[:3] == state:
            return str(known[3])
        value = hashlib.sha256()
        with file.open("rb") as stream:
            while block := stream.read(1 << 20):
                value.update(block)
        self._known[str(file)] = [*state, value.hexdigest()]
        return value.hexdigest()


def _files(path: Path) -> list[Path]:
    if not path.is_dir():
        return [path]
    found = []
    for folder, folders, names in os.walk(path):
        folders.sort()
        found += [Path(folder) / name for name in sorted(names)]
    return found
