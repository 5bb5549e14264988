// SPDX-License-Identifier: BSD-3-Clause
// Line charts with axes.
'use strict';

const kChartMargin = {left: 34, right: 8, top: 8, bottom: 18};

/** Round values between two limits. */
function ticksBetween(low, high, wanted) {
  const step = scaleLength((high - low) / wanted * 1.5);
  const first = Math.ceil(low / step - 1e-9);
  const count = Math.floor(high / step + 1e-9) - first + 1;
  return Array.from({length: count}, (_, i) => Number(((first + i) * step).toPrecision(6)));
}

/** Draws lines of points [x, y] over a common x axis from `low` to `high`; `null` interrupts a line.
 * `cursor`: an x that is marked. */
function drawChart(canvas, {lines, low, high, cursor, colours}) {
  const {draw, width, height} = sharpCanvas(canvas);
  const {left, right, top, bottom} = kChartMargin;
  const values = lines.flatMap(({points}) => points.filter(Boolean).map(([, y]) => y));
  const max = Math.max(0.1, ...values) * 1.1;
  const px = (x) => left + (width - left - right) * (x - low) / Math.max(1e-6, high - low);
  const py = (y) => height - bottom - (height - top - bottom) * y / max;
  draw.font = '11px system-ui, "DejaVu Sans", sans-serif';
  draw.fillStyle = colours.dim;
  draw.textAlign = 'right';
  for (const y of ticksBetween(0, max, 3)) {
    drawPolyline(draw, [[left, py(y)], [width - right, py(y)]], colours.edge, 1);
    draw.fillText(String(y), left - 5, py(y) + 4);
  }
  draw.textAlign = 'center';
  for (const x of ticksBetween(low, high, 5)) draw.fillText(String(x), px(x), height - 4);
  for (const {points, colour} of lines) {
    draw.strokeStyle = colour;
    draw.lineWidth = 1.6;
    draw.beginPath();
    points.forEach((point, i) => {
      if (!point) return;
      if (i && points[i - 1]) draw.lineTo(px(point[0]), py(point[1]));
      else draw.moveTo(px(point[0]), py(point[1]));
    });
    draw.stroke();
  }
  if (cursor >= low && cursor <= high) {
    drawPolyline(draw, [[px(cursor), top], [px(cursor), height - bottom]], colours.text, 1);
  }
  draw.textAlign = 'left';
}

/** Points of a series, with null where it pauses. */
function withGaps(points) {
  return points.flatMap((point, i) =>
      i && point[0] - points[i - 1][0] > kSameGapS ? [null, point] : [point]);
}
