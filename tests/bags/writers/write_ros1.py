#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the recording as a ROS 1 bag by rosbag's own writer: write_ros1.py OUT.bag FORM COMPRESSION [CAMERA]

CAMERA (default /stereo): of the names of a stereo camera's topics."""
import base64
import os
import sys

import genpy
import rosbag
import roslib.message

import recording


def ros1(message):
    """Names and types of ROS 1: CameraInfo's matrices are capital letters, a stamp is a time."""
    if isinstance(message, list):
        return [ros1(one) for one in message]
    if not isinstance(message, dict):
        return message
    if "base64" in message:
        return base64.b64decode(message["base64"])
    if set(message) == {"sec", "nanosec"}:
        return genpy.Time(message["sec"], message["nanosec"])
    capital = "distortion_model" in message
    return {(name.upper() if capital and len(name) == 1 else name): ros1(value)
            for name, value in message.items()}


def fill(target, values):
    for name, value in values.items():
        slot = getattr(target, name)
        if isinstance(value, dict):
            fill(slot, value)
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            kind = roslib.message.get_message_class(
                target._slot_types[target.__slots__.index(name)].split("[")[0])
            for one in value:
                slot.append(kind())
                fill(slot[-1], one)
        else:
            setattr(target, name, value)


with rosbag.Bag(sys.argv[1], "w", compression=sys.argv[3], chunk_threshold=20000) as bag:
    for topic, kind, received, values in recording.messages(sys.argv[2]):
        message = roslib.message.get_message_class(kind)()
        fill(message, ros1(values))
        if "SMALL_RECORDING" in os.environ:
            type(message)._full_text = ""  # definitions are most of a small bag
        if len(sys.argv) > 4:
            topic = topic.replace("/stereo/", sys.argv[4] + "/")
        bag.write(topic, message, genpy.Time(received // 10**9, received % 10**9))
