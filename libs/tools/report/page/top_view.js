// SPDX-License-Identifier: BSD-3-Clause
// The map from above on a 2D canvas, the same for a live run and for a replay. Every text is drawn,
// never parsed.
'use strict';

const kTopColours = {path: '#5aa9e6', robot: '#ffffff', text: '#e4e9ee', truth: '#f0f0f0'};

/** A canvas as sharp as the screen, cleared, in CSS pixels. */
function sharpCanvas(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
  const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width;
    canvas.height = height;
  }
  const draw = canvas.getContext('2d');
  draw.setTransform(ratio, 0, 0, ratio, 0, 0);
  draw.clearRect(0, 0, width, height);
  draw.font = '12px system-ui, "DejaVu Sans", sans-serif';
  return {draw, width: width / ratio, height: height / ratio};
}

/** The longest round number of metres (1, 2 or 5 times a power of ten) within a length. */
function scaleLength(metres) {
  const power = Math.pow(10, Math.floor(Math.log10(metres)));
  return [5, 2, 1].map((digit) => digit * power).find((length) => length <= metres) || power;
}

function drawPolyline(draw, points, colour, width) {
  draw.strokeStyle = colour;
  draw.lineWidth = width;
  draw.beginPath();
  points.forEach(([x, y], i) => (i ? draw.lineTo(x, y) : draw.moveTo(x, y)));
  draw.stroke();
}

/** Draws texts with a background within the canvas, in the order of their importance, and leaves
 * out those that would cover another one. */
function drawLabels(draw, labels) {
  const taken = [];
  for (const {text, x, y, colour} of labels) {
    const width = draw.measureText(text).width + 8;
    const left = Math.max(0, Math.min(x, draw.canvas.clientWidth - width));
    const box = {left, top: y - 15, right: left + width, bottom: y};
    const covers = (other) => box.left < other.right && other.left < box.right &&
        box.top < other.bottom && other.top < box.bottom;
    if (taken.some(covers)) continue;
    taken.push(box);
    draw.fillStyle = colour;
    draw.fillRect(left, box.top, width, 15);
    draw.fillStyle = '#10141a';
    draw.fillText(text, left + 4, y - 3.5);
  }
}

const nameOfTrack = (track) => `${track.class} ${track.id}` +
    (track.moving ? `  ${track.speed.toFixed(1)} m/s` : '');

/** Pixels of a place on the canvas; the inverse of placeInTopView(). */
function pixelInTopView(view, x, y) {
  const [c, s] = [Math.cos(view.yaw), Math.sin(view.yaw)];
  const forward = c * (x - view.x) + s * (y - view.y);
  const left = -s * (x - view.x) + c * (y - view.y);
  return [view.left - view.zoom * left, view.top - view.zoom * forward];
}

function placeInTopView(view, px, py) {
  const [c, s] = [Math.cos(view.yaw), Math.sin(view.yaw)];
  const forward = (view.top - py) / view.zoom;
  const left = (view.left - px) / view.zoom;
  return [view.x + c * forward - s * left, view.y + s * forward + c * left];
}

function drawPrediction(draw, track, path, pixel) {
  draw.globalAlpha = 0.25 + 0.6 * path.probability;
  drawPolyline(draw, [[track.x, track.y], ...path.points], track.colour, 2 * pixel);
  draw.globalAlpha *= 0.5;
  const [x, y, major, minor, angle] = path.points[path.points.length - 1];
  draw.lineWidth = pixel;
  draw.beginPath();
  draw.ellipse(x, y, Math.min(major, 5), Math.min(minor, 5), angle, 0, 2 * Math.PI);
  draw.stroke();
}

function drawTrackFromAbove(draw, track, pixel, layers) {
  if (layers.predictions) {
    for (const path of track.paths) drawPrediction(draw, track, path, pixel);
  }
  draw.globalAlpha = 0.6;
  if (layers.trails && track.trail) drawPolyline(draw, track.trail, track.colour, 1.5 * pixel);
  draw.globalAlpha = 1;
  if (!layers.boxes) return;
  draw.save();
  draw.translate(track.x, track.y);
  draw.rotate(track.yaw);
  draw.fillStyle = track.colour;
  draw.globalAlpha = track.moving ? 0.9 : 0.45;
  draw.fillRect(-track.length / 2, -track.width / 2, track.length, track.width);
  draw.restore();
}

function drawRobotFromAbove(draw, [x, y, yaw], colours) {
  draw.save();
  draw.translate(x, y);
  draw.rotate(yaw);
  draw.fillStyle = colours.robot;
  draw.beginPath();
  for (const [px, py] of [[0.9, 0], [-0.5, 0.5], [-0.25, 0], [-0.5, -0.5]]) draw.lineTo(px, py);
  draw.fill();
  draw.restore();
}

/** A picture whose first row has the greatest y. */
function drawGridFromAbove(draw, {picture, bounds}) {
  draw.imageSmoothingEnabled = false;
  draw.save();
  draw.translate(bounds.x, bounds.y + bounds.height);
  draw.scale(1, -1);
  draw.drawImage(picture, 0, 0, bounds.width, bounds.height);
  draw.restore();
}

function drawTruthFromAbove(draw, truth, pixel, colours) {
  drawPolyline(draw, truth.path, colours.truth, 1.5 * pixel);
  for (const object of truth.objects) {
    draw.save();
    draw.translate(object.x, object.y);
    draw.rotate(object.yaw);
    draw.strokeStyle = colours.truth;
    draw.lineWidth = pixel;
    draw.strokeRect(-object.length / 2, -object.width / 2, object.length, object.width);
    draw.restore();
  }
}

function drawScaleBar(draw, view, width, [x, y], colours) {
  const bar = scaleLength(Math.min(300, width / 4) / view.zoom);
  draw.fillStyle = colours.text;
  draw.fillRect(x, y, bar * view.zoom, 2);
  draw.fillText(`${bar} m`, x, y - 6);
}

/** Draws the world from above.
 *
 * `view`: the place (x, y) [m] that is drawn at pixel (left, top), the direction that points up
 * (`yaw`), and `zoom` [pixels/m]. `world`: `pose` [x, y, yaw]; `path`; `tracks` with `x, y, yaw,
 * length, width, colour, moving` and predicted `paths` of a `probability` and points [x, y, one
 * standard deviation along and across `angle`, angle]; optionally `grid`, `truth`, `layers` that are
 * not to be drawn, `colours`, and the place of the `scaleBar`. */
function drawTopView(draw, width, height, view, world) {
  const layers = {ground: true, path: true, boxes: true, trails: true, predictions: true,
                  labels: false, truth: true, ...world.layers};
  const colours = {...kTopColours, ...world.colours};
  const pixel = 1 / view.zoom;
  draw.save();
  draw.translate(view.left, view.top);
  draw.scale(view.zoom, -view.zoom);
  draw.rotate(Math.PI / 2 - view.yaw);
  draw.translate(-view.x, -view.y);
  if (world.grid && layers.ground) drawGridFromAbove(draw, world.grid);
  if (layers.path) drawPolyline(draw, world.path, colours.path, 2 * pixel);
  if (world.truth && layers.truth) drawTruthFromAbove(draw, world.truth, pixel, colours);
  for (const track of world.tracks) drawTrackFromAbove(draw, track, pixel, layers);
  drawRobotFromAbove(draw, world.pose, colours);
  draw.restore();
  drawScaleBar(draw, view, width, world.scaleBar || [12, height - 16], colours);
  if (!layers.labels) return;
  drawLabels(draw, world.tracks.filter((track) => track.moving).map((track) => {
    const [x, y] = pixelInTopView(view, track.x, track.y);
    const reach = view.zoom * Math.hypot(track.length, track.width) / 2;  // of the box, in any direction
    return {text: nameOfTrack(track), x: x + reach + 6, y: y + 7, colour: track.colour};
  }));
}
