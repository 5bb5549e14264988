// SPDX-License-Identifier: BSD-3-Clause
// The replay as the page reads it: decoded from its data blocks, and interpolated between frames.
'use strict';

const kPredictedPoint = 7;  // numbers of each predicted point
const kSameGapS = 0.6;      // a longer pause between two states of a track is a gap [s]
const kSpeedS = 1;          // the robot's speed is its mean over this time, as in the pictures [s]

const byId = (id) => document.getElementById(id);

function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

/** The text of a data block, which is removed to free its memory. */
function takeBlock(id) {
  const block = byId(id);
  if (!block) return null;
  const text = block.textContent;
  block.remove();
  return text;
}

/** A cloud of points: `positions` in steps of `step` from `origin`, and `colours`. */
function readCloud(id, header) {
  const text = takeBlock(id);
  if (!header || !text || !header.count) return null;
  const bytes = bytesOf(text);
  const n = header.count;
  return {count: n, spacing: header.spacing, origin: header.origin, step: header.step,
          positions: new Uint16Array(bytes.buffer, 0, 3 * n),
          colours: new Uint8Array(bytes.buffer, 6 * n, 3 * n)};
}

function readState(values, data) {
  const [number, kind, flags, x, y, z, yaw, vx, vy, length, width, height] = values;
  return {
    number, id: data.tracks[number].id, class: data.classes[kind][0], colour: data.classes[kind][1],
    moving: (flags & 1) !== 0, coasting: (flags & 2) !== 0, x: x / 100, y: y / 100, z: z / 100,
    yaw: yaw / 1000, speed: Math.hypot(vx, vy) / 100, length: length / 100, width: width / 100,
    height: height / 100, paths: [],
  };
}

function readPrediction(values) {
  const points = [];
  for (let i = 2; i < values.length; i += kPredictedPoint) {
    const [horizon, x, y, z, major, minor, angle] = values.slice(i, i + kPredictedPoint);
    const point = [x / 100, y / 100, major / 100, minor / 100, angle / 1000];
    points.push(Object.assign(point, {horizon: horizon / 10, z: z / 100}));
  }
  return {probability: values[1] / 100, points};
}

function readFrame(frame, data) {
  const states = new Map(frame.states.map((values) => [values[0], readState(values, data)]));
  for (const values of frame.predictions) {
    const state = states.get(values[0]);
    if (state) state.paths.push(readPrediction(values));
  }
  return {frame: frame.frame, time: frame.time, pose: frame.pose, states};
}

/** The states of each track in order of time, with the position of their frames. */
function statesByTrack(data, frames) {
  const tracks = data.tracks.map(({id, votes}) => ({id, votes, states: []}));
  frames.forEach((frame, at) => {
    for (const state of frame.states.values()) {
      tracks[state.number].states.push({at, time: frame.time, state});
    }
  });
  return tracks;
}

function readTruthBoxes(boxes) {
  return boxes.map(([x, y, z, yaw, length, width, height]) => ({
    x: x / 100, y: y / 100, z: z / 100, yaw: yaw / 1000, length: length / 100, width: width / 100,
    height: height / 100,
  }));
}

const triples = (values) => Array.from({length: values.length / 3},
                                       (_, i) => values.slice(3 * i, 3 * i + 3).map((v) => v / 100));

function readReplay() {
  const data = JSON.parse(takeBlock('data'));
  const frames = data.frames.map((frame) => readFrame(frame, data));
  const truth = data.truth && {path: triples(data.truth.path),
                               objects: data.truth.objects.map(readTruthBoxes)};
  return {
    ...data, frames, truth, tracks: statesByTrack(data, frames),
    duration: frames[frames.length - 1].time, images: JSON.parse(takeBlock('images') || '[]'),
    dense: readCloud('dense', data.dense), landmarks: readCloud('landmarks', data.landmarks),
  };
}

/** Position of the last item whose key is not above a value; 0 if there is none. */
function lastNotAbove(items, key, value) {
  let [low, high] = [0, items.length - 1];
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if (key(items[middle]) <= value) low = middle;
    else high = middle - 1;
  }
  return low;
}

const mixed = (a, b, ratio) => a + (b - a) * ratio;
const wrapped = (angle) => angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));
const yawOf = ([, , , x, y, z, w]) => Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));

function mixedPose(a, b, ratio) {
  const dot = a[3] * b[3] + a[4] * b[4] + a[5] * b[5] + a[6] * b[6];
  const pose = a.map((value, i) => mixed(value, i > 2 && dot < 0 ? -b[i] : b[i], ratio));
  const norm = Math.hypot(pose[3], pose[4], pose[5], pose[6]) || 1;
  return pose.map((value, i) => (i > 2 ? value / norm : value));
}

function mixedState(a, b, ratio) {
  if (!b) return a;
  return {...a, x: mixed(a.x, b.x, ratio), y: mixed(a.y, b.y, ratio), z: mixed(a.z, b.z, ratio),
          yaw: a.yaw + ratio * wrapped(b.yaw - a.yaw), speed: mixed(a.speed, b.speed, ratio)};
}

/** The robot's mean speed over the last second up to a frame [m/s]; 0 at the first one. */
function speedAt(frames, at) {
  const now = frames[at];
  const before = frames[lastNotAbove(frames, (frame) => frame.time, now.time - kSpeedS + 1e-6)];
  const way = [0, 1, 2].map((i) => now.pose[i] - before.pose[i]);
  return now.time > before.time ? Math.hypot(...way) / (now.time - before.time) : 0;
}

/** The replay at a time [s since its first frame]: the pose, and the tracks of the last frame moved
 * on to the time. */
function momentOf(replay, time) {
  const at = lastNotAbove(replay.frames, (frame) => frame.time, time);
  const frame = replay.frames[at];
  const next = replay.frames[Math.min(at + 1, replay.frames.length - 1)];
  const gap = next.time - frame.time;
  const ratio = gap > 0 && gap < kSameGapS ? Math.min(1, Math.max(0, (time - frame.time) / gap)) : 0;
  const tracks = [...frame.states.values()].map(
      (state) => mixedState(state, ratio ? next.states.get(state.number) : null, ratio));
  return {at, time, frame: frame.frame, pose: mixedPose(frame.pose, next.pose, ratio), tracks,
          speed: speedAt(replay.frames, at)};
}

/** Place of a track at a time, between two of its states; null in a gap. */
function placeOfTrack(track, time) {
  const {states} = track;
  const i = lastNotAbove(states, (entry) => entry.time, time);
  const [a, b] = [states[i], states[Math.min(i + 1, states.length - 1)]];
  const gap = b.time - a.time;
  if (time < a.time - 1e-6 || time > b.time + 1e-6 || gap > kSameGapS) return null;
  const ratio = gap > 0 ? (time - a.time) / gap : 0;
  return [mixed(a.state.x, b.state.x, ratio), mixed(a.state.y, b.state.y, ratio)];
}

/** Errors of the most probable prediction at a horizon: [time of the prediction, metres]. */
function predictionErrors(track, horizon) {
  const errors = [];
  for (const {time, state} of track.states) {
    const path = state.paths[0];
    const point = path && path.points.find((p) => Math.abs(p.horizon - horizon) < 1e-3);
    const place = point && placeOfTrack(track, time + horizon);
    if (place) errors.push([time, Math.hypot(point[0] - place[0], point[1] - place[1])]);
  }
  return errors;
}

/** 75.3 s as 1:15.3. */
function clockText(seconds, decimals = 1) {
  const tenths = Math.round(Math.max(0, seconds) * 10 ** decimals) / 10 ** decimals;
  const minutes = Math.floor(tenths / 60);
  const rest = (tenths - 60 * minutes).toFixed(decimals);
  return `${minutes}:${rest.padStart(decimals ? 3 + decimals : 2, '0')}`;
}
