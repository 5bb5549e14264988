# SPDX-License-Identifier: BSD-3-Clause
"""Recordings in a folder or a list, of every kind that headway-import reads."""
from __future__ import annotations

import csv
import os
import re
import shlex
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Callable, Iterator

from .errors import FleetError

RAWLOG = "rawlog"
BAG_SUFFIXES = (".bag", ".mcap", ".db3")
RAWLOG_SUFFIXES = (".rawlog", ".rawlog.zst", ".rawlog.gz")
CALIBRATIONS = ("calibration.yaml", "calibration.yml")
LIST_COLUMNS = ("path", "name", "kind", "import", "truth", "labels", "poses", "place", "cores",
                "memory_mb", "minutes")


@dataclass(frozen=True)
class Recording:
    """One recording and what is known of it before it is read.

    `import_options` are those of `headway-import KIND` without `-o`; paths in them are relative to
    `path` for image folders and to the working directory otherwise. `inputs` are the files and
    folders whose contents decide whether the recording must be processed again. `error` names why
    it cannot be used.
    """

    name: str
    path: Path
    kind: str
    import_options: tuple[str, ...] = ()
    inputs: tuple[Path, ...] = ()
    truth: Path | None = None   # folder with trajectory.tum
    labels: Path | None = None  # KITTI tracking labels
    poses: Path | None = None   # true pose of each frame, for labels
    place: str = ""
    cores: int | None = None
    memory_mb: int | None = None
    minutes: int | None = None
    error: str = ""


@dataclass(frozen=True)
class Found:
    """Recordings in order of their names, and the number of files that are none."""

    recordings: list[Recording]
    other_files: int = 0


def find_recordings(folder: Path, excluded: Path | None = None) -> Found:
    """All recordings below a folder; `excluded` (the fleet's results) is not searched.

    Raises FleetError if the folder cannot be read or contains none.
    """
    if not folder.is_dir():
        raise FleetError(f"{folder}: no such folder; give a folder of recordings or a list (.csv)")
    found = list(_below(folder.resolve(), excluded.resolve() if excluded else None))
    recordings = [item for item in found if isinstance(item, Recording)]
    if not recordings:
        raise FleetError(f"{folder}: contains no recordings; doc/fleet.md lists the kinds")
    root = folder.resolve()
    named = [replace(item, name=_name_below(item, root)) for item in recordings]
    return Found(_with_unique_names(named), len(found) - len(recordings))


def read_list(path: Path) -> Found:
    """The recordings of a CSV file with a header; `path` is required in each row.

    A row whose recording is missing or has several readings becomes a recording with an error.
    Raises FleetError naming file and row for an unknown column or a value that is no number.
    """
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
            columns = rows[0].keys() if rows else []
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise FleetError(f"{path}: cannot be read as a list of recordings: {error}") from error
    if not rows:
        raise FleetError(f"{path}: contains no recordings; the first line names the columns, "
                         "of which path is required")
    for column in filter(None, columns):
        if column not in LIST_COLUMNS:
            raise FleetError(f"{path}: unknown column {column!r}; known: {', '.join(LIST_COLUMNS)}")
    if "path" not in columns:
        raise FleetError(f"{path}: has no column path")
    recordings: list[Recording] = []
    for number, row in enumerate(rows, start=2):
        recordings += _of_row(row, path, number)
    return Found(_with_unique_names(recordings))


def _of_row(row: dict[str, str | None], file: Path, number: int) -> list[Recording]:
    text = {key: (value or "").strip() for key, value in row.items() if key is not None}
    if None in row:
        raise FleetError(f"{file}, line {number}: more fields than columns")
    if not text["path"]:
        raise FleetError(f"{file}, line {number}: path is empty")
    folder = file.resolve().parent
    path = folder / text["path"]
    known = {
        "place": text.get("place", ""),
        "cores": _number(text, "cores", file, number),
        "memory_mb": _number(text, "memory_mb", file, number),
        "minutes": _number(text, "minutes", file, number),
    }
    files = {key: folder / text[key] for key in ("truth", "labels", "poses") if text.get(key)}
    recordings = _of_path(path, text.get("kind", ""), text.get("import", ""))
    named = []
    for recording in recordings:
        inputs = recording.inputs + tuple(files.values())
        name = text.get("name", "")
        if len(recordings) > 1 or not name:
            own = recording.name or _stem(recording.path)
            name = f"{name}-{own}" if name else own
        named.append(replace(recording, name=name, inputs=inputs, **known, **files))
    return named


def _of_path(path: Path, kind: str, options: str) -> list[Recording]:
    """The recordings of one path: of the kind that is given, else of the kind that is found."""
    if not path.exists():
        return [Recording("", path, kind or "missing", error="no such file or folder")]
    if kind and kind != RAWLOG:
        return [Recording("", path, kind, tuple(shlex.split(options)) or _own_options(path, kind),
                          (path,))]
    if path.is_file():
        recording = _of_file(path)
        if kind == RAWLOG and (recording is None or recording.kind != RAWLOG):
            recording = _rawlog(path)
        if recording is None:
            return [Recording("", path, "unknown",
                              error="is of no known kind; give the column kind")]
        return [recording]
    found = [item for item in _below(path.resolve(), None) if isinstance(item, Recording)]
    return found or [Recording("", path, "unknown", error="contains no recording")]


def _own_options(path: Path, kind: str) -> tuple[str, ...]:
    if kind == "images":
        recording = _images(path)
        return recording.import_options if recording else ()
    return (str(path),)


def _number(row: dict[str, str], key: str, file: Path, number: int) -> int | None:
    text = row.get(key, "")
    if not text:
        return None
    if not text.isdigit() or int(text) == 0:
        raise FleetError(f"{file}, line {number}: {key} is {text!r}, not a positive whole number")
    return int(text)


def _below(folder: Path, excluded: Path | None) -> Iterator[Recording | Path]:
    """Recordings below a folder, and files that are none."""
    if folder == excluded:
        return
    for test in FOLDER_KINDS:
        found = test(folder)
        if found:
            yield from found
            return
    try:
        entries = sorted(folder.iterdir())
    except OSError as error:
        yield Recording("", folder, "unknown", error=f"cannot be read: {error.strerror}")
        return
    for entry in entries:
        if entry.name.startswith("."):
            continue
        if entry.is_dir():
            if not _is_beside_a_rawlog(entry):
                yield from _below(entry, excluded)
            continue
        recording = _of_file(entry)
        yield recording if recording else entry


def _is_beside_a_rawlog(folder: Path) -> bool:
    return folder.name.endswith((".truth", "_Images", "_images", "_IMAGES"))


def _of_file(path: Path) -> Recording | None:
    if path.name.endswith(RAWLOG_SUFFIXES):
        return _rawlog(path)
    if path.suffix in BAG_SUFFIXES:
        return Recording("", path, "rosbag", (str(path),), (path,))
    return None


def _rawlog(path: Path) -> Recording:
    stem = path.parent / _stem(path)
    truth = Path(f"{stem}.truth")
    inputs = [path] + [Path(f"{stem}{end}") for end in ("_Images", "_images", "_IMAGES")]
    recording = Recording("", path, RAWLOG, (), tuple(p for p in inputs if p.exists()))
    if not (truth / "trajectory.tum").is_file():
        return recording
    labels, poses = truth / "label_02.txt", truth / "poses_kitti.txt"
    has_labels = poses.is_file() and labels.is_file() and labels.stat().st_size > 0
    return replace(recording, truth=truth, inputs=(*recording.inputs, truth),
                   labels=labels if has_labels else None, poses=poses if has_labels else None)


def _euroc(folder: Path) -> list[Recording]:
    if not (folder / "mav0").is_dir():
        return []
    return [Recording("", folder, "euroc", (str(folder),), (folder,))]


def _tum(folder: Path) -> list[Recording]:
    if not ((folder / "rgb.txt").is_file() and (folder / "depth.txt").is_file()):
        return []
    return [Recording("", folder, "tum-rgbd", (str(folder),), (folder,))]


def _kitti_odometry(folder: Path) -> list[Recording]:
    recordings = []
    for sequence in sorted(folder.glob("sequences/*/calib.txt")):
        name = sequence.parent.name
        inputs = [sequence.parent, folder / "poses" / f"{name}.txt"]
        recordings.append(Recording(name, folder, "kitti-odometry",
                                    (str(folder), "--sequence", name),
                                    tuple(p for p in inputs if p.exists())))
    return recordings


def _kitti_tracking(folder: Path) -> list[Recording]:
    training = folder / "training"
    recordings = []
    for poses in sorted(training.glob("pose_orbslam3/*.txt")):
        name = poses.stem
        labels = training / "label_02" / poses.name
        if not labels.is_file():
            continue
        inputs = [labels, poses, training / "calib" / poses.name,
                  *sorted(training.glob(f"det*/*/{poses.name}"))]
        recordings.append(Recording(name, folder, "kitti-tracking",
                                    (str(folder), "--sequence", name),
                                    tuple(p for p in inputs if p.exists()),
                                    labels=labels, poses=poses))
    return recordings


def _kitti_raw(folder: Path) -> list[Recording]:
    recordings = []
    for images in sorted(folder.glob("[0-9]*_[0-9]*_[0-9]*/*/image_00/timestamps.txt")):
        drive = images.parent.parent
        calibration = sorted(drive.parent.glob("calib_*.txt"))
        recordings.append(Recording(drive.name, folder, "kitti-raw",
                                    (str(folder), "--drive", drive.name), (drive, *calibration)))
    return recordings


def _ros2_folder(folder: Path) -> list[Recording]:
    has_parts = any(folder.glob("*.db3")) or any(folder.glob("*.mcap"))
    if not (has_parts and (folder / "metadata.yaml").is_file()):
        return []
    return [Recording("", folder, "rosbag", (str(folder),), (folder,))]


def _images(folder: Path) -> Recording | None:
    calibration = next((name for name in CALIBRATIONS if (folder / name).is_file()), None)
    if calibration is None:
        return None
    for left, other, option in (("left", "right", "--right"), ("image_0", "image_1", "--right"),
                                ("left", "depth", "--depth"), ("rgb", "depth", "--depth")):
        if (folder / left).is_dir() and (folder / other).is_dir():
            options = ("--left", left, option, other, "--calibration", calibration)
            return Recording("", folder, "images", options, (folder,))
    return None


def _image_folders(folder: Path) -> list[Recording]:
    recording = _images(folder)
    return [recording] if recording else []


FOLDER_KINDS: tuple[Callable[[Path], list[Recording]], ...] = (
    _euroc, _tum, _kitti_odometry, _kitti_tracking, _kitti_raw, _ros2_folder, _image_folders)


def _stem(path: Path) -> str:
    name = path.name
    for suffix in (*RAWLOG_SUFFIXES, *BAG_SUFFIXES):
        if name.endswith(suffix):
            return name[: -len(suffix)]
    return name


def _name_below(recording: Recording, root: Path) -> str:
    """The path below the searched folder, and the sequence within a dataset."""
    place = os.path.relpath(recording.path, root)
    parts = [] if place == "." else [*Path(place).parts[:-1], _stem(recording.path)]
    parts += [recording.name] if recording.name else []
    return "-".join(parts) or _stem(recording.path)


def _with_unique_names(recordings: list[Recording]) -> list[Recording]:
    """Names of letters, digits, `.`, `_`, `-`; a number is appended to one that is taken."""
    taken: set[str] = set()
    named = []
    for recording in recordings:
        base = re.sub(r"[^A-Za-z0-9._-]+", "_", recording.name).strip("._-")[:120] or "recording"
        name, count = base, 1
        while name.lower() in taken:
            count += 1
            name = f"{base}-{count}"
        taken.add(name.lower())
        named.append(replace(recording, name=name))
    return sorted(named, key=lambda recording: recording.name)
