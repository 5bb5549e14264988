// SPDX-License-Identifier: BSD-3-Clause
// The 3D scene: what is in it at a moment.
'use strict';

const kPathHalfWidthM = 0.16;
const kTrailS = 4;             // of a track's trail
const kGroundCells = 48;       // a side, of the surface that follows the path's height
const kAboveGroundM = 0.03;
const kCoverage = 1.5;  // of a point's side to the points' spacing, so that surfaces have no gaps

/** Ground height near each place of the path. */
class GroundHeight {
  constructor(replay) {
    const step = Math.max(1, Math.floor(replay.frames.length / 400));
    this.places = replay.frames.filter((_, i) => i % step === 0).map(({pose}) => pose);
    this.offset = replay.ground;
  }
  at(x, y) {
    let [best, z] = [Infinity, 0];
    for (const place of this.places) {
      const distance = (place[0] - x) ** 2 + (place[1] - y) ** 2;
      if (distance < best) [best, z] = [distance, place[2]];
    }
    return z + this.offset;
  }
}

/** The occupancy grid's picture on a surface at the height of the ground. */
function makeGround(grid, ground, onLoad) {
  const geometry = new THREE.PlaneBufferGeometry(grid.width, grid.height, kGroundCells, kGroundCells);
  geometry.translate(grid.x + grid.width / 2, grid.y + grid.height / 2, 0);
  const place = geometry.attributes.position;
  for (let i = 0; i < place.count; ++i) place.setZ(i, ground.at(place.getX(i), place.getY(i)) - 0.02);
  const texture = new THREE.TextureLoader().load(grid.picture, onLoad);
  texture.magFilter = THREE.NearestFilter;
  texture.minFilter = THREE.LinearFilter;
  const material = new THREE.MeshBasicMaterial({map: texture, transparent: true, opacity: 0.5,
                                                depthWrite: false, side: THREE.DoubleSide});
  return new THREE.Mesh(geometry, material);
}

function makeRobot(scale) {
  const shape = new THREE.BufferGeometry();
  const [front, side, back, notch] = [1.1, 0.6, -0.8, -0.4].map((value) => scale * value);
  shape.setAttribute('position', new THREE.BufferAttribute(
      new Float32Array([front, 0, 0, back, side, 0, notch, 0, 0, front, 0, 0, notch, 0, 0, back, -side, 0]), 3));
  return new THREE.Mesh(shape, groundMaterial('#ffffff', 1));
}

function makeKeyframes(poses, camera, scale) {
  const edges = camera ? frustumSegments(camera, 0.4 * scale) : [[0, 0, 0], [0.4 * scale, 0, 0]];
  const mount = camera ? matrixOf(camera.pose) : new THREE.Matrix4();
  return segments(poses.flatMap((pose) => {
    const toMap = matrixOf(pose).multiply(mount);
    return edges.map((place) => new THREE.Vector3(...place).applyMatrix4(toMap).toArray());
  }), '#8fb8d8', 0.8);
}

/** All objects of the scene by layer, updated to a moment. */
class World {
  constructor(replay, onLoad) {
    this.replay = replay;
    this.scale = Math.min(1, Math.max(0.28, replay.reach / 20));
    this.ground = new GroundHeight(replay);
    this.denseSize = kCoverage * (replay.dense ? replay.dense.spacing : 0);
    this.scene = new THREE.Scene();
    this.layers = {};
    this.boxes = new Map();
    this.trails = new Map();
    this.clouds = [];
    this.fading = {robotInView: {value: new THREE.Vector3()}, aspect: {value: 1}, floorHeight: {value: 0},
                   robotHeight: {value: this.scale}};
    this.addMap(onLoad);
    this.addPath();
    this.addMoving();
  }

  layer(name) {
    if (!this.layers[name]) {
      this.layers[name] = new THREE.Group();
      this.scene.add(this.layers[name]);
    }
    return this.layers[name];
  }

  addMap(onLoad) {
    const {replay} = this;
    const dot = (replay.dense ? 0.06 : 0.12) * this.scale;
    for (const [name, size] of [['dense', this.denseSize], ['landmarks', dot]]) {
      if (!replay[name]) continue;
      const cloud = makeCloud(replay[name], size, this.fading);
      this.clouds.push(cloud);
      this.layer(name).add(cloud);
    }
    if (replay.grid) this.layer('ground').add(makeGround(replay.grid, this.ground, onLoad));
  }

  /** A place on the ground, above what is drawn at its level. */
  onGround(x, y, z) {
    return [x, y, z + kAboveGroundM + this.denseSize / 2];
  }

  addPath() {
    const {replay, scale} = this;
    const path = replay.frames.map(({pose: [x, y, z]}) => this.onGround(x, y, z + replay.ground));
    const half = kPathHalfWidthM * scale;
    this.driven = ribbon(path, half, '#5aa9e6', 0.95);
    this.layer('path').add(ribbon(path, half, '#5aa9e6', 0.35), this.driven);
    this.layer('keyframes').add(makeKeyframes(replay.keyframes, replay.camera, scale));
    if (replay.truth) {
      const truth = replay.truth.path.map(([x, y, z]) => this.onGround(x, y, z + replay.ground + 0.02));
      this.truePath = ribbon(truth, 0.3 * half, '#ffffff', 0.9);
      this.layer('truth').add(this.truePath);
      this.trueBoxes = new THREE.Group();
      this.layer('truth').add(this.trueBoxes);
    }
    this.robot = new THREE.Group();
    this.marker = makeRobot(scale);
    this.robot.add(this.marker);
    if (replay.camera) {
      this.frustum = segments(frustumSegments(replay.camera, 2.2 * scale), '#ffffff', 0.7);
      this.frustum.applyMatrix(matrixOf(replay.camera.pose));
      this.robot.add(this.frustum);
    }
    this.marker.position.z = replay.ground + 2 * kAboveGroundM + this.denseSize;
    this.robot.matrixAutoUpdate = false;
    this.layer('path').add(this.robot);
  }

  addMoving() {
    for (const name of ['boxes', 'trails', 'predictions', 'future']) this.layer(name);
    this.shown = -1;
  }

  /** Box of a track, made when it is first seen. */
  boxOf(state) {
    let box = this.boxes.get(state.number);
    if (!box) {
      box = makeBox(state.colour, 0.2);
      box.faces.userData.number = state.number;
      this.boxes.set(state.number, box);
      this.layer('boxes').add(box);
    }
    return box;
  }

  /** Ribbon along all of a track's way, of which a window of time is drawn. */
  trailOf(state) {
    let trail = this.trails.get(state.number);
    if (!trail) {
      const {states} = this.replay.tracks[state.number];
      const way = states.map(({state: s}) => this.onGround(s.x, s.y, s.z - s.height / 2));
      trail = ribbon(way, 0.07 * this.scale, state.colour, 0.75);
      trail.times = states.map(({time}) => time);
      this.trails.set(state.number, trail);
      this.layer('trails').add(trail);
    }
    return trail;
  }

  update(moment, selected) {
    this.robot.matrix.copy(matrixOf(moment.pose));
    this.driven.geometry.setDrawRange(0, 6 * moment.at);
    this.updateBoxes(moment, selected);
    this.updateTrails(moment);
    const version = `${moment.at} ${selected}`;
    if (this.shown === version) return;
    this.shown = version;
    this.updatePredictions(moment);
    this.updateFuture(moment, selected);
    if (this.trueBoxes) this.updateTruth(moment);
  }

  updateBoxes(moment, selected) {
    for (const box of this.boxes.values()) box.visible = false;
    for (const state of moment.tracks) {
      const box = this.boxOf(state);
      box.visible = true;
      placeBox(box, state);
      const isSelected = state.number === selected;
      box.faces.material.color.set(state.colour);
      box.edges.material.color.set(isSelected ? this.contrast : state.colour);
      box.faces.material.opacity = isSelected ? 0.4 : state.moving ? 0.2 : 0.1;
      box.front.visible = state.moving;
    }
  }

  updateTrails(moment) {
    for (const trail of this.trails.values()) trail.visible = false;
    for (const state of moment.tracks) {
      if (!state.moving) continue;
      const trail = this.trailOf(state);
      const last = lastNotAbove(trail.times, (time) => time, moment.time);
      const first = lastNotAbove(trail.times, (time) => time, moment.time - kTrailS);
      trail.visible = last > first;
      trail.geometry.setDrawRange(6 * first, 6 * (last - first));
    }
  }

  clear(group) {
    for (const child of group.children) {
      child.geometry.dispose();
      child.material.dispose();
    }
    group.remove(...group.children);
  }

  updatePredictions(moment) {
    const group = this.layer('predictions');
    this.clear(group);
    const colour = this.replay.prediction_colour;
    const ellipses = [];
    for (const state of moment.tracks) {
      const foot = state.z - state.height / 2;
      for (const {probability, points} of state.paths) {
        const way = [this.onGround(state.x, state.y, foot),
                     ...points.map((p) => this.onGround(p[0], p[1], p.z - state.height / 2))];
        group.add(ribbon(way, 0.09 * this.scale, colour, 0.15 + 0.65 * probability));
        for (const point of points) {
          if (point.horizon % 1 === 0) ellipses.push(...ellipseSegments(point, way[1][2]));
        }
      }
    }
    if (ellipses.length) group.add(segments(ellipses, colour, 0.6));
  }

  /** What the selected track did in the next three seconds. */
  updateFuture(moment, selected) {
    const group = this.layer('future');
    this.clear(group);
    if (selected === null) return;
    const way = this.replay.tracks[selected].states
                    .filter(({time}) => time >= moment.time - 0.05 && time <= moment.time + 3.05)
                    .map(({state: s}) => this.onGround(s.x, s.y, s.z - s.height / 2 + 0.03));
    if (way.length > 1) group.add(ribbon(way, 0.05 * this.scale, this.contrast, 0.95));
  }

  /** Lets points before the robot fade in a view. */
  fadeFor(moment, camera) {
    const [x, y, z] = moment.pose;
    this.fading.robotInView.value.set(x, y, z + this.replay.ground).applyMatrix4(camera.matrixWorldInverse);
    this.fading.aspect.value = camera.aspect || 1;
    this.fading.floorHeight.value = z + this.replay.ground;
  }

  /** Colour of the robot, the truth and the selected track: against the backdrop. */
  setContrast(colour) {
    this.contrast = colour;
    for (const shape of [this.marker, this.frustum, this.truePath]) {
      if (shape) shape.material.color.set(colour);
    }
  }

  updateTruth(moment) {
    this.trueBoxes.remove(...this.trueBoxes.children);
    for (const object of this.replay.truth.objects[moment.at]) {
      const box = new THREE.LineSegments(kUnitEdges, lineMaterial(this.contrast, 0.8));
      placeBox(box, object);
      this.trueBoxes.add(box);
    }
  }

  /** Number of the track at a point of the view, in normalised device coordinates; null: none. */
  pick(point, camera) {
    const ray = new THREE.Raycaster();
    ray.setFromCamera(point, camera);
    const faces = [...this.boxes.values()].filter((box) => box.visible).map((box) => box.faces);
    const hit = ray.intersectObjects(faces)[0];
    return hit ? hit.object.userData.number : null;
  }

  get pointCount() {
    return this.clouds.reduce((sum, cloud) => sum + cloud.total, 0);
  }
}
