# SPDX-License-Identifier: BSD-3-Clause
"""Short recordings, cut from the bundled rawlogs."""
from __future__ import annotations

import pathlib
import subprocess

ENTRIES_PER_FRAME = 4  # image pair, boxes, true pose and true objects


def cut(rawlog: pathlib.Path, plugin: pathlib.Path, first_frame: int, frames: int,
        output: pathlib.Path) -> None:
    """Writes some frames of a rawlog by MRPT's rawlog-edit."""
    first = first_frame * ENTRIES_PER_FRAME
    subprocess.run(["rawlog-edit", "-p", str(plugin), "--cut", "--from-index", str(first),
                    "--to-index", str(first + frames * ENTRIES_PER_FRAME - 1), "-i", str(rawlog),
                    "-o", str(output)], check=True, stdout=subprocess.DEVNULL)
