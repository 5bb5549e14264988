# SPDX-License-Identifier: BSD-3-Clause
"""The page of a fleet: failures first, then a sortable table; it needs no network.

All text is escaped; the Content-Security-Policy allows the page's own style and script, by their
hashes, and pictures beside it.
"""
from __future__ import annotations

import base64
import hashlib
from html import escape
from pathlib import Path
from typing import Any, Sequence
from urllib.parse import quote

from .job import THUMBNAILS
from .results import DONE, FAILED, WAITING, Row, median_of

STYLE = """
:root{color-scheme:light dark;--ground:#f6f7f9;--card:#fff;--text:#1b2230;--dim:#5d6879;
--line:#dfe4ea;--accent:#2f7de1;--bad:#b3261e;--badground:#fdecea}
@media(prefers-color-scheme:dark){:root{--ground:#0f131b;--card:#171d28;--text:#e6eaf0;
--dim:#93a0b3;--line:#2a3342;--accent:#5aa2ff;--bad:#ff9c94;--badground:#3a1a18}}
*{box-sizing:border-box}
body{margin:0;background:var(--ground);color:var(--text);
font:15px/1.45 system-ui,-apple-system,"Segoe UI",Roboto,sans-serif}
main{max-width:1500px;margin:0 auto;padding:24px 20px 64px}
h1{font-size:1.8rem;margin:0 0 4px;overflow-wrap:anywhere}h2{font-size:1.2rem;margin:0 0 10px}
header p{color:var(--dim);margin:0}
section{background:var(--card);border:1px solid var(--line);border-radius:12px;padding:18px;
margin:18px 0;overflow-x:auto}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(140px,1fr));gap:12px;margin:18px 0}
.tile{background:var(--card);border:1px solid var(--line);border-radius:12px;padding:12px 16px}
.tile b{display:block;font-size:1.5rem;font-weight:650}.tile span{color:var(--dim);font-size:.85rem}
table{border-collapse:collapse;width:100%;font-size:.85rem}
th,td{text-align:left;padding:6px 5px;border-bottom:1px solid var(--line);vertical-align:top}
td.number,th.number{text-align:right;font-variant-numeric:tabular-nums}td.number{white-space:nowrap}
th{vertical-align:bottom}th button{all:unset;cursor:pointer;font-weight:600}
th button:focus-visible{outline:2px solid var(--accent)}
th[aria-sort=ascending] button::after{content:" ▲"}
th[aria-sort=descending] button::after{content:" ▼"}
td.cause,td.name{overflow-wrap:anywhere;min-width:18ch}td.name{font-weight:600}
tr.failed td{background:var(--badground)}tr.failed .status,.failures b{color:var(--bad)}
td small{display:block;color:var(--dim);font-weight:400}
a{color:var(--accent)}img{display:inline-block;width:72px;height:54px;border-radius:6px;
background:var(--line);object-fit:cover}
td.pictures{width:86px}
@media(max-width:560px){main{padding:14px 10px 40px}section{padding:12px}}
"""
SCRIPT = """
for (const table of document.querySelectorAll('table.sortable')) {
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => {
    const button = head.querySelector('button');
    if (!button) return;
    button.addEventListener('click', () => {
      const falling = head.getAttribute('aria-sort') === 'ascending';
      heads.forEach(other => other.removeAttribute('aria-sort'));
      head.setAttribute('aria-sort', falling ? 'descending' : 'ascending');
      const key = row => row.cells[column].dataset.value ?? row.cells[column].textContent;
      const numeric = head.classList.contains('number');
      const compare = (a, b) => numeric ? Number(a) - Number(b) : a.localeCompare(b);
      const body = table.tBodies[0];
      const rows = [...body.rows];
      rows.sort((a, b) => {
        const left = key(a), right = key(b);
        if (left === '' || right === '') return (left === '') - (right === '');
        return falling ? compare(right, left) : compare(left, right);
      });
      body.append(...rows);
    });
  });
}
"""
# Heading, figure, decimals, factor.
COLUMNS: tuple[tuple[str, str, int, float], ...] = (
    ("frames", "frames", 0, 1.0), ("lost", "frames_lost", 0, 1.0), ("path m", "path_m", 1, 1.0),
    ("ATE m", "ate_rmse_m", 3, 1.0), ("drift %", "drift_percent", 2, 1.0),
    ("loops", "loops", 0, 1.0), ("moving", "moving_tracks", 0, 1.0),
    ("recall %", "movers_recall", 1, 100.0), ("precision %", "movers_precision", 1, 100.0),
    ("ms a frame", "frame_ms_median", 1, 1.0), ("memory MB", "peak_memory_mb", 0, 1.0),
    ("joined", "recordings_joined", 0, 1.0), ("of", "recordings", 0, 1.0),
    ("keyframes", "keyframes", 0, 1.0), ("recognised", "keyframes_recognised", 0, 1.0))


def page(title: str, rows: Sequence[Row], places: Sequence[Row], out: Path,
         recordings_per_hour: float | None) -> str:
    """The whole page. `out` is where it will be written; pictures are linked if they are there."""
    failed = [row for row in rows if row.status == FAILED]
    failed_places = [row for row in places if row.status == FAILED]
    sections = [_tiles(rows, recordings_per_hour)]
    if failed or failed_places:
        sections.append(_failures([*failed, *failed_places]))
    sections.append(_section("Recordings", _table(rows, out)))
    if places:
        sections.append(_section("Maps of places", _table(places, out, members=True)))
    policy = (f"default-src 'none'; img-src 'self' file:; style-src '{_hash(STYLE)}'; "
              f"script-src '{_hash(SCRIPT)}'; base-uri 'none'; form-action 'none'")
    return ("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
            f"<meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">"
            "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">"
            f"<title>{escape(title)}</title><style>{STYLE}</style></head><body><main>"
            f"<header><h1>{escape(title)}</h1><p>{_link('fleet.csv', 'all figures as CSV')}</p>"
            f"</header>{''.join(sections)}</main><script>{SCRIPT}</script></body></html>\n")


def _hash(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def _section(title: str, contents: str) -> str:
    return f"<section><h2>{escape(title)}</h2>{contents}</section>"


def _tiles(rows: Sequence[Row], recordings_per_hour: float | None) -> str:
    count = {status: sum(row.status == status for row in rows)
             for status in (DONE, FAILED, WAITING)}
    frames = sum(row.figures.get("frames") or 0 for row in rows)
    tiles = [(f"{count[DONE]} of {len(rows)}", "recordings done"), (str(count[FAILED]), "failed")]
    if count[WAITING]:
        tiles.append((str(count[WAITING]), "not yet done"))
    tiles.append((f"{frames:,}".replace(",", "\u202f"), "frames"))
    for figure, decimals, label in (("ate_rmse_m", 3, "median ATE m"),
                                    ("drift_percent", 2, "median drift %")):
        value = median_of(rows, figure)
        if value is not None:
            tiles.append((f"{value:.{decimals}f}", label))
    if recordings_per_hour:
        tiles.append((f"{recordings_per_hour:.0f}", "recordings/hour, this run"))
    return "<div class=\"tiles\">" + "".join(
        f"<div class=\"tile\"><b>{escape(value)}</b><span>{escape(label)}</span></div>"
        for value, label in tiles) + "</div>"


def _failures(rows: Sequence[Row]) -> str:
    lines = "".join(
        f"<tr><td class=\"name\">{escape(row.name)}<small>{escape(row.source)}</small></td>"
        f"<td>{escape(row.step)}</td><td class=\"cause\">{escape(row.cause)}</td>"
        f"<td>{_link(row.log, 'log')}</td></tr>" for row in rows)
    return (f"<section class=\"failures\"><h2><b>{len(rows)} failed</b></h2><table><thead><tr>"
            f"<th>recording</th><th>step</th><th>cause</th><th></th></tr></thead><tbody>{lines}"
            "</tbody></table></section>")


def _table(rows: Sequence[Row], out: Path, members: bool = False) -> str:
    columns = [column for column in COLUMNS
               if any(row.figures.get(column[1]) is not None for row in rows)]
    group = "recordings" if members else "place" if any(row.place for row in rows) else ""
    heads = [("name", False), ("", False), ("status", False), *([(group, False)] if group else []),
             *((heading, True) for heading, _, _, _ in columns), ("seconds", True)]
    head = "".join(_head(text, number) for text, number in heads)
    lines = []
    for row in rows:
        cells = [_name(row, out), f"<td class=\"pictures\">{_pictures(row, out)}</td>", _status(row)]
        if group:
            cells.append(f"<td>{escape(row.source if members else row.place)}</td>")
        cells += [_number(_scaled(row.figures.get(figure), factor), decimals)
                  for _, figure, decimals, factor in columns]
        cells.append(_number(row.seconds, 0))
        lines.append(f"<tr class=\"{escape(row.status)}\">{''.join(cells)}</tr>")
    return (f"<table class=\"sortable\"><thead><tr>{head}</tr></thead>"
            f"<tbody>{''.join(lines)}</tbody></table>")


def _head(text: str, number: bool) -> str:
    button = f"<button type=\"button\">{escape(text)}</button>" if text else ""
    return f"<th{' class=number' if number else ''}>{button}</th>"


def _name(row: Row, out: Path) -> str:
    return (f"<td class=\"name\">{escape(row.name)}<small>{escape(row.kind)}</small>"
            f"<small>{_links(row, out)}</small></td>")


def _status(row: Row) -> str:
    notes = [f"in step {row.step}"] if row.status == FAILED else list(row.notes)
    notes += filter(None, [row.figures.get("warnings")])
    return (f"<td class=\"status\">{escape(row.status)}"
            f"<small>{escape('; '.join(notes))}</small></td>")


def _links(row: Row, out: Path) -> str:
    if not row.folder:
        return _link(row.log, "log")
    links = [_link(f"{row.folder}/{name}", text) for name, text in
             (("report.html", "report"), ("replay.html", "in 3D"), ("trajectory.tum", "trajectory"),
              ("tracks.csv", "tracks"), ("map.headway", "map")) if (out / row.folder / name).is_file()]
    links += [_link(report, Path(report).parent.name) for report in row.reports]
    return " ".join([*links, _link(row.log, "log")])


def _pictures(row: Row, out: Path) -> str:
    shown = []
    for whole, small in THUMBNAILS.values():
        if not row.folder or not (out / row.folder / small).is_file():
            continue
        source = quote(f"{row.folder}/{small}")
        shown.append(f"<a href=\"{quote(f'{row.folder}/{whole}')}\"><img src=\"{source}\" "
                     f"loading=\"lazy\" alt=\"{escape(whole)} of {escape(row.name)}\"></a>")
    return " ".join(shown)


def _scaled(value: Any, factor: float) -> float | None:
    return None if value is None else factor * float(value)


def _number(value: float | None, decimals: int) -> str:
    if value is None:
        return "<td class=\"number\" data-value=\"\">–</td>"
    return f"<td class=\"number\" data-value=\"{value:.9g}\">{value:.{decimals}f}</td>"


def _link(path: str, text: str) -> str:
    return f"<a href=\"{quote(path)}\">{escape(text)}</a>" if path else ""
