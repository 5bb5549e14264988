#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the seeds of the bags' fuzz targets: bag_seeds.py NODE_DIR, where the tests installed npm's packages.

A file's first bytes, which the target adds, are left out. Of messages the first byte selects the type.
"""
import base64
import json
import os
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
WRITERS = HERE.parent / "bags" / "writers"
ENVIRONMENT = dict(os.environ, SMALL_RECORDING="1", PYTHONDONTWRITEBYTECODE="1")
TYPES = ["Image", "CompressedImage", "CameraInfo", "Imu", "Odometry", "LaserScan", "NavSatFix", "TFMessage"]


def seed(target, name, content):
    folder = HERE / "corpus" / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content)


def run(*call, **options):
    return subprocess.run([str(word) for word in call], check=True, env=ENVIRONMENT, **options)


def ros2(form, out, compression):
    messages = run("/usr/bin/python3", WRITERS / "recording.py", form, stdout=subprocess.PIPE).stdout
    run("node", WRITERS / "write_ros2.mjs", out, compression, input=messages, cwd=sys.argv[1])


for form, compression in (("mono", "none"), ("compressed", "lz4"), ("rgbd", "bz2")):
    run("/usr/bin/python3", WRITERS / "write_ros1.py", "/tmp/seed.bag", form, compression)
    seed("ros1_bag", form, pathlib.Path("/tmp/seed.bag").read_bytes()[len(b"#ROSBAG V2.0\n"):])
for form, compression in (("mono", "none"), ("compressed", "lz4"), ("rgbd", "zstd")):
    ros2(form, "/tmp/seed.mcap", compression)
    seed("mcap_bag", form, pathlib.Path("/tmp/seed.mcap").read_bytes()[8:])
for form in ("mono", "compressed", "rgbd", "rgbd_float", "rgbd_compressed"):
    ros2(form, "/tmp/seed.json", "none")
    lines = pathlib.Path("/tmp/seed.json").read_bytes()
    if form == "mono":
        pathlib.Path("/tmp/seed.db3").unlink(missing_ok=True)
        run("/usr/bin/python3", WRITERS / "write_db3.py", "/tmp/seed.db3", input=b"\n".join(lines.split(b"\n")[:40]))
        seed("sqlite_bag", form, pathlib.Path("/tmp/seed.db3").read_bytes())
    for line in map(json.loads, lines.splitlines()):
        kind = line["type"].split("/")[-1]
        if form != "mono" and "Image" not in kind:
            continue
        seed("bag_messages", form + "_" + kind,
             bytes([128 + TYPES.index(kind)]) + base64.b64decode(line["base64"]))
