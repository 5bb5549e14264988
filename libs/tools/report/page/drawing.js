// SPDX-License-Identifier: BSD-3-Clause
// Draws the moment: the scene, the map from above, names, panels and figures.
'use strict';

/** What ReplayPage draws with; it has the replay, the view, the layers and the selection. */
class PageDrawing {
  draw(ratio, sharpness) {
    this.moment = momentOf(this.replay, this.time);
    const [width, height] = [innerWidth, innerHeight];
    this.views.update(this.moment, width, height);
    this.world.update(this.moment, this.selected);
    this.showLayers();
    if (this.renderer) this.drawWorld(ratio, sharpness, width, height);
    this.drawOverlay();
    this.image.update(this.moment, this.selected, this.views.name !== 'camera');
    this.panel.update(this.moment, this.colours);
    this.showFigures(ratio);
  }

  /** In the view from above, what the shared script draws is not drawn twice. */
  showLayers() {
    const fromAbove = this.views.name === 'top';
    const twice = ['ground', 'path', 'boxes', 'trails', 'predictions', 'truth'];
    for (const [name, group] of Object.entries(this.world.layers)) {
      group.visible = (name === 'future' || this.layers[name]) && !(fromAbove && twice.includes(name));
    }
    if (this.views.name === 'camera') this.world.layers.path.visible = false;
  }

  drawWorld(ratio, sharpness, width, height) {
    const pixels = sharpness * Math.min(2, window.devicePixelRatio || 1);
    const size = `${width} ${height} ${pixels}`;
    if (this.size !== size) {
      this.renderer.setPixelRatio(pixels);
      this.renderer.setSize(width, height, false);
    }
    this.size = size;
    const fromAbove = this.views.name === 'top';
    const magnification = fromAbove ? pixels * this.views.topView(this.moment, width, height).zoom :
                                      this.views.camera.projectionMatrix.elements[5];
    for (const cloud of this.world.clouds) showPart(cloud, ratio, magnification, fromAbove);
    this.views.camera.matrixWorldInverse.getInverse(this.views.camera.matrixWorld);
    this.world.fadeFor(this.moment, this.views.camera);
    this.placeBackdrop(width, height);
    this.renderer.setScissorTest(false);
    this.renderer.clear();
    if (!this.backdrop.hidden) this.keepToImage(width, height);
    this.renderer.render(this.world.scene, this.views.camera);
  }

  /** Draws within the camera's image only. */
  keepToImage(width, height) {
    const {zoom, left, top} = this.views.imageFrame(width, height);
    const {camera} = this.replay;
    this.renderer.setScissor(left, top, zoom * camera.width, zoom * camera.height);
    this.renderer.setScissorTest(true);
  }

  /** The image behind the scene in the camera's view, instead of the points. */
  placeBackdrop(width, height) {
    const shown = this.views.name === 'camera' && this.image.isAvailable;
    this.backdrop.hidden = !shown;
    for (const cloud of this.world.clouds) cloud.visible = !shown;
    if (!shown) return;
    this.image.show(this.moment.frame);
    if (this.backdrop.src !== this.image.image.src) this.backdrop.src = this.image.image.src;
    const {zoom, left, top} = this.views.imageFrame(width, height);
    const {camera} = this.replay;
    Object.assign(this.backdrop.style, {left: `${left}px`, top: `${top}px`, width: `${zoom * camera.width}px`,
                                        height: `${zoom * camera.height}px`});
  }

  drawOverlay() {
    const {draw, width, height} = sharpCanvas(byId('overlay'));
    if (this.views.name === 'top') this.drawFromAbove(draw, width, height);
    else if (this.layers.labels && this.layers.boxes) this.drawNames(draw, width, height);
  }

  drawFromAbove(draw, width, height) {
    const {moment, replay, layers} = this;
    const path = replay.frames.slice(0, moment.at + 1).map(({pose}) => pose);
    drawTopView(draw, width, height, this.views.topView(moment, width, height), {
      pose: [moment.pose[0], moment.pose[1], yawOf(moment.pose)],
      path: [...path, moment.pose],
      tracks: moment.tracks.map((state) => ({...state, trail: this.trailFromAbove(state)})),
      grid: this.gridFromAbove,
      truth: replay.truth && {path: replay.truth.path, objects: replay.truth.objects[moment.at]},
      layers,
      scaleBar: [byId('camera-image').offsetWidth + 28, height - 84],
      colours: {path: '#5aa9e6', robot: this.isLight ? '#1b2430' : '#ffffff', text: this.colours.text,
                truth: this.isLight ? '#1b2430' : '#f0f0f0'},
    });
  }

  trailFromAbove(state) {
    if (!state.moving) return null;
    const {states} = this.replay.tracks[state.number];
    const from = this.time - kTrailS;
    return [...states.filter(({time}) => time >= from && time <= this.time).map(({state: s}) => [s.x, s.y]),
            [state.x, state.y]];
  }

  /** Names above the boxes of moving tracks, the nearest ones first. */
  drawNames(draw, width, height) {
    const camera = this.views.camera;
    const labels = [];
    for (const state of this.moment.tracks) {
      if (!state.moving && state.number !== this.selected) continue;
      const place = new THREE.Vector3(state.x, state.y, state.z + state.height / 2 + 0.3 * this.world.scale);
      const distance = place.distanceTo(camera.position);
      const {x, y, z} = place.project(camera);
      if (Math.abs(x) > 1.05 || Math.abs(y) > 1.05 || z > 1) continue;
      labels.push({text: nameOfTrack(state), x: (x + 1) / 2 * width - 20, y: (1 - y) / 2 * height,
                   colour: state.colour, order: state.number === this.selected ? -1 : distance});
    }
    drawLabels(draw, labels.sort((a, b) => a.order - b.order));
  }

  showFigures(ratio) {
    const {moment, replay} = this;
    byId('moment').textContent = `frame ${moment.frame} · ${moment.speed.toFixed(1)} m/s over ${kSpeedS} s · ` +
        `${moment.tracks.length} ${moment.tracks.length === 1 ? 'track' : 'tracks'}`;
    byId('time').textContent = clockText(this.time);
    if (document.activeElement !== byId('scrub') || this.playing) byId('scrub').value = this.time;
    const drawn = Math.round(ratio * this.world.pointCount);
    byId('figures').textContent = `${drawn.toLocaleString('en')} of ` +
        `${this.world.pointCount.toLocaleString('en')} points` +
        (this.budget.rate ? ` · ${this.budget.rate.toFixed(0)} pictures/s` : '');
    document.documentElement.dataset.drawn = `${moment.frame} ${this.views.name}`;
  }
}
