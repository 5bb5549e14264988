#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs every command line of README.md as it is written there, the recipes of
doc/your_recording.md, and the files of sensors of doc/live.md.

    tests/regression/readme_test.py BUILD_DIR SOURCE_DIR

A folder is given the names that the lines use: recordings made by headway-sim, and datasets and a
bag of the same pictures. A line that has no input here fails, so that a new one gets its test.
Commands that build or install are run by the tests of RUN_BY, and its C++ program by
tests/consumer.
"""
from __future__ import annotations

import os
import pathlib
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time

WORLD = """[camera]
width = 320
height = 120
focal_px = 185
[traffic]
vehicles = 3
cyclists = 0
pedestrians = 4
[recording]
frames = 12
"""
SENSORS = """[CAM]
driver = CCameraSensor
grabber_type = rawlog
rawlog_file = mine.rawlog
process_rate = 8
pose_z = 1.65
pose_yaw = -90
pose_roll = -90
"""
STEREO_CAMERA = """image_size: [320, 120]
left: [185, 185, 159.5, 59.5]
baseline_m: 0.54
"""
DEPTH_CAMERA = """image_size: [320, 120]
left: [185, 185, 159.5, 59.5]
"""
EUROC = """sensor_type: camera
T_BS:
  cols: 4
  rows: 4
  data: [0, 0, 1, 0, -1, 0, 0, {shift}, 0, -1, 0, 0, 0, 0, 0, 1]
rate_hz: 10
resolution: [320, 120]
camera_model: pinhole
intrinsics: [185, 185, 159.5, 59.5]
distortion_model: radial-tangential
distortion_coefficients: [0, 0, 0, 0]
"""
KITTI_RAW = """calib_time: 09-Jan-2012 13:57:47
S_rect_00: 320 120
R_rect_00: 1 0 0 0 1 0 0 0 1
P_rect_00: 185 0 159.5 0 0 185 59.5 0 0 0 1 0
P_rect_01: 185 0 159.5 -99.9 0 185 59.5 0 0 0 1 0
"""
# What runs a command instead of this test, and the words by which it does.
RUN_BY = {
    "./demo.sh": ("tests/regression/CMakeLists.txt", "demo.sh"),
    "./test.sh": (".ci/run", "./test.sh"),
    "./fleet.sh": ("tests/workflow/local_test.py", '"fleet.sh"'),
    "./package.sh": ("tests/packages/packages_test.sh", "/package.sh"),
    "apt install": ("tests/packages/use.sh", " /packages/*.deb"),
    "tests/packages/debian13.sh": ("tests/packages/CMakeLists.txt", "/debian13.sh"),
    "cmake --install": ("tests/consumer/build_and_run.cmake", "--install ${BUILD_DIR} --prefix"),
    "doxygen doc/Doxyfile": ("tests/style/doxygen.sh", "doc/Doxyfile"),
    "headway-live --ros2": ("tests/ros2/live_ros2_test.cpp", "--ros2 "),
}
LIVE_SECONDS = 60


def command_lines(readme: str) -> list[str]:
    """Lines of the code blocks without a language, and commands in the text, of which those with
    an optional part are two."""
    lines = []
    blocks = re.compile(r"^```([a-z]*)\n(.*?)^```\n", re.M | re.S)
    for language, block in blocks.findall(readme):
        if not language:
            lines += [line.split(" #")[0].strip() for line in block.splitlines() if line.strip()]
    text = blocks.sub("", readme).replace("\n", " ")
    for command in re.findall(r"`((?:\./|tests/|[a-z][a-z-]* )[^`]*)`", text):
        whole = re.sub(r" \[(.*)\]", r" \1", command)
        lines += sorted({re.sub(r" \[.*\]", "", command), whole})
    return lines


def recipes(document: str) -> list[str]:
    """Lines of the code block of the section Recording."""
    section = re.search(r"^## Recording\n(.*?)^## ", document, re.M | re.S)[1]
    return re.search(r"^```\n(.*?)^```\n", section, re.M | re.S)[1].splitlines()


def live_sensors(document: str) -> dict[str, str]:
    """Files of sensors by name; of those that need a device, the text is empty."""
    files = {}
    for block in re.findall(r"^```ini\n(.*?)^```\n", document, re.M | re.S):
        name, remark = re.match(r"# ([a-z]+\.ini)(.*)\n", block).groups()
        files[name] = "" if "not tried" in remark else block
    return files


def live_lines(document: str, sensors: dict[str, str]) -> list[str]:
    """The runs with these files, without those that need a device."""
    runs = re.findall(r"^headway-live --sensors ([a-z]+\.ini).*$", document, re.M)
    if sorted(runs) != sorted(sensors):
        raise ValueError(f"doc/live.md: files of sensors {sorted(sensors)}, runs with {sorted(runs)}")
    lines = re.findall(r"^headway-live --sensors [a-z]+\.ini.*$", document, re.M)
    return [line for line in lines if sensors[line.split()[2]]]


def is_run_elsewhere(line: str, source: pathlib.Path) -> bool:
    """Whether another test runs it; that test is looked at."""
    for start, (test, words) in RUN_BY.items():
        if line.startswith(start):
            return words in (source / test).read_text(encoding="utf-8")
    return False


def avi(pictures: list[bytes], width: int, height: int) -> bytes:
    """A video of PNG images at 10 Hz."""
    def chunk(name: bytes, content: bytes) -> bytes:
        return name + struct.pack("<I", len(content)) + content + b"\0" * (len(content) % 2)

    count, longest = len(pictures), max(map(len, pictures))
    main = struct.pack("<14I", 100000, 0, 0, 0x10, count, 0, 1, longest, width, height, 0, 0, 0, 0)
    stream = struct.pack("<4s4sIHHIIIIIIII4H", b"vids", b"MPNG", 0, 0, 0, 0, 1, 10, 0, count,
                         longest, 0, 0, 0, 0, width, height)
    format_ = struct.pack("<IiiHH4sIiiII", 40, width, height, 1, 24, b"MPNG", 0, 0, 0, 0, 0)
    movie, index = b"movi", b""
    for picture in pictures:
        index += struct.pack("<4sIII", b"00dc", 0x10, len(movie), len(picture))
        movie += chunk(b"00dc", picture)
    header = chunk(b"LIST", b"hdrl" + chunk(b"avih", main) + chunk(
        b"LIST", b"strl" + chunk(b"strh", stream) + chunk(b"strf", format_)))
    return chunk(b"RIFF", b"AVI " + header + chunk(b"LIST", movie) + chunk(b"idx1", index))


class Inputs:
    """Makes what the lines read."""

    def __init__(self, folder: pathlib.Path, programs: pathlib.Path, source: pathlib.Path) -> None:
        self.folder, self.programs, self.source = folder, programs, source

    def make(self) -> None:
        self.write("world.ini", WORLD)
        self.write("SENSORS.ini", SENSORS)
        self.run("headway-sim", "-q", "-c", "world.ini", "-o", "mine.rawlog")
        for name in ("again", "mon", "tue"):
            shutil.copyfile(self.folder / "mine.rawlog", self.folder / f"{name}.rawlog")
        (self.folder / "RECORDINGS").mkdir()
        shutil.copyfile(self.folder / "mine.rawlog", self.folder / "RECORDINGS/a.rawlog")
        sequence = self.folder / "KITTI/sequences/06"
        sequence.parent.mkdir(parents=True)
        self.run("headway-export", "kitti-odometry", "mine.rawlog", "-o", str(sequence))
        self.left = sorted((sequence / "image_0").iterdir())
        self.right = sorted((sequence / "image_1").iterdir())
        self.kitti_tracking()
        self.kitti_raw()
        self.euroc()
        self.images()
        self.tum()
        self.bag()
        self.videos()

    def kitti_tracking(self) -> None:
        training = "KITTI/training"
        truth = self.folder / "mine.truth"
        labels = [line.split()[:17] for line in (truth / "label_02.txt").read_text().splitlines()]
        self.write(f"{training}/label_02/0012.txt", "".join(f"{' '.join(w)}\n" for w in labels))
        self.copy(truth / "poses_kitti.txt", f"{training}/pose_orbslam3/0012.txt")
        self.copy(truth / "calib.txt", f"{training}/calib/0012.txt")
        for kind, number in (("Pedestrian", "1"), ("Car", "2"), ("Cyclist", "3")):
            rows = [",".join([w[0], number, *w[6:10], "0.9", *w[10:17], w[5]])
                    for w in labels if w[2] == kind]
            self.write(f"{training}/det3d_pointrcnn/{kind}/0012.txt", "\n".join(rows) + "\n")

    def kitti_raw(self) -> None:
        drive = "KITTI_RAW/2011_09_26/2011_09_26_drive_0005_sync"
        for name, text in (("cam_to_cam", KITTI_RAW),
                           ("velo_to_cam", "R: 0 -1 0 0 0 -1 1 0 0\nT: 0 0 -1\n"),
                           ("imu_to_velo", "R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0.5\n")):
            self.write(f"KITTI_RAW/2011_09_26/calib_{name}.txt", text)
        times = "".join(f"2011-09-26 13:04:{32 + 0.1 * k:012.9f}\n" for k in range(len(self.left)))
        for camera, pictures in (("image_00", self.left), ("image_01", self.right)):
            self.write(f"{drive}/{camera}/timestamps.txt", times)
            for k, picture in enumerate(pictures):
                self.copy(picture, f"{drive}/{camera}/data/{k:010}.png")

    def euroc(self) -> None:
        for camera, pictures, shift in (("cam0", self.left, 0), ("cam1", self.right, -0.54)):
            place = f"MH_01_easy/mav0/{camera}"
            rows = ["#timestamp [ns],filename"]
            for k, picture in enumerate(pictures):
                name = f"{1403636579763555584 + k * 100000000}"
                self.copy(picture, f"{place}/data/{name}.png")
                rows.append(f"{name},{name}.png")
            self.write(f"{place}/data.csv", "\n".join(rows) + "\n")
            self.write(f"{place}/sensor.yaml", EUROC.format(shift=shift))

    def images(self) -> None:
        self.write("stereo.yaml", STEREO_CAMERA)
        self.write("camera.yaml", DEPTH_CAMERA)
        for k, (left, right) in enumerate(zip(self.left, self.right)):
            self.copy(left, f"left/{k:06}.png")
            self.copy(right, f"right/{k:06}.png")
            self.copy(left, f"rgb/{k:06}.png")
            self.picture(f"depth/{k:06}.png", 320, 120, 16)

    def tum(self) -> None:
        """Of the published size."""
        place = "rgbd_dataset_freiburg3_long_office_household"
        for kind in ("rgb", "depth"):
            names = [f"{kind}/{k:06}.png" for k in range(3)]
            for name in names:
                self.picture(f"{place}/{name}", 640, 480, 8 if kind == "rgb" else 16)
            self.write(f"{place}/{kind}.txt", "".join(
                f"{1341847980 + 0.1 * k:.6f} {name}\n" for k, name in enumerate(names)))

    def bag(self) -> None:
        """Of ROS 1: the first bytes of a file decide on its format, not its name. An OAK's has the topics that its
        driver depthai publishes."""
        writer = self.source / "tests/bags/writers/write_ros1.py"
        for name, camera in (("drive.mcap", "/stereo"), ("oak.bag", "/oak")):
            subprocess.run(["/usr/bin/python3", str(writer), name, "mono", "none", camera],
                           cwd=self.folder, check=True)

    def videos(self) -> None:
        """Of PNG images in AVI: the first bytes decide here too."""
        self.picture("both.png", 640, 120, 8)
        both = [self.folder / "both.png"] * len(self.left)
        for name, width, pictures in (("left.avi", 320, self.left), ("right.avi", 320, self.right),
                                      ("zed.mp4", 640, both)):
            (self.folder / name).write_bytes(avi([p.read_bytes() for p in pictures], width, 120))

    def picture(self, name: str, width: int, height: int, bits: int) -> None:
        """Stripes of 8 bits, or with 16 bits a wall at 4 m in units of 0.2 mm."""
        sys.path.insert(0, str(self.source / "tests/bags/writers"))
        from recording import png  # type: ignore[import]
        stripes = bytes(7 * u % 256 for u in range(width))
        row = stripes if bits == 8 else (20000).to_bytes(2, "big") * width
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(png(width, height, bits, [row] * height))

    def write(self, name: str, text: str) -> None:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def copy(self, source: pathlib.Path, name: str) -> None:
        (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, self.folder / name)

    def run(self, program: str, *arguments: str) -> None:
        subprocess.run([self.programs / program, *arguments], cwd=self.folder, check=True,
                       stdout=subprocess.DEVNULL)


def run_line(line: str, folder: pathlib.Path, environment: dict[str, str]) -> str:
    """Runs a line in a shell; what is wrong with it, or nothing."""
    with (folder / "output.txt").open("w+b") as output:
        process = subprocess.Popen(["bash", "-c", f"exec {line}"], cwd=folder, env=environment,
                                   stdout=output, stderr=subprocess.STDOUT)
        is_tracked = True
        if line.startswith("headway-live"):  # until Ctrl-C
            is_tracked = wait_for_frames(process, folder / "output.txt")
            process.send_signal(signal.SIGINT)
        status = process.wait()
        output.seek(0)
        text = output.read().decode(errors="replace")
    if not is_tracked:
        return f"no frame was tracked in {LIVE_SECONDS} s: {text.strip()[-400:]}"
    expected = (0, 130) if line.startswith("headway-live") else (0,)
    return "" if status in expected else f"status {status}: {text.strip()[-400:]}"


def wait_for_frames(process: subprocess.Popen[bytes], output: pathlib.Path) -> bool:
    """Waits for headway-live's first line of a tracked frame."""
    end = time.monotonic() + LIVE_SECONDS
    while process.poll() is None and time.monotonic() < end:
        if re.search(r", tracked \([1-9]", output.read_text(encoding="utf-8", errors="replace")):
            return True
        time.sleep(0.1)
    return False


def main() -> int:
    build, source = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    programs = build / "bin"
    readme, recording, live = ((source / name).read_text(encoding="utf-8") for name in
                               ("README.md", "doc/your_recording.md", "doc/live.md"))
    sensors = live_sensors(live)
    lines = list(dict.fromkeys(command_lines(readme) + recipes(recording) +
                               live_lines(live, sensors)))
    environment = {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}",
                   "LD_LIBRARY_PATH": str(build / "lib")}
    faults = 0
    with tempfile.TemporaryDirectory(prefix="headway-readme-") as temporary:
        folder = pathlib.Path(temporary)
        inputs = Inputs(folder, programs, source)
        inputs.make()
        for name, text in sensors.items():
            inputs.write(name, text)
        for line in (line for line in lines if not is_run_elsewhere(line, source)):
            fault = run_line(line, folder, environment)
            print(f"{'FAULT' if fault else 'ok'}: {line}" + (f"\n  {fault}" if fault else ""),
                  flush=True)
            faults += bool(fault)
    if len(lines) < 20:
        print(f"FAULT: only {len(lines)} lines were found")
        faults += 1
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
