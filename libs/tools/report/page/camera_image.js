// SPDX-License-Identifier: BSD-3-Clause
// The camera's image of the moment with the outlines of the tracks' boxes.
'use strict';

class CameraImage {
  constructor(replay, onLoad) {
    this.replay = replay;
    this.frame = null;
    this.image = new Image();
    this.image.onload = onLoad;
    byId('camera-image').hidden = !this.isAvailable;
    if (this.isAvailable) this.shape();
  }

  get isAvailable() {
    return this.replay.images.length > 0 && this.replay.camera !== null;
  }

  /** A quarter of the window's height at most. */
  shape() {
    const {width, height} = this.replay.camera;
    byId('inset').style.setProperty('aspect-ratio', `${width} / ${height}`);
    byId('camera-image').style.setProperty('width', `min(320px, 42vw, ${(25 * width / height).toFixed(1)}vh)`);
  }

  /** Shows the last image that is not newer than a frame. */
  show(frame) {
    const {images} = this.replay;
    const [index, jpeg] = images[lastNotAbove(images, ([at]) => at, frame)];
    if (index === this.frame) return;
    this.frame = index;
    this.image.src = `data:image/jpeg;base64,${jpeg}`;
  }

  /** Outline of a track's box in the image [pixels of the calibration]; null behind the camera. */
  outline(state, toCamera) {
    const {camera} = this.replay;
    const corners = cornersOf(state).map((corner) => corner.applyMatrix4(toCamera));
    if (corners.some(({z}) => z < 0.3)) return null;
    const us = corners.map(({x, z}) => camera.cx + camera.fx * x / z);
    const vs = corners.map(({y, z}) => camera.cy + camera.fy * y / z);
    return [Math.min(...us), Math.min(...vs), Math.max(...us), Math.max(...vs)];
  }

  update(moment, selected, isShown) {
    if (!this.isAvailable) return;
    this.show(moment.frame);
    byId('camera-image').hidden = !isShown;
    const version = `${moment.at} ${selected} ${this.frame} ${byId('inset').clientWidth}`;
    if (!isShown || !this.image.complete || !this.image.naturalWidth || this.drawn === version) return;
    this.drawn = version;
    const {draw, width} = sharpCanvas(byId('inset'));
    const {camera} = this.replay;
    const zoom = width / camera.width;
    draw.drawImage(this.image, 0, 0, width, zoom * camera.height);
    const toCamera = new THREE.Matrix4().getInverse(matrixOf(moment.pose).multiply(matrixOf(camera.pose)));
    for (const state of moment.tracks) {
      const box = state.moving || state.number === selected ? this.outline(state, toCamera) : null;
      if (!box) continue;
      const [x1, y1, x2, y2] = box.map((value) => value * zoom);
      draw.strokeStyle = state.number === selected ? '#ffffff' : state.colour;
      draw.lineWidth = 1.5;
      draw.strokeRect(x1, y1, x2 - x1, y2 - y1);
    }
  }
}
