#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of workflow/headway_fleet without Snakemake: tests/workflow/fleet_test.py BIN_DIR RAWLOGS."""
from __future__ import annotations

import base64
import csv
import hashlib
import html.parser
import io
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "workflow"))

from fixtures import InFolder, WithEngine  # noqa: E402
from headway_fleet import command, slurm_status  # noqa: E402
from headway_fleet.deciding_files import network_files, program_files  # noqa: E402
from headway_fleet.digests import Digests  # noqa: E402
from headway_fleet.errors import FleetError  # noqa: E402
from headway_fleet.files import publish, write_atomically  # noqa: E402
from headway_fleet.job import RECORD, failure_record, run_job, stamp  # noqa: E402
from headway_fleet.lock import locked  # noqa: E402
from headway_fleet.page import COLUMNS, SCRIPT, STYLE, page  # noqa: E402
from headway_fleet.plan import (Job, Plan, Resources, Settings, recording_jobs,  # noqa: E402
                                result_folder)
from headway_fleet.recordings import Recording, find_recordings, read_list  # noqa: E402
from headway_fleet.results import DONE, FAILED, WAITING, Row, rows_of, table_csv  # noqa: E402

BIN_DIR = RAWLOGS = pathlib.Path()
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


class RecordingsTest(InFolder):
    def kinds(self) -> dict[str, str]:
        return {r.name: r.kind for r in find_recordings(self.folder).recordings}

    def test_every_importable_kind_is_found(self) -> None:
        for name in ("a.rawlog", "day/b.rawlog.zst", "day/c.bag", "day/d.mcap", "ros/metadata.yaml",
                     "ros/ros_0.db3", "euroc/MH_01/mav0/cam0/data.csv", "tum/desk/rgb.txt",
                     "tum/desk/depth.txt", "kitti/sequences/06/calib.txt",
                     "kitti/sequences/07/calib.txt", "tracking/training/label_02/0012.txt",
                     "tracking/training/pose_orbslam3/0012.txt",
                     "raw/2011_09_26/2011_09_26_drive_0005_sync/image_00/timestamps.txt",
                     "pairs/left/0.png", "pairs/right/0.png", "pairs/calibration.yaml",
                     "depth/rgb/0.png", "depth/depth/0.png", "depth/calibration.yaml"):
            self.write(name)
        self.assertEqual(self.kinds(), {
            "a": "rawlog", "day-b": "rawlog", "day-c": "rosbag", "day-d": "rosbag", "ros": "rosbag",
            "euroc-MH_01": "euroc", "tum-desk": "tum-rgbd", "kitti-06": "kitti-odometry",
            "kitti-07": "kitti-odometry", "tracking-0012": "kitti-tracking",
            "raw-2011_09_26_drive_0005_sync": "kitti-raw", "pairs": "images", "depth": "images"})

    def test_options_of_the_import_name_sequence_and_folders(self) -> None:
        self.write("sequences/06/calib.txt")
        self.write("sequences/06/image_0/000000.png")
        (found,) = find_recordings(self.folder).recordings
        self.assertEqual(found.import_options, (str(self.folder), "--sequence", "06"))
        images = self.folder / "pairs"
        for name in ("image_0/0.png", "image_1/0.png", "calibration.yml"):
            self.write(f"pairs/{name}")
        (found,) = find_recordings(images).recordings
        self.assertEqual(found.import_options, ("--left", "image_0", "--right", "image_1",
                                                "--calibration", "calibration.yml"))

    def test_truth_and_images_beside_a_rawlog_belong_to_it(self) -> None:
        rawlog = self.write("s.rawlog")
        self.write("s_Images/l.png")
        for name in ("trajectory.tum", "label_02.txt", "poses_kitti.txt"):
            self.write(f"s.truth/{name}")
        (found,) = find_recordings(self.folder).recordings
        truth = self.folder / "s.truth"
        self.assertEqual((found.truth, found.labels), (truth, truth / "label_02.txt"))
        self.assertEqual(set(found.inputs), {rawlog, self.folder / "s_Images", truth})

    def test_other_files_are_counted_and_results_are_not_searched(self) -> None:
        self.write("a.rawlog")
        self.write("notes.txt")
        self.write("fleet/imported/b.rawlog")
        found = find_recordings(self.folder, self.folder / "fleet")
        self.assertEqual([r.name for r in found.recordings], ["a"])
        self.assertEqual(found.other_files, 1)

    def test_names_are_unique_and_safe(self) -> None:
        self.write("a b/x.rawlog")
        self.write("a_b/x.rawlog")
        self.write("<script>/x.rawlog")
        names = [r.name for r in find_recordings(self.folder).recordings]
        self.assertEqual(len(set(names)), 3)
        for name in names:
            self.assertRegex(name, r"^[A-Za-z0-9._-]+$")

    def test_a_folder_without_recordings_is_an_error(self) -> None:
        with self.assertRaisesRegex(FleetError, "contains no recordings"):
            find_recordings(self.folder)
        with self.assertRaisesRegex(FleetError, "no such folder"):
            find_recordings(self.folder / "none")


class ListTest(InFolder):
    def test_a_row_gives_name_place_resources_and_options(self) -> None:
        self.write("drive/l/0.png")
        path = self.write("list.csv", "path,name,kind,import,place,memory_mb\n"
                                      "drive,north,images,--left l --right r --calibration c,yard,700\n")
        (found,) = read_list(path).recordings
        self.assertEqual((found.name, found.kind, found.place, found.memory_mb),
                         ("north", "images", "yard", 700))
        self.assertEqual(found.import_options,
                         ("--left", "l", "--right", "r", "--calibration", "c"))

    def test_a_row_may_be_a_dataset_of_several_recordings(self) -> None:
        self.write("kitti/sequences/06/calib.txt")
        self.write("kitti/sequences/07/calib.txt")
        found = read_list(self.write("list.csv", "path,name\nkitti,k\n")).recordings
        self.assertEqual([r.name for r in found], ["k-06", "k-07"])

    def test_a_missing_recording_does_not_stop_the_others(self) -> None:
        self.write("a.rawlog")
        found = read_list(self.write("list.csv", "path\na.rawlog\nb.rawlog\n")).recordings
        self.assertEqual([r.error for r in found], ["", "no such file or folder"])

    def test_mistakes_name_file_line_and_column(self) -> None:
        for text, message in (("path,rate\na,1\n", "unknown column 'rate'"),
                              ("name\na\n", "has no column path"),
                              ("path,memory_mb\na,1 GB\n", "line 2: memory_mb is '1 GB'"),
                              ("path\n\"\"\n", "line 2: path is empty"),
                              ("path\na,b\n", "line 2: more fields"),
                              ("", "contains no recordings")):
            with self.assertRaisesRegex(FleetError, re.escape(message)):
                read_list(self.write("list.csv", text))


class DigestsTest(InFolder):
    def test_contents_decide_and_not_times(self) -> None:
        path = self.write("a", "one")
        digests = Digests(self.folder / "store.json")
        first = digests.of([path])
        os.utime(path, ns=(1, 1))
        self.assertEqual(first, digests.of([path]))
        self.write("a", "two")
        self.assertNotEqual(first, digests.of([path]))

    def test_names_in_a_folder_decide(self) -> None:
        self.write("d/a", "one")
        digests = Digests(self.folder / "store.json")
        first = digests.of([self.folder / "d"])
        (self.folder / "d/a").rename(self.folder / "d/b")
        self.assertNotEqual(first, digests.of([self.folder / "d"]))

    def test_what_has_not_changed_is_not_read_again(self) -> None:
        path = self.write("a", "one")
        digests = Digests(self.folder / "store.json")
        digests.read([path], 2)
        known = json.loads((self.folder / "store.json").read_text())
        known[str(path)][3] = "from the store"
        write_atomically(self.folder / "store.json", json.dumps(known))
        again = Digests(self.folder / "store.json")
        changed = again.of([path])
        self.assertNotEqual(changed, digests.of([path]))

    def test_a_file_that_cannot_be_read_is_an_error_of_its_recording(self) -> None:
        digests = Digests(self.folder / "store.json")
        digests.read([self.folder / "none"], 1)
        with self.assertRaises(OSError):
            digests.of([self.folder / "none"])


class PlanTest(InFolder):
    def jobs(self, configuration: str = "c", program: str = "p") -> dict[str, str]:
        path = self.folder / "bag.mcap"
        recording = Recording("bag", path, "rosbag", (str(path),), (path,))
        settings = Settings(self.folder, self.folder, self.folder, [], configuration, program)
        digests = Digests(self.folder / "store.json")
        return {job.stage: job.id for job in recording_jobs(recording, settings, digests)}

    def test_input_configuration_and_version_decide_what_runs_again(self) -> None:
        self.write("bag.mcap", "one")
        first = self.jobs()
        self.assertEqual(first, self.jobs())
        other_configuration = self.jobs(configuration="d")
        self.assertEqual(first["import"], other_configuration["import"])
        self.assertNotEqual(first["process"], other_configuration["process"])
        other_version = self.jobs(program="q")
        self.assertNotEqual(first["import"], other_version["import"])
        self.assertNotEqual(first["process"], other_version["process"])
        self.write("bag.mcap", "two")
        self.assertNotEqual(first["import"], self.jobs()["import"])

    def test_libraries_that_programs_load_decide_too(self) -> None:
        for name in ("headway-import", "headway-eval", "headway-render"):
            self.write(name)
        source = self.write("one.c", "int one(void) { return 1; }")
        library, program = self.folder / "libheadway_one.so", self.folder / "headway-replay"
        subprocess.run(["cc", "-shared", "-fPIC", source, "-o", library], check=True)
        self.write("main.c", "int one(void); int main(void) { return one(); }")
        subprocess.run(["cc", self.folder / "main.c", "-o", program, f"-L{self.folder}",
                        f"-Wl,-rpath,{self.folder}", "-lheadway_one"], check=True)
        files = program_files(self.folder)
        self.assertEqual([program, library], [files[1], files[-1]])
        self.assertEqual(5, len(files))

    def test_the_network_s_weights_decide_too(self) -> None:
        weights, layout = self.write("net.weights"), self.write("net.cfg")
        self.assertEqual([weights, layout], network_files(
            f"[dnn]\n# File [x]\nmodel = {weights}\nlayout = {layout}\n[dnn]\nscale = 1\n"))
        self.assertEqual([], network_files(f"[dnn]\nmodel = {self.folder}/none.onnx\nlayout = \n"))
        installed = self.write("yolox_nano.onnx")
        self.addCleanup(os.environ.pop, "HEADWAY_MODELS", None)
        os.environ["HEADWAY_MODELS"] = str(self.folder)
        self.assertIn(installed, network_files("[dnn]\nmodel = \nlayout = \n"))

    def test_a_plan_is_read_as_written(self) -> None:
        job = Job("a-0123456789", "process", "a", Resources(2, 500, 10), ["import/b"], {"k": "v"})
        plan = Plan(Settings(self.folder, self.folder, self.folder), {job.full_id: job})
        plan.write()
        self.assertEqual(Plan.read(self.folder / ".fleet/plan.json"), plan)


class PublishTest(InFolder):
    def test_a_result_appears_whole_and_replaces_nothing(self) -> None:
        self.write("scratch/r/a", "new")
        self.assertTrue(publish(self.folder / "scratch/r", self.folder / "out/r"))
        self.assertEqual((self.folder / "out/r/a").read_text(), "new")
        self.write("scratch/r/a", "newer")
        self.assertFalse(publish(self.folder / "scratch/r", self.folder / "out/r"))
        self.assertEqual((self.folder / "out/r/a").read_text(), "new")
        self.assertEqual(os.listdir(self.folder / "out"), ["r"])


class JobTest(InFolder):
    """Jobs with stand-ins for the programs, written in shell."""

    def setUp(self) -> None:
        super().setUp()
        for name in ("headway-import", "headway-eval", "headway-render"):
            self.program(name, "exit 0")

    def program(self, name: str, body: str) -> None:
        path = self.write(f"bin/{name}", f"#!/bin/bash\n{body}\n")
        path.chmod(0o755)

    def replay(self, body: str) -> None:
        """A stand-in for headway-replay; $4 is its folder of results."""
        self.program("headway-replay", f'mkdir -p "$5"; {body}')

    def plan(self, key: str = "0" * 10, memory_mb: int = 500) -> tuple[Plan, Job]:
        job = Job(f"a-{key}", "process", "a", Resources(1, memory_mb, 1),
                  arguments={"rawlog": "a.rawlog", "kind": "rawlog", "path": "a.rawlog",
                             "truth": "", "labels": "", "poses": ""})
        settings = Settings(self.folder / "out", self.folder / "bin", self.folder)
        return Plan(settings, {job.full_id: job}), job

    def failure(self, plan: Plan, job: Job) -> dict[str, str]:
        record: dict[str, str] = json.loads(
            failure_record(plan.settings, job.full_id).read_text(encoding="utf-8"))
        return record

    def test_a_result_is_published_with_figures_stamp_and_log(self) -> None:
        self.replay('echo \'{"frames": 7, "version": "1.2.3"}\' > "$5/summary.json"')
        plan, job = self.plan()
        self.assertTrue(run_job(plan, job.full_id))
        folder = result_folder(plan.settings, job)
        record = json.loads((folder / RECORD).read_text())
        self.assertEqual(record["figures"]["frames"], 7)
        self.assertTrue(stamp(plan.settings, job.full_id).exists())
        self.assertIn("headway-replay -q -i a.rawlog", (folder / "log.txt").read_text())
        self.assertEqual(os.listdir(self.folder / "out/.fleet/scratch"), [])

    def test_a_result_that_exists_is_not_computed_again(self) -> None:
        self.replay('echo run >> runs')
        plan, job = self.plan()
        run_job(plan, job.full_id)
        stamp(plan.settings, job.full_id).unlink()
        self.assertTrue(run_job(plan, job.full_id))
        self.assertEqual((self.folder / "runs").read_text(), "run\n")
        self.assertTrue(stamp(plan.settings, job.full_id).exists())

    def test_a_newer_result_removes_the_older_of_the_same_name_only(self) -> None:
        self.replay("true")
        plan, job = self.plan("0" * 10)
        run_job(plan, job.full_id)
        other = self.write("out/recordings/a-b-0000000000/result.json")
        foreign = self.write("out/recordings/a-1111111111/notes.txt")
        plan, job = self.plan("2" * 10)
        run_job(plan, job.full_id)
        self.assertEqual(sorted(os.listdir(self.folder / "out/recordings")),
                         ["a-1111111111", "a-2222222222", "a-b-0000000000"])
        self.assertTrue(other.exists() and foreign.exists())

    def test_a_failure_leaves_the_older_result_and_names_its_cause(self) -> None:
        self.replay("true")
        plan, job = self.plan("0" * 10)
        run_job(plan, job.full_id)
        self.replay('echo note >&2; echo "headway-replay: a.rawlog: is not a rawlog" >&2; exit 1')
        plan, job = self.plan("1" * 10)
        self.assertFalse(run_job(plan, job.full_id))
        self.assertEqual(self.failure(plan, job), {
            "step": "replay", "cause": "headway-replay: a.rawlog: is not a rawlog"})
        self.assertEqual(os.listdir(self.folder / "out/recordings"), ["a-0000000000"])

    def test_a_program_over_its_memory_is_ended(self) -> None:
        self.replay(f'exec {sys.executable} -c "import time; a = bytearray(400_000_000); '
                    'time.sleep(60)"')
        plan, job = self.plan(memory_mb=150)
        started = time.monotonic()
        self.assertFalse(run_job(plan, job.full_id))
        self.assertLess(time.monotonic() - started, 50.0)
        self.assertRegex(self.failure(plan, job)["cause"],
                         r"headway-replay used \d+ MB, more than the 150 MB of its job; give more")

    def test_a_program_that_crashes_is_named_with_its_signal(self) -> None:
        self.replay("kill -SEGV $$")
        plan, job = self.plan()
        self.assertFalse(run_job(plan, job.full_id))
        self.assertEqual(self.failure(plan, job)["cause"], "headway-replay ended by SIGSEGV")

    def test_a_missing_program_is_named(self) -> None:
        plan, job = self.plan()
        self.assertFalse(run_job(plan, job.full_id))
        self.assertIn("cannot be run", self.failure(plan, job)["cause"])

    def test_a_job_whose_node_ended_twice_is_given_up(self) -> None:
        self.replay("true")
        plan, job = self.plan()
        for restarts, runs in (("2", False), ("1", True)):
            os.environ["SLURM_RESTART_COUNT"] = restarts
            self.addCleanup(lambda: os.environ.pop("SLURM_RESTART_COUNT", None))
            self.assertEqual(run_job(plan, job.full_id), runs)

    def test_without_pictures_there_is_a_note(self) -> None:
        self.replay("true")
        self.program("headway-render", 'echo "headway-render: no OpenGL" >&2; exit 1')
        plan, job = self.plan()
        self.assertTrue(run_job(plan, job.full_id))
        record = json.loads((result_folder(plan.settings, job) / RECORD).read_text())
        self.assertEqual(record["notes"], ["headway-render: no OpenGL"])


class ProgramsTest(InFolder):
    def test_a_recording_with_truth_gives_figures_and_pictures(self) -> None:
        (recording,) = [r for r in find_recordings(RAWLOGS).recordings if r.name == "street"]
        settings = Settings(self.folder / "out", BIN_DIR, self.folder,
                            ["--to-index", "15", "--snapshots", "0"])
        (job,) = recording_jobs(recording, settings, Digests(self.folder / "store.json"))
        plan = Plan(settings, {job.full_id: job})
        self.assertTrue(run_job(plan, job.full_id),
                        failure_record(settings, job.full_id))
        (row,) = rows_of([recording], plan, True)
        self.assertEqual((row.status, row.notes), (DONE, ()))
        self.assertEqual(row.figures["frames"], 16)
        self.assertLess(row.figures["ate_rmse_m"], 0.05)
        self.assertGreater(row.figures["path_m"], 5.0)
        self.assertGreater(row.figures["movers_precision"], 0.5)
        folder = result_folder(settings, job)
        for name in ("top.png", "top_small.png", "follow_small.png", "report.html", "replay.html"):
            self.assertTrue((folder / name).is_file(), name)
        shown = Reader(page("Fleet", [row], [], settings.out, None))
        for name in ("report.html", "replay.html", "tracks.csv"):
            self.assertIn(("href", f"{row.folder}/{name}"), shown.attributes)


class Reader(html.parser.HTMLParser):
    """Tags, attributes and visible text of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str]] = []
        self.texts: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += [(name, value or "") for name, value in attrs]

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


class PageTest(InFolder):
    ATTACK = "<script>alert(1)</script>\"'&"

    def test_all_text_is_escaped(self) -> None:
        attack = self.ATTACK
        rows = [Row(attack, attack, FAILED, attack, attack, attack, "", attack, attack),
                Row(attack, attack, DONE, attack, folder=attack, place=attack,
                    figures={"warnings": attack}, notes=(attack,))]
        (self.folder / attack.replace("/", "")).mkdir()
        reader = Reader(page(attack, rows, rows, self.folder, None))
        self.assertEqual(reader.tags.count("script"), 1)
        self.assertFalse([name for name, _ in reader.attributes if name.startswith("on")])
        self.assertGreater(reader.texts.count(attack), 5)
        for name, value in reader.attributes:
            if name in ("href", "src"):
                self.assertNotRegex(value, r"[<>\"']|^[a-z]+:")

    def test_the_policy_allows_its_own_style_and_script_only(self) -> None:
        text = page("t", [Row("a", "rawlog", DONE)], [], self.folder, 5.0)
        policy = re.search(r"content=\"(default-src[^\"]*)\"", text).group(1)  # type: ignore[union-attr]
        self.assertIn("default-src 'none'", policy)
        self.assertNotIn("unsafe", policy)
        for code, tag in ((STYLE, "style"), (SCRIPT, "script")):
            self.assertIn(f"<{tag}>{code}</{tag}>", text)
            digest = base64.b64encode(hashlib.sha256(code.encode()).digest()).decode()
            self.assertIn(f"'sha256-{digest}'", policy)
        self.assertNotRegex(text, r"https?://")

    def test_failures_come_first_with_their_cause(self) -> None:
        rows = [Row("bad", "rawlog", FAILED, step="replay", cause="is not a rawlog"),
                Row("good", "rawlog", DONE, figures={"frames": 10})]
        texts = Reader(page("t", rows, [], self.folder, None)).texts
        self.assertLess(texts.index("is not a rawlog"), texts.index("good"))
        self.assertIn("1 failed", texts)

    def test_all_columns_fit_a_window_of_1280_pixels(self) -> None:
        if shutil.which("chromium") is None:
            self.skipTest("chromium is not installed")
        figures = {name: 1234.5 / factor ** 2 for _, name, _, factor in COLUMNS[:11]}
        name = "rgbd_dataset_freiburg3_long_office_household"
        for file in ("top_small.png", "follow_small.png", "report.html", "replay.html",
                     "trajectory.tum", "tracks.csv", "map.headway"):
            self.write(f"recordings/{name}/{file}")
        row = Row(name, "tum-rgbd", DONE, folder=f"recordings/{name}", log="log", place="yard north",
                  seconds=73.0, figures=figures, notes=("boxes missing in 3 frames",))
        self.write("fleet.html", page("t", [row], [row], self.folder, 31.0))
        self.write("window.html", "<iframe id=f src='fleet.html' width=1280 height=900 "
                   "style='border:0' onload=\"document.title = 'wide: ' + "
                   "[...f.contentDocument.querySelectorAll('html, section')].filter("
                   "e => e.scrollWidth > e.clientWidth).map(e => e.scrollWidth)\"></iframe>")
        shown = subprocess.run(
            ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--dump-dom",
             "--allow-file-access-from-files", "--virtual-time-budget=5000", "--timeout=60000",
             f"--user-data-dir={self.folder}/profile", f"file://{self.folder}/window.html"],
            capture_output=True, text=True, timeout=120, check=True)
        self.assertIn("<title>wide: </title>", shown.stdout)

    def test_pictures_are_linked_where_they_are(self) -> None:
        self.write("recordings/a-1/top_small.png")
        rows = [Row("a", "rawlog", DONE, folder="recordings/a-1"),
                Row("b", "rawlog", DONE, folder="recordings/b-1")]
        attributes = Reader(page("t", rows, [], self.folder, None)).attributes
        self.assertEqual([value for name, value in attributes if name == "src"],
                         ["recordings/a-1/top_small.png"])


class ResultsTest(InFolder):
    def test_the_table_has_every_recording_and_is_read_back(self) -> None:
        rows = [Row("a,b", "rawlog", FAILED, cause="line \"x\"\nnext"),
                Row("c", "euroc", DONE, figures={"frames": 3, "ate_rmse_m": 0.25})]
        read = list(csv.DictReader(io.StringIO(table_csv(rows))))
        self.assertEqual([row["name"] for row in read], ["a,b", "c"])
        self.assertEqual(read[0]["cause"], "line \"x\"\nnext")
        self.assertEqual((read[1]["frames"], read[1]["ate_rmse_m"], read[1]["loops"]),
                         ("3", "0.25", ""))

    def test_a_recording_waits_until_the_engine_has_ended(self) -> None:
        recording = Recording("a", pathlib.Path("a.rawlog"), "rawlog")
        job = Job("a-0123456789", "process", "a", Resources())
        plan = Plan(Settings(self.folder, self.folder, self.folder), {job.full_id: job})
        (row,) = rows_of([recording], plan, False)
        self.assertEqual(row.status, WAITING)
        (row,) = rows_of([recording], plan, True)
        self.assertEqual((row.status, row.step), (FAILED, "engine"))
        self.write(f".fleet/ended/{job.full_id}.json", '{"step": "Slurm", "cause": "its node"}')
        (row,) = rows_of([recording], plan, True)
        self.assertEqual((row.step, row.cause), ("Slurm", "its node"))

    def test_an_import_that_failed_is_the_cause(self) -> None:
        recording = Recording("a", pathlib.Path("a.bag"), "rosbag")
        jobs = [Job("a-0123456789", "import", "a", Resources()),
                Job("a-9876543210", "process", "a", Resources(), ["import/a-0123456789"])]
        plan = Plan(Settings(self.folder, self.folder, self.folder),
                    {job.full_id: job for job in jobs})
        self.write(".fleet/failed/import/a-0123456789.json", '{"step": "import", "cause": "no bag"}')
        (row,) = rows_of([recording], plan, True)
        self.assertEqual((row.step, row.cause), ("import", "no bag"))


class SlurmStatusTest(unittest.TestCase):
    ANSWER = ("7|FAILED|node2|JobLaunchFailure|process_recording.a-0123456789\n"
              "71|RUNNING|node1|None|process_recording.b-0123456789\n")

    def test_a_job_is_found_by_its_whole_id(self) -> None:
        self.assertEqual(slurm_status.state_of("7", self.ANSWER),
                         ("FAILED", "node2", "JobLaunchFailure", "process_recording.a-0123456789"))
        self.assertEqual((slurm_status.state_of("71", self.ANSWER) or ("",))[0], "RUNNING")
        self.assertIsNone(slurm_status.state_of("1", self.ANSWER))

    def test_causes_are_those_of_slurm(self) -> None:
        log = ("slurmstepd-node2: error: StepId=7.batch exceeded memory limit "
               "(415346688 > 104857600), being killed")
        for state, text, cause in (("FAILED", log, "used more memory"),
                                   ("OUT_OF_MEMORY", "", "used more memory"),
                                   ("TIMEOUT", "", "--minutes"),
                                   ("NODE_FAIL", "", "its node n1 ended"),
                                   ("CANCELLED", "", "cancelled"),
                                   ("DEADLINE", "", "state DEADLINE")):
            self.assertIn(cause, slurm_status.ended_cause(state, "n1", "None", text))


class CommandTest(WithEngine):
    def run_fleet(self, *arguments: str) -> tuple[int, str]:
        errors, sys.stderr = sys.stderr, io.StringIO()
        try:
            status = command.main([*arguments, "-o", str(self.folder / "out"), "-q",
                                   "--programs", str(BIN_DIR)])
        except SystemExit as end:
            status = int(end.code or 0)
        finally:
            text, sys.stderr = sys.stderr.getvalue(), errors
        return status, text

    def test_mistakes_are_one_line_before_anything_runs(self) -> None:
        self.write("a.rawlog")
        for arguments, message in (
                ([str(self.folder / "none")], "no such folder"),
                ([str(self.folder), "--set", "slam.no_such_key=1"], "no_such_key"),
                ([str(self.folder), "-c", "none.ini"], "none.ini: cannot be read"),
                ([str(self.folder), "--profile", "none"], "is no profile")):
            status, text = self.run_fleet(*arguments)
            self.assertEqual(status, 1, text)
            self.assertEqual(len(text.splitlines()), 1, text)
            self.assertIn(message, text)
        self.assertEqual(self.run_fleet(str(self.folder), "-j", "0")[0], 2)

    def test_a_broken_recording_does_not_stop_the_others(self) -> None:
        folder = self.folder / "recordings"
        folder.mkdir()
        self.write("recordings/broken.rawlog", "no rawlog")
        subprocess.run([BIN_DIR / "headway-sim", "-q", "-c", self.write("world.ini", WORLD), "-o",
                        folder / "good.rawlog"], check=True)
        status, text = self.run_fleet(str(folder))
        with (self.folder / "out/fleet.csv").open(newline="", encoding="utf-8") as file:
            rows = {row["name"]: row for row in csv.DictReader(file)}
        self.assertEqual(status, 1)
        self.assertIn("broken: replay: headway-replay:", text)
        self.assertEqual(rows["broken"]["status"], FAILED)
        self.assertIn("is not a rawlog", rows["broken"]["cause"])
        self.assertEqual((rows["good"]["status"], rows["good"]["frames"]), (DONE, "12"))
        self.assertLess(float(rows["good"]["ate_rmse_m"]), 0.5)
        self.assertIn("is not a rawlog", (self.folder / "out/index.html").read_text())

    def test_two_runs_do_not_write_one_folder(self) -> None:
        self.write("a.rawlog")
        with locked(self.folder / "out"):
            status, text = self.run_fleet(str(self.folder))
        self.assertEqual(status, 1)
        self.assertIn("another headway-fleet is writing", text)


class SuiteTest(WithEngine):
    def suite(self, name: str, *options: str) -> tuple[bytes, bytes]:
        """Tables and figures of the suite over two worlds."""
        figures = self.folder / f"{name}.json"
        subprocess.run([BIN_DIR / "headway-eval", "suite", "-q", "--worlds", self.folder / "worlds",
                        "-o", self.folder / name, "--json", figures, *options], check=True)
        return (self.folder / name / "suite.md").read_bytes(), figures.read_bytes()

    def test_jobs_give_the_same_tables(self) -> None:
        self.write("worlds/a.ini", WORLD)
        self.write("worlds/b.ini", WORLD + "[world]\nseed = 2\n")
        parameters = ("--set", "slam.max_speed=50.5")
        alone = self.suite("alone", *parameters)
        self.assertEqual(alone, self.suite("jobs", "--jobs", "2", *parameters))
        result = next((self.folder / "jobs/worlds").glob("a-*/result.json"))
        before = result.stat().st_mtime_ns
        os.remove(self.folder / "jobs.json")
        self.assertEqual(alone, self.suite("jobs", "--jobs", "2", "--reuse", *parameters))
        self.assertEqual(result.stat().st_mtime_ns, before, "nothing runs again")

    def test_a_world_that_fails_is_named(self) -> None:
        self.write("worlds/a.ini", WORLD.replace("frames = 12", "frames = 12\nno_key = 1"))
        done = subprocess.run([BIN_DIR / "headway-eval", "suite", "-q", "--jobs", "1", "--worlds",
                               self.folder / "worlds", "-o", self.folder / "out"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("no_key", done.stderr)


if __name__ == "__main__":
    BIN_DIR, RAWLOGS = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
