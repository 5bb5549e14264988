// Draws what the server's events say. Every text is set as textContent or drawn, never parsed.
'use strict';

const byId = (id) => document.getElementById(id);
const latencies = [];
const arrivals = [];
let image = null;
let grid = {version: -1, picture: null, bounds: null};
let busy = false;
let last = null;
let metres = 30;  // across the shorter side of the map

/** A canvas as sharp as the screen, cleared. */
function sheet(id) {
  const canvas = byId(id);
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

function label(draw, text, x, y, colour) {
  const width = draw.measureText(text).width + 8;
  draw.fillStyle = colour;
  draw.fillRect(x, y - 15, width, 15);
  draw.fillStyle = '#10141a';
  draw.fillText(text, x + 4, y - 3.5);
}

const nameOf = (track) => `${track.class} ${track.id}` +
    (track.moving ? `  ${track.speed.toFixed(1)} m/s` : '');

function drawCamera(state) {
  const {draw, width, height} = sheet('camera');
  if (!image) return;
  const zoom = Math.min(width / image.width, height / image.height);
  const left = (width - zoom * image.width) / 2;
  const top = (height - zoom * image.height) / 2;
  draw.drawImage(image, left, top, zoom * image.width, zoom * image.height);
  for (const track of state.tracks) {
    if (!track.box) continue;
    const [x1, y1, x2, y2] = track.box.map((value) => value * zoom);
    draw.strokeStyle = track.colour;
    draw.lineWidth = track.moving ? 2.5 : 1.2;
    draw.setLineDash(track.coasting ? [5, 4] : []);
    draw.strokeRect(left + x1, top + y1, x2 - x1, y2 - y1);
    draw.setLineDash([]);
    if (track.moving) label(draw, nameOf(track), left + x1, Math.max(top + 15, top + y1), track.colour);
  }
}

/** Length of a round number of metres that is about a quarter of the width. */
function scaleLength(metres) {
  const power = Math.pow(10, Math.floor(Math.log10(metres)));
  return [5, 2, 1].map((digit) => digit * power).find((length) => length <= metres) || power;
}

function drawPath(draw, path, colour, width) {
  draw.strokeStyle = colour;
  draw.lineWidth = width;
  draw.beginPath();
  path.forEach(([x, y], i) => (i ? draw.lineTo(x, y) : draw.moveTo(x, y)));
  draw.stroke();
}

function drawTrack(draw, track, pixel) {
  for (const path of track.paths) {
    draw.globalAlpha = 0.25 + 0.6 * path.probability;
    drawPath(draw, [[track.x, track.y], ...path.points], track.colour, 2 * pixel);
    const [x, y, sigma] = path.points[path.points.length - 1];
    draw.globalAlpha *= 0.5;
    draw.lineWidth = pixel;
    draw.beginPath();
    draw.arc(x, y, Math.min(sigma, 5), 0, 7);
    draw.stroke();
  }
  draw.globalAlpha = 1;
  draw.save();
  draw.translate(track.x, track.y);
  draw.rotate(track.yaw);
  draw.fillStyle = track.colour;
  draw.globalAlpha = track.moving ? 0.9 : 0.45;
  draw.fillRect(-track.length / 2, -track.width / 2, track.length, track.width);
  draw.restore();
}

function drawMap(state) {
  const {draw, width, height} = sheet('map');
  const zoom = Math.min(width, height) / metres;
  const [x, y, yaw] = state.pose;
  draw.save();
  draw.translate(width / 2, height * 0.62);
  draw.scale(zoom, -zoom);
  draw.rotate(Math.PI / 2 - yaw);
  draw.translate(-x, -y);
  if (grid.picture) {
    const b = grid.bounds;
    draw.imageSmoothingEnabled = false;
    draw.save();
    draw.translate(b.x, b.y);
    draw.drawImage(grid.picture, 0, 0, b.width, b.height);
    draw.restore();
  }
  drawPath(draw, [...state.path, [x, y]], '#5aa9e6', 2 / zoom);
  for (const track of state.tracks) drawTrack(draw, track, 1 / zoom);
  draw.translate(x, y);
  draw.rotate(yaw);
  draw.fillStyle = '#ffffff';
  draw.beginPath();
  for (const [px, py] of [[0.9, 0], [-0.5, 0.5], [-0.25, 0], [-0.5, -0.5]]) draw.lineTo(px, py);
  draw.fill();
  draw.restore();
  const bar = scaleLength(width / zoom / 4);
  draw.fillStyle = '#e4e9ee';
  draw.fillRect(12, height - 16, bar * zoom, 2);
  draw.fillText(`${bar} m`, 12, height - 22);
}

function drawLatency() {
  const {draw, width, height} = sheet('latency');
  const top = Math.max(50, ...latencies) * 1.15;
  const y = (ms) => height - 4 - (height - 12) * ms / top;
  draw.fillStyle = '#93a1af';
  draw.strokeStyle = '#2c343d';
  const step = scaleLength(top / 2);
  for (let ms = 0; ms < top; ms += step) {
    draw.fillText(ms, 8, y(ms) - 3);
    drawPath(draw, [[0, y(ms)], [width, y(ms)]], '#2c343d', 1);
  }
  const first = width - latencies.length * width / 300;
  drawPath(draw, latencies.map((ms, i) => [first + (i + 0.5) * width / 300, y(ms)]), '#5aa9e6', 1.5);
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
    frame: state.frame, 'frames/s': rate.toFixed(1), latency: `${state.latency_ms.toFixed(0)} ms`,
    processing: `${state.process_ms.toFixed(0)} ms`, dropped: state.dropped,
    x: `${x.toFixed(2)} m`, y: `${y.toFixed(2)} m`, yaw: `${(yaw * 180 / Math.PI).toFixed(0)}°`,
    landmarks: state.inliers, tracks: state.tracks.length,
  };
  fill(byId('figures'), Object.entries(figures).map(([name, value]) => {
    const pair = document.createElement('div');
    pair.append(element('dt', name), element('dd', value));
    return pair;
  }));
}

function showHealth(state) {
  const head = document.createElement('tr');
  for (const name of ['sensor', 'state', 'observations', 'restarts']) head.append(element('th', name));
  fill(byId('sensors'), [head, ...state.sensors.map((sensor) => {
    const row = document.createElement('tr');
    row.append(element('td', sensor.name),
               element('td', sensor.running ? 'running' : sensor.error || 'stopped',
                       sensor.running ? 'good' : 'bad'),
               element('td', sensor.observations), element('td', sensor.restarts));
    return row;
  })]);
  const warnings = state.warnings.map((text) => element('li', text));
  fill(byId('warnings'), warnings.length ? warnings : [element('li', 'no warnings', 'none')]);
}

const load = async (url) => createImageBitmap(await (await fetch(url)).blob());

async function update(state) {
  last = state;
  latencies.push(state.latency_ms);
  if (latencies.length > 300) latencies.shift();
  arrivals.push({at: performance.now(), frames: state.frames});
  if (arrivals.length > 20) arrivals.shift();
  showState(state.status, state.status);
  showFigures(state);
  showHealth(state);
  if (busy) return;
  busy = true;
  try {
    if (state.has_image) image = await load(`image.jpg?frame=${state.frame}`);
    if (state.grid && state.grid.version !== grid.version) {
      const picture = await load(`grid.png?version=${state.grid.version}`);
      grid = {version: state.grid.version, picture, bounds: state.grid};
    }
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
  document.title = `${last.status}, frame ${last.frame} - headway`;
}

const events = new EventSource('events');
events.onmessage = (event) => update(JSON.parse(event.data));
events.onerror = () => showState('no connection', 'gone');
window.addEventListener('resize', redraw);
byId('map').addEventListener('wheel', (event) => {
  metres = Math.min(500, Math.max(5, metres * Math.exp(event.deltaY / 500)));
  event.preventDefault();
  redraw();
}, {passive: false});
