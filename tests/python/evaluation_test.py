# SPDX-License-Identifier: BSD-3-Clause
"""Evaluations give the figures of headway-eval: python3 evaluation_test.py BIN_DIR RAWLOGS_DIR DOC_DIR."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import headway

BIN, RAWLOGS, DOC = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
STREET, TRUTH = RAWLOGS / "street.rawlog", RAWLOGS / "street.truth"


def run(program, *arguments):
    subprocess.run([BIN / program, *map(str, arguments), "-q"], check=True)


class Evaluation(unittest.TestCase):
    """Compares with what headway-eval writes for the same files."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.here = pathlib.Path(cls.folder.name)

    def assert_same(self, figures, subcommand, **options):
        """Asserts that both have the same keys in the same order, and the same numbers."""
        path = self.here / "figures.json"
        arguments = [item for name, value in options.items()
                     for item in (f"--{name.replace('_', '-')}", value)]
        run("headway-eval", subcommand, *arguments, "--json", path, "-w")
        self.assertEqual(json.dumps(figures), json.dumps(json.loads(path.read_text())))


class OfAStreet(Evaluation):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.here / "out"
        run("headway-replay", "-i", STREET, "-o", cls.out, "--to-index", 79, "--snapshots", 0)

    def test_tracks(self):
        in_map = {"truth": str(TRUTH / "objects.csv"), "estimate": str(self.out / "tracks.csv")}
        figures = headway.evaluate_tracks(**in_map)
        self.assert_same(figures, "tracks", **in_map)
        self.assertGreater(figures["all"]["recall"], 0.3)
        in_camera = {"truth": str(TRUTH / "label_02.txt"),
                     "estimate": str(self.out / "tracks_kitti.txt")}
        raw = str(self.out / "detections.csv")
        self.assert_same(headway.evaluate_tracks(**in_camera, raw=raw), "tracks", **in_camera, raw=raw)
        figures = headway.evaluate_tracks(**in_camera, metric="2d", classes=["Pedestrian"],
                                          min_overlap=0.4)
        self.assert_same(figures, "tracks", **in_camera, metric="2d", classes="Pedestrian", iou=0.4)

    def test_movers(self):
        for poses in (STREET, TRUTH / "trajectory.tum"):
            files = {"truth": str(TRUTH / "label_02.txt"), "poses": str(poses),
                     "estimate": str(self.out)}
            figures = headway.evaluate_movers(**files)
            self.assert_same(figures, "movers", **files)
            self.assertGreater(figures["all"]["recall"], 0.3)

    def test_predictions(self):
        files = {"truth": str(TRUTH / "label_02.txt"), "poses": str(TRUTH / "trajectory.tum"),
                 "estimate": str(self.out / "predictions.csv"),
                 "extrinsic": str(self.out / "calibration.yaml")}
        figures = headway.evaluate_predictions(**files)
        self.assert_same(figures, "predictions", **files)
        self.assertGreater(figures["all"]["cases"], 20)

    def test_unusable_input_raises_with_the_cause(self):
        labels, tracks = str(TRUTH / "label_02.txt"), str(self.out / "tracks.csv")
        with self.assertRaisesRegex(headway.InputError, "one is in the map and one in the camera"):
            headway.evaluate_tracks(labels, tracks)
        for wrong in ({"metric": "4d"}, {"classes": ["Dragon"]}, {"classes": []}, {"min_overlap": 0}):
            with self.assertRaises(headway.InputError):
                headway.evaluate_tracks(labels, labels, **wrong)
        with self.assertRaisesRegex(headway.InputError, "replay.json"):
            headway.evaluate_movers(labels, str(STREET), str(self.here))
        with self.assertRaisesRegex(headway.InputError, "map_grid.gridmap.gz"):
            headway.evaluate_grid(str(TRUTH), str(self.here))
        with self.assertRaisesRegex(headway.InputError, "map_dense.ply"):
            headway.evaluate_dense(str(TRUTH), str(self.here))

    def test_tracks_are_read_as_an_array(self):
        for name in ("tracks.csv", "tracks_smoothed.csv"):
            table = headway.read_track_array(str(self.out / name))
            samples = headway.read_tracks(str(self.out / name))
            self.assertEqual(len(table), len(samples))
            self.assertGreater(len(table), 100)
            for row, sample in zip(table, samples):
                track = sample.track
                self.assertEqual((row["frame"], row["time"], row["track_id"]),
                                 (sample.frame, sample.time, track.id))
                self.assertEqual((row["class"], row["status"], row["moving"]),
                                 (track.object_class, track.status, track.motion == "moving"))
                np.testing.assert_array_equal(row["position"], track.position)
                np.testing.assert_array_equal(row["size"], track.size)
                np.testing.assert_array_equal(row["velocity"], track.velocity)
                np.testing.assert_array_equal(row["position_covariance"],
                                              track.position_covariance[:2, :2])
                np.testing.assert_array_equal(row["velocity_covariance"], track.velocity_covariance)
                self.assertEqual((row["yaw"], row["visible"]), (track.yaw, 1.0))
        truth = headway.read_track_array(str(TRUTH / "objects.csv"))
        self.assertLess(truth["visible"].min(), 0.9)

    def test_predictions_are_read_as_an_array(self):
        path = self.out / "predictions.csv"
        table = headway.read_predictions(str(path))
        columns = path.read_text().splitlines()
        self.assertEqual(len(table), len(columns) - 1)
        header = columns[0].split(",")
        for k in (0, len(table) // 2, len(table) - 1):
            expected = dict(zip(header, columns[1 + k].split(",")))
            row = table[k]
            self.assertEqual(row["class"], expected["class"])
            for name in ("frame", "time", "track_id", "mode", "probability", "horizon_s"):
                self.assertEqual(row[name], float(expected[name]), name)
            np.testing.assert_array_equal(row["position"], [float(expected[c]) for c in "xyz"])
            (xx, xy), (yx, yy) = row["covariance"]
            self.assertEqual([xx, xy, yy, yx],
                             [float(expected[f"cov_{c}"]) for c in ("xx", "xy", "yy", "xy")])
        now = table[(table["frame"] == table["frame"][-1]) & (table["horizon_s"] == 1.0)]
        for track in np.unique(now["track_id"]):
            self.assertAlmostEqual(now["probability"][now["track_id"] == track].sum(), 1.0, places=3)


class OfASimulatedWorld(Evaluation):
    """Grids and dense maps need true depth images, which headway-sim writes on request."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.rawlog = str(cls.here / "w.rawlog")
        run("headway-sim", "--seed", 5, "--frames", 24, "--depth", "--masks", "-c",
            DOC.parent / "config/worlds/street.ini", "--set", "camera.width=400", "--set",
            "camera.height=152", "--set", "camera.focal_px=232", "-o", cls.rawlog)
        run("headway-replay", "-i", cls.rawlog, "-o", cls.here / "out", "--snapshots", 0,
            "--detector", "none", "--set", "grid.reach=20")
        cls.files = {"truth": str(cls.here / "w.truth"), "estimate": str(cls.here / "out")}

    def test_grid(self):
        figures = headway.evaluate_grid(**self.files)
        self.assert_same(figures, "grid", **self.files)
        self.assertGreater(figures["compared"], 500)
        heights = headway.evaluate_grid(**self.files, min_obstacle_height_m=0.5,
                                        max_obstacle_height_m=1.0)
        self.assert_same(heights, "grid", **self.files, lowest_obstacle=0.5, highest_obstacle=1.0)
        self.assertNotEqual(figures, heights)

    def test_dense(self):
        figures = headway.evaluate_dense(**self.files)
        self.assert_same(figures, "dense", **self.files)
        self.assertGreater(figures["points"], 1000)
        matched = headway.evaluate_dense(**self.files, rawlog=self.rawlog)
        self.assert_same(matched, "dense", **self.files, rawlog=self.rawlog)
        self.assertIn("matchable_ratio", matched["coverage"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
