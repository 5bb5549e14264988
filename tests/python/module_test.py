# SPDX-License-Identifier: BSD-3-Clause
"""Tests of the Python module: python3 module_test.py BIN_DIR RAWLOGS_DIR, with it on PYTHONPATH."""

import gc
import json
import pathlib
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import headway

BIN, RAWLOGS = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
STREET = str(RAWLOGS / "street.rawlog")


def frames_of_street(count):
    source = headway.RawlogSource(STREET, to_index=count - 1)
    return source.camera, list(source)


class SameAsThePrograms(unittest.TestCase):
    """A replay and its evaluation give the figures of headway-replay and headway-eval."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.out = pathlib.Path(cls.folder.name) / "out"
        subprocess.run([BIN / "headway-replay", "-i", STREET, "-o", cls.out, "--to-index", "39",
                        "-q"], check=True)
        camera, frames = frames_of_street(40)
        cls.perception = headway.Perception(camera)
        cls.updates = [update for _, update in headway.Session(frames, cls.perception)]

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_trajectory(self):
        replayed = headway.read_trajectory(str(self.out / "trajectory.tum"))
        self.assertEqual(replayed.shape, (40, 8))
        np.testing.assert_allclose(self.perception.trajectory, replayed, atol=2e-9)

    def test_tracks(self):
        expected = {(row.frame, row.track.id): row.track.position
                    for row in headway.read_tracks(str(self.out / "tracks.csv"))}
        self.assertGreater(len(expected), 50)
        shown = {(update.frame, track.id): track.position for update in self.updates
                 for track in update.tracks if track.status in ("confirmed", "coasting")}
        self.assertEqual(set(shown), set(expected))
        for key, position in expected.items():
            np.testing.assert_allclose(shown[key], position, atol=1e-3)

    def test_evaluation(self):
        truth = RAWLOGS / "street.truth/trajectory.tum"
        figures = pathlib.Path(self.folder.name) / "figures.json"
        poses = [headway.read_trajectory(str(file)) for file in (truth, self.out / "trajectory.tum")]
        for align in ("se3", "origin", "scale", "none"):
            subprocess.run([BIN / "headway-eval", "trajectory", "--truth", truth, "--estimate",
                            self.out / "trajectory.tum", "--align", align, "--json", figures, "-q", "-w"],
                           check=True)
            self.assert_close(headway.evaluate_trajectory(*poses, align=align),
                              json.loads(figures.read_text()))
            subprocess.run([BIN / "headway-eval", "trajectory", "--truth", truth, "--estimate",
                            self.out / "trajectory.tum", "--align", align, "--segments", "5,10",
                            "--json", figures, "-q", "-w"], check=True)
            self.assert_close(headway.evaluate_trajectory(*poses, align=align, segments_m=[5, 10]),
                              json.loads(figures.read_text()))
        here = headway.evaluate_trajectory(*poses)
        self.assertLess(here["ate_rmse_m"], 0.05)

    def assert_close(self, here, there):
        self.assertEqual(here.keys(), there.keys())
        for name, value in there.items():
            if isinstance(value, float):
                self.assertAlmostEqual(here[name], value, delta=1e-9 * max(1.0, abs(value)))
            else:
                self.assertEqual(here[name], value)

    def test_map_file(self):
        path = str(pathlib.Path(self.folder.name) / "map.headway")
        self.perception.save_map(path)
        loaded = headway.load_map(path)
        np.testing.assert_array_equal(loaded.landmarks, self.perception.map.landmarks)
        camera, frames = frames_of_street(12)
        again = headway.Perception(camera)
        again.resume(path)
        statuses = [again.process(frame).status for frame in frames]
        self.assertEqual(statuses[-1], "tracked")


class Arrays(unittest.TestCase):
    def test_images_are_shared_and_outlive_their_frame(self):
        _, frames = frames_of_street(1)
        left = frames[0].left
        self.assertEqual((left.dtype, left.ndim), (np.uint8, 2))
        np.testing.assert_array_equal(left, frames[0].left)
        self.assertEqual(left.ctypes.data, frames[0].left.ctypes.data)
        self.assertFalse(left.flags.writeable)
        copy = left.copy()
        frames.clear()
        gc.collect()
        np.testing.assert_array_equal(left, copy)

    def test_frames_of_arrays_give_the_same_poses(self):
        camera, frames = frames_of_street(6)
        recorded, own = headway.Perception(camera), headway.Perception(camera)
        for frame in frames:
            copy = headway.Frame(frame.index, frame.time, frame.left.copy(), frame.right.copy(),
                                 camera)
            copy.detections = frame.detections
            a, b = recorded.process(frame), own.process(copy)
            np.testing.assert_array_equal(a.T_map_robot, b.T_map_robot)

    def test_what_is_wrong_with_a_frame_is_said(self):
        camera, frames = frames_of_street(3)
        perception = headway.Perception(camera)
        for frame in frames:
            self.assertEqual([], perception.process(frame).findings)
        again = headway.Frame(3, frames[2].time, frames[2].left, frames[2].right, camera)
        findings = {finding.name: finding for finding in perception.process(again).findings}
        self.assertEqual(3, findings["time_repeated"].frame)
        self.assertFalse(findings["time_repeated"].is_fatal)
        self.assertEqual(findings["time_repeated"].text, perception.warnings["time_repeated"][2])

    def test_wrong_images_are_refused(self):
        camera, frames = frames_of_street(1)
        good = frames[0].left
        for bad in (good.astype(np.float32), good[:-1], np.zeros((0, 0), np.uint8)):
            with self.assertRaises(headway.InputError):
                headway.Frame(0, 0.0, bad, good, camera)
        with self.assertRaises(headway.InputError):
            headway.Frame(0, float("nan"), good, good, camera)


class Recordings(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = str(pathlib.Path(self.folder.name) / "own.rawlog")

    def test_what_is_written_is_read(self):
        camera = headway.StereoCamera(width=320, height=200, fx=250.0, fy=250.0, cx=159.5, cy=99.5,
                                      baseline_m=0.12)
        random = np.random.default_rng(1)
        pairs = [random.integers(0, 255, (2, 200, 320), np.uint8) for _ in range(3)]
        box = headway.Detection(object_class="Pedestrian", score=0.9, centre=[0.5, 0.8, 4.0],
                                size=[0.8, 0.6, 1.7], yaw=0.1)
        with headway.RawlogSink(self.path, storage="embedded-raw") as sink:
            for i, (left, right) in enumerate(pairs):
                sink.write_stereo(100.0 + 0.1 * i, left, right, camera)
                sink.write_detections("detections", headway.Detections(100.0 + 0.1 * i, [box]))
                sink.write_odometry(100.0 + 0.1 * i, 0.1 * i, 0.0, 0.0)
        source = headway.RawlogSource(self.path)
        self.assertAlmostEqual(source.camera.baseline_m, 0.12)
        read = list(source)
        self.assertEqual(len(read), 3)
        for frame, (left, right) in zip(read, pairs):
            np.testing.assert_array_equal(frame.left, left)
            np.testing.assert_array_equal(frame.right, right)
            self.assertEqual(frame.detections.items[0].object_class, "Pedestrian")
            np.testing.assert_allclose(frame.detections.items[0].centre, [0.5, 0.8, 4.0], atol=1e-6)

    def test_depth_frames_are_read_and_replayed(self):
        camera = headway.StereoCamera(width=320, height=240, fx=250.0, fy=250.0, cx=159.5, cy=119.5,
                                      depth_reach_m=6.0)
        texture = np.random.default_rng(1).integers(0, 255, (240, 400, 3), np.uint8)
        depth = np.full((240, 320), 2.5, np.float32)  # a wall, past which the camera moves by 2 px
        depth[:8, :100], depth[:8, 100:200] = np.nan, 0.0
        images = [np.ascontiguousarray(texture[:, 2 * i : 320 + 2 * i]) for i in range(8)]
        with headway.RawlogSink(self.path, storage="embedded-raw") as sink:
            for i, image in enumerate(images):
                sink.write_depth(100.0 + 0.1 * i, image, depth, camera)
        source = headway.RawlogSource(self.path)
        self.assertEqual(source.camera.depth_reach_m, 6.0)
        self.assertEqual(source.camera.baseline_m, camera.baseline_m)
        recorded, own = headway.Perception(source.camera), headway.Perception(camera)
        expected = np.where(depth > 0.0, depth, 0.0)
        for i, frame in enumerate(source):
            np.testing.assert_array_equal(frame.left_colour, images[i])
            np.testing.assert_allclose(frame.depth, expected, atol=5e-4)
            np.testing.assert_allclose(frame.disparity[100], camera.fx * camera.baseline_m / 2.5,
                                       rtol=1e-6)
            self.assertIsNone(frame.right)
            update = recorded.process(frame)
            same = own.process(headway.Frame.from_depth(i, frame.time, images[i], depth, camera))
            self.assertEqual((update.status, same.status), ("tracked", "tracked"))
            np.testing.assert_allclose(same.T_map_robot, update.T_map_robot, atol=1e-6)
        self.assertAlmostEqual(np.linalg.norm(update.T_map_robot[:3, 3]), 7 * 0.02, delta=0.01)
        out = pathlib.Path(self.folder.name) / "out"
        subprocess.run([BIN / "headway-replay", "-i", self.path, "-o", out, "-q"], check=True)
        np.testing.assert_allclose(headway.read_trajectory(str(out / "trajectory.tum")),
                                   recorded.trajectory, atol=2e-9)

    def test_wrong_depth_is_refused(self):
        lens = dict(width=32, height=24, fx=25.0, fy=25.0, cx=15.5, cy=11.5)
        camera = headway.StereoCamera(**lens, depth_reach_m=6.0)
        stereo = headway.StereoCamera(**lens, baseline_m=0.1)
        image, depth = np.zeros((24, 32), np.uint8), np.ones((24, 32), np.float32)
        cases = ((image, depth.astype(np.uint16), camera, "floats"), (image, depth[1:], camera, "size"),
                 (image, depth, stereo, "depth_reach_m"), (image[1:], depth, camera, "size"))
        with headway.RawlogSink(self.path) as sink:
            for colour, metres, rig, reason in cases:
                with self.assertRaisesRegex(headway.InputError, reason):
                    sink.write_depth(1.0, colour, metres, rig)
                with self.assertRaisesRegex(headway.InputError, reason):
                    headway.Frame.from_depth(0, 1.0, colour, metres, rig)
            sink.write_depth(1.0, image, depth.astype(np.float64), camera)
        with self.assertRaisesRegex(headway.InputError, "from_depth"):
            headway.Frame(0, 1.0, image, image, camera)
        with self.assertRaisesRegex(headway.InputError, "baseline_m"):
            headway.StereoCamera(**lens)

    def test_an_exception_keeps_the_older_file(self):
        pathlib.Path(self.path).write_text("older")
        with self.assertRaises(KeyError):
            with headway.RawlogSink(self.path) as sink:
                sink.write_odometry(1.0, 0.0, 0.0, 0.0)
                raise KeyError("the user's own")
        del sink
        gc.collect()
        self.assertEqual(pathlib.Path(self.path).read_text(), "older")
        self.assertEqual([p.name for p in pathlib.Path(self.folder.name).iterdir()], ["own.rawlog"])

    def test_unusable_input_raises_with_the_cause(self):
        with self.assertRaisesRegex(headway.InputError, "missing.rawlog"):
            headway.RawlogSource("missing.rawlog")
        with self.assertRaisesRegex(ValueError, "nonsense"):
            headway.Perception(None, config={"slam.nonsense": 1})
        with self.assertRaisesRegex(headway.InputError, "truth: row 0: not a unit quaternion"):
            headway.evaluate_trajectory(np.zeros((3, 8)), np.zeros((3, 8)))
        with self.assertRaisesRegex(headway.InputError, r"\(n, 8\)"):
            headway.evaluate_trajectory(np.zeros((3, 7)), np.zeros((3, 8)))


class Sessions(unittest.TestCase):
    def test_gives_frames_with_the_results_of_a_loop_of_ones_own(self):
        source = headway.RawlogSource(str(STREET), to_index=9)
        session = headway.Session(source, headway.Perception(source.camera))
        given = [(frame.index, update) for frame, update in session]
        camera, frames = frames_of_street(10)
        own = headway.Perception(camera)
        self.assertEqual([index for index, _ in given], list(range(10)))
        for (_, update), frame in zip(given, frames):
            np.testing.assert_array_equal(update.T_map_robot, own.process(frame).T_map_robot)
        with self.assertRaises(StopIteration):
            next(session)

    def test_exceptions_of_the_frames_and_of_the_perception_are_passed_on(self):
        camera, frames = frames_of_street(2)

        def broken():
            yield frames[0]
            raise OSError("unplugged")

        session = headway.Session(broken(), headway.Perception(camera))
        next(session)
        with self.assertRaisesRegex(OSError, "unplugged"):
            next(session)
        small = headway.StereoCamera(width=32, height=20, fx=25, fy=25, cx=16, cy=10, baseline_m=0.1)
        with self.assertRaisesRegex(headway.InputError, "frames, frame 0: "):
            next(headway.Session(frames, headway.Perception(small)))
        with self.assertRaises(RuntimeError):
            next(headway.Session([3], headway.Perception(camera)))


class Queries(unittest.TestCase):
    def test_answers_fail_closed(self):
        camera, frames = frames_of_street(10)
        perception = headway.Perception(camera)
        empty = perception.map.at(frames[0].time)
        self.assertFalse(empty.time_to_collision(length_m=1, width_m=1, path=[[0, 0, 0, 0]]).is_free)
        for frame in frames:
            update = perception.process(frame)
        here = update.T_map_robot[:2, 3]
        now = perception.map.at(update.time)
        self.assertEqual(now.status, "known")
        path = [[update.time, *here, 0.0], [update.time + 0.2, here[0] + 0.1, here[1], 0.0]]
        self.assertTrue(now.time_to_collision(length_m=0.5, width_m=0.4, path=path).is_free)
        late = perception.map.at(update.time + 10.0)
        self.assertEqual(late.status, "stale_map")
        self.assertFalse(late.time_to_collision(length_m=0.5, width_m=0.4, path=path).is_free)
        self.assertEqual(now.occupancy_at(1e4, 1e4, update.time).status, "unknown_place")
        for bad in ([[0, 0, 0]], [[1, 0, 0, 0], [0, 0, 0, 0]], [[float("nan"), 0, 0, 0]]):
            with self.assertRaises(headway.InputError):
                now.time_to_collision(length_m=0.5, width_m=0.4, path=bad)

    def test_a_map_is_a_snapshot(self):
        camera, frames = frames_of_street(6)
        perception = headway.Perception(camera)
        perception.process(frames[0])
        before = perception.map
        count = len(before.landmarks)
        for frame in frames[1:]:
            perception.process(frame)
        self.assertEqual(len(before.landmarks), count)
        self.assertEqual(before.time, frames[0].time)


class Threads(unittest.TestCase):
    def test_other_threads_run_while_a_frame_is_processed(self):
        camera, frames = frames_of_street(8)
        perception = headway.Perception(camera)
        during = []
        busy = threading.Event()
        done = threading.Event()

        def watch():
            while not done.is_set():
                if busy.is_set():
                    during.append(1)
                time.sleep(0.0002)

        watcher = threading.Thread(target=watch)
        watcher.start()
        for frame in frames:
            busy.set()
            perception.process(frame)
            busy.clear()
        done.set()
        watcher.join()
        # Each call takes 10 ms and more; with the interpreter locked the watcher would run between
        # the calls only, at most once or twice each.
        self.assertGreater(len(during), 4 * len(frames))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
