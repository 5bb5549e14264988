// SPDX-License-Identifier: BSD-3-Clause
// The page: time, keys, links, layers, and when it is drawn.
'use strict';

const kLayers = [
  ['dense', 'Dense map'], ['landmarks', 'Landmarks'], ['ground', 'Free and occupied ground'],
  ['path', 'Path and robot'], ['keyframes', 'Keyframes'], ['boxes', 'Boxes'], ['labels', 'Names'],
  ['trails', 'Trails'], ['predictions', 'Predictions (1 σ)'], ['truth', 'Truth'],
];
const kHiddenAtFirst = ['keyframes', 'truth'];
const kViews = ['follow', 'orbit', 'top', 'camera'];
const kRestMs = 350;  // of a view at rest, after which all points are drawn
const kFullDrawMs = 1500;  // longest time that may take

class ReplayPage extends PageDrawing {
  constructor(replay) {
    super();
    this.replay = replay;
    this.time = 0;
    this.selected = null;
    this.playing = false;
    this.dirty = true;
    this.full = false;
    this.lastMoved = 0;
    const redraw = () => this.redraw();
    this.world = new World(replay, redraw);
    this.views = new Views(replay, this.world);
    this.budget = new PointBudget(this.world.pointCount);
    this.panel = new TrackPanel(replay);
    this.image = new CameraImage(replay, redraw);
    this.backdrop = byId('backdrop');
    this.layers = Object.fromEntries(kLayers.map(([name]) => [name, !kHiddenAtFirst.includes(name)]));
    this.loadGrid(redraw);
    this.renderer = this.makeRenderer();
    byId('title').textContent = replay.title;
    byId('scrub').max = replay.duration;
    byId('left-out').textContent = replay.left_out.join(' · ');
    byId('duration').textContent = ` / ${clockText(replay.duration)}`;
    this.makeLayers();
    this.readColours();
    this.listen();
    this.followLink();
    requestAnimationFrame((now) => this.tick(now));
  }

  makeRenderer() {
    try {
      return new THREE.WebGLRenderer({canvas: byId('world'), antialias: false, alpha: true});
    } catch (error) {
      byId('world').hidden = true;
      this.say('This browser shows no WebGL, so the replay is drawn from above only. ' +
               'Enable hardware acceleration or open the page in another browser.');
      for (const name of ['follow', 'orbit', 'camera']) this.viewButton(name).disabled = true;
      return null;
    }
  }

  say(text) {
    byId('message').textContent = text;
    byId('message').hidden = !text;
  }

  loadGrid(onLoad) {
    const {grid} = this.replay;
    if (!grid) return;
    const picture = new Image();
    picture.onload = () => {
      this.gridFromAbove = {picture, bounds: grid};
      onLoad();
    };
    picture.src = grid.picture;
  }

  makeLayers() {
    const missing = {dense: !this.replay.dense, landmarks: !this.replay.landmarks, ground: !this.replay.grid,
                     keyframes: !this.replay.keyframes.length, truth: !this.replay.truth};
    byId('layer-list').replaceChildren(...kLayers.filter(([name]) => !missing[name]).map(([name, title]) => {
      const label = element('label');
      const box = element('input');
      box.type = 'checkbox';
      box.name = name;
      box.checked = this.layers[name];
      box.addEventListener('change', () => {
        this.layers[name] = box.checked;
        this.redraw();
      });
      label.append(box, document.createTextNode(title));
      return label;
    }));
  }

  readColours() {
    const style = getComputedStyle(document.documentElement);
    const value = (name) => style.getPropertyValue(name).trim();
    this.colours = {text: value('--text'), dim: value('--dim'), edge: value('--edge'), accent: value('--accent')};
    this.isLight = document.documentElement.classList.contains('light');
    this.world.setContrast(this.isLight ? '#1b2430' : '#ffffff');
    this.redraw();
  }

  /** Draws soon; the points are a sample until the view rests. */
  redraw() {
    this.dirty = true;
    this.full = false;
    this.lastMoved = performance.now();
  }

  viewButton(name) {
    return document.querySelector(`[data-view="${name}"]`);
  }

  setView(name) {
    if (!this.renderer && name !== 'top') return;
    this.views.set(name, momentOf(this.replay, this.time));
    this.showView();
  }

  showView() {
    for (const view of kViews) {
      this.viewButton(view).setAttribute('aria-pressed', String(view === this.views.name));
    }
    this.viewButton('camera').hidden = !this.replay.camera;
    this.redraw();
  }

  setTime(time) {
    this.time = Math.min(this.replay.duration, Math.max(0, Number.isFinite(time) ? time : 0));
    this.redraw();
  }

  step(frames) {
    this.play(false);
    const at = lastNotAbove(this.replay.frames, (frame) => frame.time, this.time + 1e-6);
    const next = Math.min(this.replay.frames.length - 1, Math.max(0, at + frames));
    this.setTime(this.replay.frames[next].time);
    this.writeLink();
  }

  play(on) {
    if (on && this.time >= this.replay.duration) this.time = 0;
    this.playing = on;
    byId('play').textContent = on ? '❚❚' : '▶';
    byId('play').setAttribute('aria-label', on ? 'pause' : 'play');
    if (!on) this.writeLink();
    this.redraw();
  }

  changeSpeed(steps) {
    const speed = byId('speed');
    speed.selectedIndex = Math.min(speed.options.length - 1, Math.max(0, speed.selectedIndex + steps));
  }

  select(number) {
    this.selected = number;
    this.panel.select(number);
    this.writeLink();
    this.redraw();
  }

  /** Shows at once what a link names: #t=12.3&track=7&view=top; `track` is an id. */
  followLink() {
    const link = new URLSearchParams(location.hash.slice(1));
    this.setTime(Number(link.get('t')));
    const number = this.replay.tracks.findIndex(({id}) => String(id) === link.get('track'));
    this.selected = number < 0 ? null : number;
    this.panel.select(this.selected);
    if (!this.renderer) this.setView('top');
    else if (kViews.includes(link.get('view'))) this.setView(link.get('view'));
    else this.startView();
    this.draw(this.budget.ratio, this.budget.sharpness);
  }

  startView() {
    this.views.start(innerWidth, innerHeight);
    this.showView();
  }

  writeLink() {
    const parts = [`t=${this.time.toFixed(2)}`];
    if (this.selected !== null) parts.push(`track=${this.replay.tracks[this.selected].id}`);
    if (!this.views.isStart) parts.push(`view=${this.views.name}`);
    history.replaceState(null, '', `#${parts.join('&')}`);
  }

  listen() {
    byId('play').addEventListener('click', () => this.play(!this.playing));
    byId('back').addEventListener('click', () => this.step(-1));
    byId('forward').addEventListener('click', () => this.step(1));
    byId('scrub').addEventListener('input', () => this.setTime(Number(byId('scrub').value)));
    byId('scrub').addEventListener('change', () => this.writeLink());
    byId('close').addEventListener('click', () => this.select(null));
    byId('layers-button').addEventListener('click', () => this.toggleLayers());
    byId('theme').addEventListener('click', () => this.setTheme(!this.isLight));
    byId('camera-image').addEventListener('click', () => this.changeView('camera'));
    for (const view of kViews) this.viewButton(view).addEventListener('click', () => this.changeView(view));
    window.addEventListener('resize', () => this.redraw());
    window.addEventListener('hashchange', () => this.followLink());
    document.addEventListener('keydown', (event) => this.onKey(event));
    listenToGestures(byId('overlay'), {
      drag: (dx, dy) => this.moveView(() => this.views.drag(dx, dy, innerWidth, innerHeight)),
      pan: (dx, dy) => this.moveView(() => this.views.pan(dx, dy, this.moment, innerHeight)),
      zoom: (factor) => this.moveView(() => this.views.zoom(factor)),
      click: (event) => this.onClick(event),
    });
  }

  moveView(change) {
    const before = this.views.name;
    change();
    if (this.views.name !== before) this.setView(this.views.name);
    this.redraw();
  }

  changeView(name) {
    this.setView(name);
    this.writeLink();
  }

  setTheme(isLight) {
    document.documentElement.classList.toggle('light', isLight);
    this.readColours();
  }

  toggleLayers() {
    const hidden = !byId('layers').hidden;
    byId('layers').hidden = hidden;
    byId('layers-button').setAttribute('aria-expanded', String(!hidden));
  }

  onClick(event) {
    const point = {x: 2 * event.clientX / innerWidth - 1, y: 1 - 2 * event.clientY / innerHeight};
    this.select(this.world.pick(point, this.views.camera));
  }

  onKey(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.tagName === 'SELECT') return;
    const go = (time) => {
      this.setTime(time);
      this.writeLink();
    };
    const actions = {
      ' ': () => this.play(!this.playing), 'k': () => this.play(!this.playing),
      'ArrowLeft': () => (event.shiftKey ? go(this.time - 1) : this.step(-1)),
      'ArrowRight': () => (event.shiftKey ? go(this.time + 1) : this.step(1)),
      'Home': () => go(0), 'End': () => go(this.replay.duration),
      '+': () => this.changeSpeed(1), '-': () => this.changeSpeed(-1),
      'l': () => this.toggleLayers(), 'Escape': () => this.select(null),
      '1': () => this.changeView('follow'), '2': () => this.changeView('orbit'),
      '3': () => this.changeView('top'), '4': () => this.changeView('camera'),
    };
    if (!actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
  }

  /** One picture of the browser: moves the time on, and draws if anything has changed. */
  tick(now) {
    const passed = this.lastTick ? now - this.lastTick : 0;
    this.lastTick = now;
    if (this.playing) {
      this.time += Math.min(passed, 500) / 1000 * Number(byId('speed').value);
      if (this.time >= this.replay.duration) {
        this.time = this.replay.duration;
        this.play(false);
      }
      this.redraw();
    }
    if (this.dirty) {
      if (this.drewBefore) this.budget.measure(passed);
      this.draw(this.budget.ratio, this.budget.sharpness);
    } else {
      this.budget.rest();
      if (!this.full && now - this.lastMoved > kRestMs) this.drawAll();
    }
    this.drewBefore = this.dirty;
    this.dirty = false;
    requestAnimationFrame((next) => this.tick(next));
  }

  /** Draws all points of a view at rest, or as many as can be drawn without stopping the page. */
  drawAll() {
    this.full = true;
    const affordable = this.budget.ratio * kFullDrawMs / kFrameMs;
    this.draw(Math.min(1, affordable), 1);
  }
}

if (window.matchMedia('(prefers-color-scheme: light)').matches) {
  document.documentElement.classList.add('light');
}
window.replayPage = new ReplayPage(readReplay());
