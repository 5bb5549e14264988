# SPDX-License-Identifier: BSD-3-Clause
"""The recording that the tests write as bags of several formats: messages as plain values.

Field names are those of ROS 2 (lower case). Frame i is at T0 + i / 10 s.
"""
import base64
import math
import os
import struct
import zlib

T0_NS = 1700000000 * 10**9
WIDTH, HEIGHT, FRAMES = 64, 48, 12
if "SMALL_RECORDING" in os.environ:  # for seeds of fuzzing
    WIDTH, HEIGHT, FRAMES = 16, 12, 2
FOCAL, CX, CY, BASELINE = 50.0, 31.5, 23.5, 0.12


def stamp(ns):
    return {"sec": ns // 10**9, "nanosec": ns % 10**9}


def header(ns, frame):
    return {"stamp": stamp(ns), "frame_id": frame}


def data(values):
    return {"base64": base64.b64encode(bytes(values)).decode()}


def picture(i, offset):
    return [(3 * u + 5 * v + 7 * i + offset) % 256 for v in range(HEIGHT) for u in range(WIDTH)]


def depth_mm(i):
    """A slanted plane, with a hole of 4 x 4 pixels."""
    return [0 if u < 4 and v < 4 else 1000 + 10 * u + v + 100 * i
            for v in range(HEIGHT) for u in range(WIDTH)]


def png(width, height, bits, rows):
    def chunk(name, content):
        checked = name + content
        return struct.pack(">I", len(content)) + checked + struct.pack(">I", zlib.crc32(checked))
    raw = b"".join(b"\0" + row for row in rows)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


def image(ns, frame, encoding, channels, values):
    return {"header": header(ns, frame), "height": HEIGHT, "width": WIDTH, "encoding": encoding,
            "is_bigendian": 0, "step": WIDTH * channels, "data": data(values)}


def compressed(ns, frame, bits, values):
    if bits == 8:
        rows = [bytes(values[v * WIDTH:(v + 1) * WIDTH]) for v in range(HEIGHT)]
        return {"header": header(ns, frame), "format": "mono8; png compressed ",
                "data": data(png(WIDTH, HEIGHT, 8, rows))}
    rows = [struct.pack(">%dH" % WIDTH, *values[v * WIDTH:(v + 1) * WIDTH]) for v in range(HEIGHT)]
    return {"header": header(ns, frame), "format": "16UC1; compressedDepth png",
            "data": data(bytes(12) + png(WIDTH, HEIGHT, 16, rows))}


def camera_info(ns, frame, shift, model="plumb_bob", d=(0.1, -0.05, 0.001, 0.002, 0.0)):
    return {"header": header(ns, frame), "height": HEIGHT, "width": WIDTH,
            "distortion_model": model, "d": list(d),
            "k": [FOCAL, 0, CX, 0, FOCAL, CY, 0, 0, 1], "r": [1, 0, 0, 0, 1, 0, 0, 0, 1],
            "p": [FOCAL, 0, CX, shift, 0, FOCAL, CY, 0, 0, 0, 1, 0],
            "binning_x": 0, "binning_y": 0,
            "roi": {"x_offset": 0, "y_offset": 0, "height": 0, "width": 0, "do_rectify": False}}


def vector(x, y, z):
    return {"x": x, "y": y, "z": z}


def quaternion(roll, pitch, yaw):
    cr, sr, cp, sp, cy, sy = [f(a / 2) for a in (roll, pitch, yaw) for f in (math.cos, math.sin)]
    return {"x": sr * cp * cy - cr * sp * sy, "y": cr * sp * cy + sr * cp * sy,
            "z": cr * cp * sy - sr * sp * cy, "w": cr * cp * cy + sr * sp * sy}


def transform(parent, child, xyz, rpy):
    return {"header": header(T0_NS, parent), "child_frame_id": child,
            "transform": {"translation": vector(*xyz), "rotation": quaternion(*rpy)}}


def mounting():
    optical = (-math.pi / 2, 0, -math.pi / 2)
    return {"transforms": [
        transform("base_footprint", "base_link", (0, 0, 0.1), (0, 0, 0)),
        transform("base_link", "camera_link", (0.3, 0.05, 0.5), (0, 0, 0)),
        transform("camera_link", "left_optical", (0, 0, 0), optical),
        transform("camera_link", "right_optical", (0, -BASELINE, 0), optical),
        transform("base_link", "imu_link", (0, 0, 0.2), (0, 0, math.pi / 2)),
        transform("base_link", "laser", (0.2, 0, 0.3), (0, 0, 0.5))]}


def imu(ns, frame="imu_link"):
    return {"header": header(ns, frame), "orientation": quaternion(0, 0, 0),
            "orientation_covariance": [-1.0] + [0.0] * 8,
            "angular_velocity": vector(0.1, 0.2, 0.3), "angular_velocity_covariance": [0.0] * 9,
            "linear_acceleration": vector(1.0, 2.0, 9.8), "linear_acceleration_covariance": [0.0] * 9}


def odometry(ns, i):
    zero = vector(0.0, 0.0, 0.0)
    return {"header": header(ns, "odom"), "child_frame_id": "base_link",
            "pose": {"pose": {"position": vector(0.1 * i, 0.02 * i, 0.0),
                              "orientation": quaternion(0, 0, 0.01 * i)}, "covariance": [0.0] * 36},
            "twist": {"twist": {"linear": zero, "angular": zero}, "covariance": [0.0] * 36}}


def scan(ns):
    ranges = [1.0 + 0.01 * k for k in range(181)]
    ranges[7] = math.inf
    ranges[9] = 0.01  # nearer than range_min
    return {"header": header(ns, "laser"), "angle_min": -1.0, "angle_max": 0.8,
            "angle_increment": 0.01, "time_increment": 0.0, "scan_time": 0.1, "range_min": 0.05,
            "range_max": 20.0, "ranges": ranges, "intensities": []}


def fix(ns, status):
    return {"header": header(ns, "base_link"), "status": {"status": status, "service": 1},
            "latitude": 52.5, "longitude": 13.25, "altitude": 80.0,
            "position_covariance": [0.0025, 0.0, 0.0, 0.0, 0.0025, 0.0, 0.0, 0.0, 0.01],
            "position_covariance_type": 2}


def stereo(ns, i, form):
    names = {"left": ("left_optical", 0), "right": ("right_optical", 11)}
    for side, (frame, offset) in names.items():
        base = "/stereo/%s/" % side
        shift = 0.0 if side == "left" else -FOCAL * BASELINE
        model = {"fisheye": ("equidistant", (0.1, -0.05, 0.01, 0.002)),
                 "rational": ("rational_polynomial", (0.1, 0.2, 0.0, 0.0, 0.3, 0.4, 0.5, 0.6))}
        info = model.get(form, ("plumb_bob", (0.1, -0.05, 0.001, 0.002, 0.0)))
        yield base + "camera_info", "sensor_msgs/CameraInfo", ns, camera_info(ns, frame, shift, *info)
        values = picture(i, offset)
        late = ns + (30 * 10**6 if form == "unsynchronised" and side == "right" else 0)
        if form == "compressed":
            yield (base + "image_raw/compressed", "sensor_msgs/CompressedImage", ns,
                   compressed(ns, frame, 8, values))
        elif form == "rgb":
            rgb = [c for value in values for c in (value, 255 - value, 17)]
            yield base + "image_raw", "sensor_msgs/Image", ns, image(ns, frame, "rgb8", 3, rgb)
        elif form == "mono16":
            wide = [b for value in values for b in (0, value)]
            yield base + "image_raw", "sensor_msgs/Image", ns, image(ns, frame, "mono16", 2, wide)
        else:
            yield base + "image_raw", "sensor_msgs/Image", late, image(late, frame, "mono8", 1, values)


def rgbd(ns, i, form):
    values = picture(i, 0)
    rgb = [c for value in values for c in (value, 255 - value, 17)]
    color, depth = "left_optical", "right_optical"
    yield "/camera/color/camera_info", "sensor_msgs/CameraInfo", ns, camera_info(ns, color, 0.0)
    yield "/camera/depth/camera_info", "sensor_msgs/CameraInfo", ns, camera_info(
        ns, depth, 0.0, d=(0.0,) * 5)
    yield "/camera/color/image_raw", "sensor_msgs/Image", ns, image(ns, color, "rgb8", 3, rgb)
    later = ns + 5 * 10**6
    if form == "rgbd_float":
        metres = struct.pack("<%df" % (WIDTH * HEIGHT), *[math.nan if mm == 0 else mm * 1e-3
                                                         for mm in depth_mm(i)])
        yield ("/camera/depth/image_rect_raw", "sensor_msgs/Image", later,
               image(later, depth, "32FC1", 4, metres))
    elif form == "rgbd_compressed":
        yield ("/camera/depth/image_raw/compressedDepth", "sensor_msgs/CompressedImage", later,
               compressed(later, depth, 16, depth_mm(i)))
    else:
        raw = struct.pack("<%dH" % (WIDTH * HEIGHT), *depth_mm(i))
        yield "/camera/depth/image_raw", "sensor_msgs/Image", later, image(later, depth, "16UC1", 2, raw)


def messages(form):
    """(topic, type, time of recording [ns], message), images recorded 20 ms after their exposure.

    form: "mono", "rgb", "compressed", "mono16", "fisheye", "rational", "unsynchronised", "no_tf",
          "no_stamps", "rgbd", "rgbd_float", "rgbd_compressed"
    """
    result = []

    def add(topic, kind, received, message):
        result.append((topic, kind, received, message))

    if form != "no_tf":
        add("/tf_static", "tf2_msgs/TFMessage", T0_NS, mounting())
    for i in range(FRAMES):
        ns = T0_NS + i * 10**8
        maker = rgbd if form.startswith("rgbd") else stereo
        for topic, kind, at, message in maker(ns, i, form):
            if form == "no_stamps":
                message["header"]["stamp"] = stamp(0)
            add(topic, kind, at + 20 * 10**6, message)
        for k in range(10):
            add("/imu/data", "sensor_msgs/Imu", ns + k * 10**7, imu(ns + k * 10**7))
        add("/odom", "nav_msgs/Odometry", ns, odometry(ns, i))
        add("/scan", "sensor_msgs/LaserScan", ns + 10**7, scan(ns))
        add("/gps/fix", "sensor_msgs/NavSatFix", ns, fix(ns, -1 if i == 0 else 2))
    return sorted(result, key=lambda message: message[2])


if __name__ == "__main__":
    import json
    import sys
    for topic, kind, received, message in messages(sys.argv[1]):
        print(json.dumps({"topic": topic, "type": kind, "time": str(received), "message": message}))
