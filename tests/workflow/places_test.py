#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Recordings of one place in a fleet: tests/workflow/places_test.py BIN_DIR."""
from __future__ import annotations

import csv
import gzip
import json
import os
import pathlib
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "workflow"))

from fixtures import InFolder, WithEngine  # noqa: E402
from headway_fleet import command  # noqa: E402
from headway_fleet.job import RECORD, run_job  # noqa: E402
from headway_fleet.page import page  # noqa: E402
from headway_fleet.place_rows import place_rows, untried_row, with_places  # noqa: E402
from headway_fleet.places import MAX_AUTO_CANDIDATES, Place, find_places, untried  # noqa: E402
from headway_fleet.plan import (Job, Plan, Resources, Settings, Used, place_job,  # noqa: E402
                                result_folder)
from headway_fleet.results import (DONE, JOINED, NOT_JOINED, NOT_TRIED, PARTLY_JOINED,  # noqa: E402
                                   Row, table_csv)

BIN_DIR = pathlib.Path()
Points = list[tuple[float, float]]


def line(latitude: float, longitude: float) -> Points:
    """300 m to the north, a point each 0.5 m."""
    return [(longitude, latitude + i * 0.5 / 111195) for i in range(600)]


class FindPlacesTest(InFolder):
    def row(self, name: str, start: float, points: Points, place: str = "",
            camera: str = "wide") -> Row:
        folder = f"recordings/{name}-0"
        self.write(f"{folder}/trajectory.tum", f"{start} 0 0 0 0 0 0 1\n")
        self.write(f"{folder}/calibration.yaml", camera)
        feature = {"geometry": {"type": "LineString", "coordinates": [[x, y, 0] for x, y in points]}}
        if points:
            self.write(f"{folder}/trajectory.geojson", json.dumps({"features": [feature]}))
        return Row(name, "rawlog", DONE, folder=folder, place=place)

    def found(self, rows: list[Row], how: str) -> dict[str, list[str]]:
        return {place.name: list(place.recordings) for place in find_places(rows, self.folder, how)}

    def test_recordings_whose_paths_meet_are_of_one_place(self) -> None:
        rows = [self.row("late", 30.0, line(48.0, 11.0)),
                self.row("early", 10.0, line(48.002, 11.0001)),   # 222 m north, 7 m east
                self.row("far", 20.0, line(48.0, 11.001)),        # 74 m east
                self.row("without", 5.0, [])]
        for how in ("gnss", "auto"):
            self.assertEqual(self.found(rows, how), {"around-late": ["early", "late"]})

    def test_a_chain_of_paths_is_one_place(self) -> None:
        rows = [self.row(str(i), i, line(48.0 + 0.0025 * i, 11.0)) for i in (2, 0, 1)]
        self.assertEqual(list(self.found(rows, "gnss").values()), [["0", "1", "2"]])

    def test_recordings_of_other_cameras_are_apart_even_where_their_paths_meet(self) -> None:
        rows = [self.row(f"{camera}-{i}", i, line(48.0, 11.0), camera=camera)
                for i in (0, 1) for camera in ("wide", "tele")]
        self.assertEqual(self.found(rows, "auto"), {"around-wide-0": ["wide-0", "wide-1"],
                                                    "around-tele-0": ["tele-0", "tele-1"]})

    def test_recordings_of_one_camera_are_candidates(self) -> None:
        rows = [self.row("a", 3.0, []), self.row("b", 2.0, []), self.row("c", 1.0, [], camera="tele")]
        poses_only = self.row("d", 0.0, [])
        (self.folder / poses_only.folder / "calibration.yaml").unlink()
        for how in ("recognised", "auto"):
            self.assertEqual(self.found([*rows, poses_only], how), {"camera-of-a": ["b", "a"]})

    def test_by_default_fixes_decide_where_there_are_any_and_images_elsewhere(self) -> None:
        rows = [self.row("given-1", 0.0, [], "yard"), self.row("given-2", 1.0, line(48.0, 11.0), "yard"),
                self.row("fixes-1", 2.0, line(48.0, 11.0)), self.row("fixes-2", 3.0, line(48.0, 11.0)),
                self.row("alone", 4.0, line(40.0, 11.0)),
                self.row("images-1", 5.0, []), self.row("images-2", 6.0, [])]
        given, fixes = {"yard": ["given-1", "given-2"]}, {"around-fixes-1": ["fixes-1", "fixes-2"]}
        images = {"camera-of-images-1": ["images-1", "images-2"]}
        everything = {"camera-of-fixes-1": ["fixes-1", "fixes-2", "alone", "images-1", "images-2"]}
        self.assertEqual(self.found(rows, "auto"), {**given, **fixes, **images})
        self.assertEqual(self.found(rows, "gnss"), {**given, **fixes})
        self.assertEqual(self.found(rows, "recognised"), {**given, **everything})
        self.assertEqual(self.found(rows, "given"), given)
        self.assertEqual(self.found(rows, "none"), {})

    def test_places_of_the_list_keep_their_names(self) -> None:
        rows = [self.row("a", 2.0, [], "yard / north"), self.row("b", 1.0, [], "yard / north"),
                self.row("c", 0.0, [], "alone"),
                self.row("d", 2.0, [], "camera-of-f"), self.row("e", 1.0, [], "camera-of-f"),
                self.row("f", 0.0, []), self.row("g", 1.0, [])]
        self.assertEqual(self.found(rows, "auto"), {
            "yard___north": ["b", "a"], "camera-of-f": ["e", "d"], "camera-of-f-2": ["f", "g"]})

    def test_what_costs_too_much_is_tried_on_request_only(self) -> None:
        few = Place("camera-of-a", "recognised", ("a", "b"))
        many = Place("camera-of-a", "recognised", ("a",) * (MAX_AUTO_CANDIDATES + 1))
        self.assertEqual(untried(few, "auto", 900, 1000), "")
        self.assertRegex(untried(few, "auto", 1100, 1000), "^2 recordings .* 1100 MB, more than the 1000")
        self.assertEqual(untried(few, "auto", 1100, None), "", "a cluster's nodes are not known")
        self.assertRegex(untried(many, "auto", 900, 1000), "^21 recordings .* more than 20; .*recognised")
        self.assertEqual(untried(many, "recognised", 1100, 1000), "")
        self.assertEqual(untried(Place("yard", "given", many.recordings), "auto", 1100, 1000), "")

    def test_a_place_has_twice_what_its_recordings_used_between_one_job_s_and_all_jobs(self) -> None:
        members = [Job(f"{name}-0123456789", "process", name, Resources(1, 500, 10),
                       arguments={"rawlog": f"{name}.rawlog"}) for name in ("a", "b")]
        for used, memory_mb, minutes in ((Used(), 1000, 20), (Used(10.0, 0.1), 500, 10),
                                         (Used(150.2, 3.0), 601, 12), (Used(450.0, 9.0), 1000, 20)):
            job = place_job("yard", "given", members, [used, used])
            self.assertEqual(job.resources, Resources(1, memory_mb, minutes))
        self.assertEqual(job.arguments["rawlogs"], ["a.rawlog", "b.rawlog"])
        other = place_job("yard", "given", members[::-1], [Used(), Used()])
        self.assertNotEqual(job.id, other.id)


class MapPlaceTest(InFolder):
    """A place's job with stand-ins for the programs, which write what headway-replay writes."""

    def rows(self, maps: list[list[int]], found_by: str = "recognised") -> list[Row]:
        """Rows of a place whose recordings a to e become these maps."""
        names = ["a", "b", "c", "d", "e"]
        of = {i: index for index, group in enumerate(maps) for i in group}
        folders = ["." if i == 0 else f"map-{i + 1}" for i in range(len(maps))]
        record = {"version": "1.2.3", "recordings": [
            {"folder": f"{name}-x", "map": of.get(i), "frames": 10, "frames_tracked": 9}
            for i, name in enumerate(names)], "maps": [
            {"folder": folder, "recordings": [f"{names[i]}-x" for i in group], "keyframes": 4,
             "landmarks": 50, "keyframes_recognised": 3} for folder, group in zip(folders, maps)]}
        self.write("recordings.json", json.dumps(record))
        body = "".join(f'mkdir -p "$out/{folder}"; touch "$out/{folder}/map.headway"; '
                       for folder in [*folders, *(f"{name}-x" for name in names)])
        for name, script in (("headway-render", "exit 0"), ("headway-replay", (
                'while [ "$1" != -o ]; do shift; done; out=$2; ' + body + 'cp recordings.json "$out"'))):
            self.write(f"bin/{name}", f"#!/bin/bash\n{script}\n").chmod(0o755)
        job = Job("yard-0000000000", "place", "yard", Resources(), arguments={
            "rawlogs": [f"{name}.rawlog" for name in names], "members": names, "found_by": found_by})
        plan = Plan(Settings(self.folder / "out", self.folder / "bin", self.folder),
                    {job.full_id: job})
        self.assertTrue(run_job(plan, job.full_id))
        self.place = result_folder(plan.settings, job)
        return place_rows([job], plan)

    def test_one_map_of_all_is_joined(self) -> None:
        (row,) = self.rows([[0, 1, 2, 3, 4]])
        self.assertEqual((row.status, row.source, row.notes), (JOINED, "a, b, c, d, e", ()))
        self.assertEqual([row.figures[name] for name in (
            "recordings_joined", "recordings", "frames", "frames_lost", "keyframes_recognised")],
            [5, 5, 50, 5, 3])
        self.assertIn("headway-replay -q -i a.rawlog -i b.rawlog", (self.place / "log.txt").read_text())
        self.assertIn(f"{row.folder}/c-x/report.html", page("t", [], [row], self.folder / "out", None))

    def test_each_map_of_several_is_a_row_that_names_what_is_not_in_it(self) -> None:
        first, second = self.rows([[0, 1], [2, 4], [3]])
        self.assertEqual([first.status, second.status], [PARTLY_JOINED] * 2)
        self.assertEqual([first.name, second.name], ["yard", "yard/map-2"])
        self.assertEqual(first.notes, ("2 of 5 recordings; no place is shared with c, d, e",))
        self.assertEqual(second.source, "c, e")
        self.assertTrue((self.folder / "out" / second.folder / "map.headway").is_file())
        recordings = [Row(name, "rawlog", DONE) for name in "abcd"] + [Row("e", "rawlog", DONE, place="x")]
        self.assertEqual([row.place for row in with_places(recordings, [first, second])],
                         ["yard", "yard", "yard/map-2", "", "x"])

    def test_recordings_that_do_not_join_are_said_to_and_leave_no_second_replay(self) -> None:
        for found_by, why in (("recognised", "as of different places"), ("gnss", "satellite fixes"),
                              ("given", "though the list")):
            (row,) = self.rows([[3], [0], [1], [2]], found_by)  # nothing was mapped in e
            self.assertEqual((row.status, row.joined), (NOT_JOINED, ()))
            self.assertIn(why, row.notes[0])
            self.assertEqual((row.figures["recordings_joined"], row.figures["recordings"]), (0, 5))
            self.assertEqual(sorted(os.listdir(self.place)), ["log.txt", "recordings.json", RECORD])
            shown = page("t", [], [row], self.folder / "out", None)
            self.assertIn(NOT_JOINED, shown)
            self.assertNotIn("map.headway", shown)

    def test_a_recording_in_which_nothing_was_mapped_is_not_counted_as_joined(self) -> None:
        (row,) = self.rows([[0, 1, 2, 3]])
        self.assertEqual((row.status, row.figures["recordings_joined"]), (PARTLY_JOINED, 4))
        self.assertIn("shared with e", row.notes[0])

    def test_what_was_not_tried_is_in_page_and_table(self) -> None:
        job = Job("camera-of-a-0000000000", "place", "camera-of-a", Resources(),
                  arguments={"members": ["a", "b"]})
        row = untried_row(job, "too many")
        self.assertIn(f"\ncamera-of-a,place,{NOT_TRIED},", table_csv([row]))
        self.assertIn("too many", page("t", [], [row], self.folder, None))


WORLD = """[route]
shape = straight 60
[world]
view_distance_m = 50
cross_street_every_m = 0
[camera]
width = 320
height = 160
focal_px = 185
[traffic]
vehicles = 0
cyclists = 0
pedestrians = 1
[gnss]
rate_hz = 10
sigma_m = 0.1
outlier_ratio = 0
[recording]
frames = 12
"""
ONE_S, TWO_S = 1.7e9, 1.8e9  # starts of the two drives


class RealPlacesTest(WithEngine):
    """Two drives through a simulated street, with and without fixes, and one through another."""

    DRIVES = {"one": [f"recording.start_time_s={ONE_S}"],
              "two": [f"recording.start_time_s={TWO_S}", "recording.first_frame=6",
                      "route.speed_mps=6"],
              "other": ["world.seed=7"]}

    def setUp(self) -> None:
        super().setUp()
        for name in self.DRIVES:
            self.drive(name, False)
        for name in ("one", "two"):
            self.drive(name, True)
        # Pictures are tested elsewhere, and would take half of the time.
        self.write("bin/headway-render", "#!/bin/sh\nexit 0\n").chmod(0o755)
        for name in ("import", "replay", "eval"):
            (self.folder / f"bin/headway-{name}").symlink_to(BIN_DIR / f"headway-{name}")

    def drive(self, name: str, fixes: bool) -> None:
        values = [*self.DRIVES[name], f"gnss.enabled={str(fixes).lower()}"]
        subprocess.run([BIN_DIR / "headway-sim", "-q", "-c", self.write("world.ini", WORLD), "-o",
                        self.folder / f"{name}{'-fixes' if fixes else ''}.rawlog",
                        *(word for value in values for word in ("--set", value))], check=True)

    def run_fleet(self, place: str) -> dict[str, dict[str, str]]:
        """Rows of the table by name. `place`: that of the drives without fixes, in the list."""
        recordings = self.write("list.csv", "path,place\none-fixes.rawlog,\ntwo-fixes.rawlog,\n"
                                f"one.rawlog,{place}\ntwo.rawlog,{place}\nother.rawlog,\n")
        self.out = self.folder / "out"
        status = command.main([str(recordings), "-o", str(self.out), "-q", "--detector", "none",
                               "--programs", str(self.folder / "bin")])
        text = (self.out / "fleet.csv").read_text(encoding="utf-8")
        self.assertEqual(status, 0, text)
        self.page = (self.out / "index.html").read_text(encoding="utf-8")
        return {row["name"]: row for row in csv.DictReader(text.splitlines())}

    def expect_one_map(self, row: dict[str, str], members: str, of: int) -> None:
        self.assertEqual(row["status"], JOINED if of == 2 else PARTLY_JOINED)
        self.assertEqual((row["kind"], row["source"]), ("place", members))
        self.assertEqual((row["recordings_joined"], row["recordings"]), ("2", str(of)))
        self.assertEqual((row["frames"], row["frames_lost"]), ("24", "0"))
        self.assertGreater(int(row["keyframes_recognised"]), 0)
        folder = self.out / row["results"]
        self.assertTrue((folder / "map.headway").is_file())
        self.assertIn(f"{row['results']}/map.headway", self.page)
        counts = [keyframes_since(folder / "map.simplemap", start) for start in (ONE_S, TWO_S)]
        self.assertGreater(min(counts), 1, "keyframes of both")
        self.assertEqual(str(sum(counts)), row["keyframes"])
        record = json.loads((folder / "recordings.json").read_text(encoding="utf-8"))
        two = next(each for each in record["recordings"] if each["folder"].startswith("two"))
        x, y, z = (two["map_from_own_map"][i] for i in (3, 7, 11))
        truth = (self.folder / "two.truth/trajectory.tum").read_text(encoding="utf-8").splitlines()
        before = 6 * float(truth[1].split()[1])  # frames before the first, each as long as the first
        self.assertAlmostEqual(x, before, delta=0.3, msg="where the second drive starts")
        self.assertLess(abs(y) + abs(z), 0.1)

    def test_drives_through_one_street_become_one_map_and_one_through_another_does_not(self) -> None:
        rows = self.run_fleet("")
        self.expect_one_map(rows["around-one-fixes"], "one-fixes, two-fixes", 2)
        self.assertAlmostEqual(float(rows["around-one-fixes"]["latitude_deg"]), 48.0, places=4)
        candidates = rows["camera-of-one"]
        self.expect_one_map(candidates, "one, two", 3)
        self.assertIn("no place is shared with other", candidates["notes"])
        self.assertEqual([rows[name]["place"] for name in ("one", "two", "other", "two-fixes")],
                         ["camera-of-one", "camera-of-one", "", "around-one-fixes"])
        replays = {file: file.stat().st_mtime_ns for file in self.out.glob("*/*/result.json")}

        rows = self.run_fleet("yard")
        self.expect_one_map(rows["yard"], "one, two", 2)
        self.assertNotIn("camera-of-one", rows)
        new = {file for file in self.out.glob("*/*/result.json")
               if replays.get(file) != file.stat().st_mtime_ns}
        self.assertEqual(new, {self.out / rows["yard"]["results"] / "result.json"})


def keyframes_since(simplemap: pathlib.Path, start_s: float) -> int:
    """Keyframes observed within 10 s, found by their times: MRPT's, in 100 ns since 1601."""
    data = gzip.decompress(simplemap.read_bytes())
    first = int((start_s + 11644473600) * 1e7)
    times = (int.from_bytes(data[i:i + 8], "little") for i in range(len(data) - 7))
    return len({time for time in times if first - 100 <= time < first + 10**8})


if __name__ == "__main__":
    BIN_DIR = pathlib.Path(sys.argv[1]).resolve()
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
