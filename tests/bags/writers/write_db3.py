#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes messages of write_ros2.mjs as a .db3 of rosbag2: write_db3.py OUT.db3 < MESSAGES"""
import base64
import json
import os
import sqlite3
import sys

database = sqlite3.connect(sys.argv[1])
if "SMALL_RECORDING" in os.environ:
    database.execute("PRAGMA page_size = 512")
database.executescript("""
CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
  serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
  data BLOB NOT NULL);
CREATE INDEX timestamp_idx ON messages (timestamp ASC);
""")
topics = {}
for line in sys.stdin:
    message = json.loads(line)
    name = message["topic"]
    if name not in topics:
        topics[name] = len(topics) + 1
        database.execute("INSERT INTO topics VALUES(?, ?, ?, 'cdr', '')",
                         (topics[name], name, message["type"]))
    database.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)",
                     (topics[name], int(message["time"]), base64.b64decode(message["base64"])))
database.commit()
