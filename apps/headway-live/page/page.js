// SPDX-License-Identifier: BSD-3-Clause
// Draws what the server's events say. Every text is set as textContent or drawn, never parsed.
'use strict';

const byId = (id) => document.getElementById(id);
const latencies = [];
const arrivals = [];
let image = null;
let grid = {version: -1, picture: null, bounds: null};
let busy = false;
let drawn = null;  // the frame of the pictures, and when it came
let last = null;
let lastAt = 0;  // when it came
let metres = 30;  // across the shorter side of the map

function drawCamera(state) {
  const {draw, width, height} = sharpCanvas(byId('camera'));
  if (!image) return;
  const zoom = Math.min(width / image.width, height / image.height);
  const left = (width - zoom * image.width) / 2;
  const top = (height - zoom * image.height) / 2;
  draw.drawImage(image, left, top, zoom * image.width, zoom * image.height);
  const labels = [];
  for (const track of state.tracks) {
    if (!track.box) continue;
    const [x1, y1, x2, y2] = track.box.map((value) => value * zoom);
    draw.strokeStyle = track.colour;
    draw.lineWidth = track.moving ? 2.5 : 1.2;
    draw.setLineDash(track.coasting ? [5, 4] : []);
    draw.strokeRect(left + x1, top + y1, x2 - x1, y2 - y1);
    draw.setLineDash([]);
    if (!track.moving) continue;
    const y = Math.max(top + 15, top + y1);
    labels.push({text: nameOfTrack(track), x: left + x1, y, colour: track.colour});
  }
  drawLabels(draw, labels);
}

function drawMap(state) {
  const {draw, width, height} = sharpCanvas(byId('map'));
  const [x, y, yaw] = state.pose;
  const zoom = Math.min(width, height) / metres;
  const view = {x, y, yaw, zoom, left: width / 2, top: height * 0.62};
  drawTopView(draw, width, height, view, {
    pose: state.pose, path: [...state.path, [x, y]], tracks: state.tracks,
    grid: grid.picture ? grid : null,
  });
}

function drawLatency() {
  const {draw, width, height} = sharpCanvas(byId('latency'));
  const top = Math.max(50, ...latencies) * 1.15;
  const y = (ms) => height - 4 - (height - 12) * ms / top;
  draw.fillStyle = '#93a1af';
  draw.strokeStyle = '#2c343d';
  const step = scaleLength(top / 2);
  for (let ms = 0; ms < top; ms += step) {
    draw.fillText(ms, 8, y(ms) - 3);
    drawPolyline(draw, [[0, y(ms)], [width, y(ms)]], '#2c343d', 1);
  }
  const first = width - latencies.length * width / 300;
  drawPolyline(draw, latencies.map((ms, i) => [first + (i + 0.5) * width / 300, y(ms)]), '#5aa9e6', 1.5);
}

function fill(element, children) {
  element.replaceChildren(...children);
}

function element(kind, text, style) {
  const made = document.createElement(kind);
  made.textContent = text;
  if (style) made.className = style;
  return made;
}

function showTitle() {
  document.title = `${byId('state').textContent}, frame ${last.frame} - headway`;
}

/// Of data, which grows while nothing comes [ms].
const ageOf = (ageThen) => ageThen + performance.now() - lastAt;
const seconds = (ms) => `${(ms / 1000).toFixed(1)} s`;
const maxAge = 1000;

/// What is too old is red: the newest frame, and pictures that are left out under load.
function showAges() {
  if (!last) return;
  const age = ageOf(last.age_ms);
  byId('age').textContent = seconds(age);
  if (events.readyState === EventSource.OPEN) {
    if (age > maxAge) {
      showState(`no frame for ${seconds(age)}, ${last.status} before`, 'gone');
      showTitle();
    } else {
      showState(last.status, last.status);
    }
  }
  const pictures = last.pictures;
  const oldness = drawn ? performance.now() - drawn.cameAt : 0;
  const isOld = drawn && pictures && (pictures.frame !== last.frame || oldness > maxAge);
  byId('pictures').textContent = !isOld ? '' :
      `picture and map of frame ${drawn.frame}, ${seconds(oldness)} old` +
      (last.left_out ? ` (load: ${last.left_out})` : '');
}

function showState(text, style) {
  byId('state').textContent = text;
  byId('state').className = `state ${style}`;
}

function showFigures(state) {
  const rate = arrivals.length > 1 ?
      (arrivals[arrivals.length - 1].frames - arrivals[0].frames) /
      Math.max(0.1, (arrivals[arrivals.length - 1].at - arrivals[0].at) / 1000) : 0;
  const [x, y, yaw] = state.pose;
  const figures = {
    frame: state.frame, age: '', 'frames/s': rate.toFixed(1), latency: `${state.latency_ms.toFixed(0)} ms`,
    processing: `${state.process_ms.toFixed(0)} ms`, dropped: state.dropped,
    x: `${x.toFixed(2)} m`, y: `${y.toFixed(2)} m`, yaw: `${(yaw * 180 / Math.PI).toFixed(0)}°`,
    landmarks: state.inliers, tracks: state.tracks.length,
  };
  fill(byId('figures'), Object.entries(figures).map(([name, value]) => {
    const pair = document.createElement('div');
    pair.append(element('dt', name), element('dd', value));
    if (name === 'age') pair.lastChild.id = 'age';
    return pair;
  }));
}

function showSensors(sensors) {
  const head = document.createElement('tr');
  for (const name of ['sensor', 'state', 'observations', 'restarts']) head.append(element('th', name));
  fill(byId('sensors'), [head, ...sensors.map((sensor) => {
    const row = document.createElement('tr');
    row.append(element('td', sensor.name),
               element('td', sensor.running ? 'running' : sensor.error || 'stopped',
                       sensor.running ? 'good' : 'bad'),
               element('td', sensor.observations), element('td', sensor.restarts));
    return row;
  })]);
}

function showWarnings(state) {
  const warnings = state.warnings.map((text) => element('li', text));
  fill(byId('warnings'), warnings.length ? warnings : [element('li', 'no warnings', 'none')]);
}

const load = async (url) => createImageBitmap(await (await fetch(url)).blob());

async function update(state) {
  last = state;
  lastAt = performance.now();
  latencies.push(state.latency_ms);
  if (latencies.length > 300) latencies.shift();
  arrivals.push({at: performance.now(), frames: state.frames});
  if (arrivals.length > 20) arrivals.shift();
  showFigures(state);
  showAges();
  showSensors(state.sensors);
  showWarnings(state);
  redraw();
  const pictures = state.pictures;
  if (busy || !pictures || (drawn && pictures.frame === drawn.frame)) return;
  busy = true;
  const cameAt = lastAt - pictures.age_ms;
  try {
    image = pictures.has_image ? await load(`image.jpg?frame=${pictures.frame}`) : null;
    if (pictures.grid && pictures.grid.version !== grid.version) {
      const picture = await load(`grid.png?version=${pictures.grid.version}`);
      grid = {version: pictures.grid.version, picture, bounds: pictures.grid};
    }
    drawn = {frame: pictures.frame, cameAt};
  } catch (error) {
    // The picture is drawn with the next event.
  } finally {
    busy = false;
  }
  redraw();
}

function redraw() {
  if (!last) return;
  drawCamera(last);
  drawMap(last);
  drawLatency();
  showTitle();
}

const events = new EventSource('events');
events.onmessage = (event) => update(JSON.parse(event.data));
events.addEventListener('sensors', (event) => showSensors(JSON.parse(event.data)));
events.onerror = () => showState('no connection', 'gone');
setInterval(showAges, 200);
window.addEventListener('resize', redraw);
byId('map').addEventListener('wheel', (event) => {
  metres = Math.min(500, Math.max(5, metres * Math.exp(event.deltaY / 500)));
  event.preventDefault();
  redraw();
}, {passive: false});
