# SPDX-License-Identifier: BSD-3-Clause
"""Files that decide on results beside recordings and parameters: programs with their libraries, and networks."""
from __future__ import annotations

import configparser
import os
import re
import subprocess
from pathlib import Path

PROGRAMS = ("headway-import", "headway-replay", "headway-eval", "headway-render")
_INSTALLED_NETWORKS = Path("/usr/share/headway/models")


def program_files(folder: Path) -> list[Path]:
    """The programs, and the libraries of headway that they load."""
    programs = [folder / name for name in PROGRAMS]
    libraries: set[Path] = set()
    for program in programs:
        listed = subprocess.run(["ldd", program], capture_output=True, text=True, check=False)
        libraries.update(map(Path, re.findall(r"libheadway\S* => (/\S+)", listed.stdout)))
    return [*programs, *sorted(libraries)]


def network_files(effective: str) -> list[Path]:
    """Weights and layout that the effective parameters name, or else all that headway would look for."""
    parameters = configparser.ConfigParser(strict=False, interpolation=None)
    parameters.read_string(effective)
    named = [Path(parameters.get("dnn", key, fallback="")) for key in ("model", "layout")]
    if named[0] != Path():
        return [path for path in named if path.is_file()]
    folders = [Path(os.environ.get("HEADWAY_MODELS") or _INSTALLED_NETWORKS), _INSTALLED_NETWORKS]
    return sorted({path for folder in folders for path in folder.glob("*.onnx") if path.is_file()})
