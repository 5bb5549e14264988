# SPDX-License-Identifier: BSD-3-Clause
"""What became of the recordings of each place: rows of the page and of the table."""
from __future__ import annotations

from dataclasses import replace
from typing import Iterable

from .figures import PlaceMap, apart_figures, place_maps
from .places import GIVEN, GNSS, RECOGNISED
from .plan import Job, Plan, result_folder
from .results import DONE, JOINED, NOT_JOINED, NOT_TRIED, PARTLY_JOINED, Row, job_row

_WHY_APART = {
    GIVEN: "no place is recognised in two of them, though the list says that they are of one",
    GNSS: "no place is recognised in two of them, though they are near each other by satellite fixes",
    RECOGNISED: "no place is recognised in two of them: as of different places"}


def place_rows(jobs: Iterable[Job], plan: Plan) -> list[Row]:
    """A row for each map that several recordings of a place became, or one that says why none."""
    rows = []
    for job in jobs:
        members, folder = job.arguments["members"], result_folder(plan.settings, job)
        row = replace(job_row(job, plan, True), source=", ".join(members), place=job.name)
        maps = place_maps(folder, members) if row.status == DONE else []
        if maps:
            rows += [_map_row(row, members, each) for each in maps]
        elif row.status == DONE:
            why = _WHY_APART[job.arguments["found_by"]]
            rows.append(replace(row, status=NOT_JOINED, notes=(why,),
                                figures=apart_figures(folder, members)))
        else:
            rows.append(row)
    return rows


def untried_row(job: Job, why: str) -> Row:
    return Row(job.name, "place", NOT_TRIED, ", ".join(job.arguments["members"]), place=job.name,
               figures={"recordings": len(job.arguments["members"])}, notes=(why,))


def with_places(rows: Iterable[Row], maps: Iterable[Row]) -> list[Row]:
    """The recordings' rows, with the map that each has become part of if its place was found."""
    joined = {name: each.name for each in maps for name in each.joined}
    return [replace(row, place=row.place or joined.get(row.name, "")) for row in rows]


def _map_row(row: Row, members: list[str], each: PlaceMap) -> Row:
    apart = [name for name in members if name not in each.recordings]
    notes = list(row.notes)
    if apart:
        notes.insert(0, f"{len(each.recordings)} of {len(members)} recordings; no place is shared "
                        f"with {', '.join(apart)}")
    within = "" if each.folder == "." else f"/{each.folder}"
    return replace(
        row, name=row.name + within, folder=row.folder + within,
        status=PARTLY_JOINED if apart else JOINED, source=", ".join(each.recordings),
        figures=each.figures, notes=tuple(notes), joined=each.recordings,
        reports=tuple(f"{row.folder}/{folder}/report.html" for folder in each.folders))
