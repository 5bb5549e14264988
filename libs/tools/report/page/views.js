// SPDX-License-Identifier: BSD-3-Clause
// The views and how they are moved: by mouse, touch and keys.
'use strict';

const kUp = new THREE.Vector3(0, 0, 1);
const kNear = 0.1, kFar = 2000;
const kFieldOfView = 55, kUprightFieldOfView = 75;  // of a wide and of a high window [deg]
const kOverview = 30;  // radius of a path that is shown whole at first; the robot's mark then has 20 pixels or more [m]

/** The viewpoint: behind the robot, free, from above, or the robot's camera. */
class Views {
  constructor(replay, world) {
    this.replay = replay;
    this.world = world;
    this.perspective = new THREE.PerspectiveCamera(kFieldOfView, 1, kNear, kFar);
    this.perspective.up.copy(kUp);
    this.orthographic = new THREE.OrthographicCamera(-1, 1, 1, -1, kNear, kFar);
    this.reset();
    this.start(1, 1);
  }

  reset() {
    const {scale} = this.world;
    this.follow = {turn: 0, elevation: 0.36, distance: 17 * scale};
    this.orbit = {turn: 2.4, elevation: 0.6, distance: 34 * scale, target: null};
    this.top = {metres: 60 * scale, dx: 0, dy: 0};
  }

  /** The view that the page begins with: the whole path from behind its start, or behind the robot
   * if the path is so long that the robot would hardly be seen. */
  start(width, height) {
    const places = this.replay.frames.map(({pose: [x, y, z]}) => new THREE.Vector3(x, y, z));
    const ball = new THREE.Box3().setFromPoints(places).getBoundingSphere(new THREE.Sphere());
    const {scale} = this.world;
    this.isStart = true;
    this.name = ball.radius > kOverview * scale ? 'follow' : 'orbit';
    const half = Math.atan(Math.min(1, width / height) * Math.tan(this.fieldOfView(width, height) * Math.PI / 360));
    this.orbit = {turn: yawOf(this.replay.frames[0].pose) + Math.PI, elevation: 0.8, target: ball.center,
                  distance: (ball.radius + 4 * scale) / Math.sin(half)};
  }

  fieldOfView(width, height) {
    return width < height ? kUprightFieldOfView : kFieldOfView;
  }

  set(name, moment) {
    if (this.isStart && this.name === 'orbit') this.reset();  // leaves the view of the whole path
    this.isStart = false;
    this.name = name === 'camera' && !this.replay.camera ? 'follow' : name;
    if (this.name === 'orbit') this.orbit.target = new THREE.Vector3(...moment.pose.slice(0, 3));
  }

  get camera() {
    return this.name === 'top' ? this.orthographic : this.perspective;
  }

  /** Sets the camera of the view for a canvas of a size [CSS pixels]. */
  update(moment, width, height) {
    if (this.name === 'top') this.updateTop(moment, width, height);
    else if (this.name === 'camera') this.updateCamera(moment, width, height);
    else this.updateOrbit(moment, width, height);
    this.camera.updateMatrixWorld();
  }

  updateOrbit(moment, width, height) {
    const {scale} = this.world;
    const yaw = yawOf(moment.pose);
    const robot = new THREE.Vector3(...moment.pose);
    const free = this.name === 'orbit';
    const {turn, elevation, distance, target} = free ? this.orbit : this.follow;
    const ahead = 8 * scale;
    const centre = free ? target : robot.clone().add(
        new THREE.Vector3(ahead * Math.cos(yaw), ahead * Math.sin(yaw), this.replay.ground));
    const angle = free ? turn : yaw + Math.PI + turn;
    const flat = distance * Math.cos(elevation);
    this.perspective.position.set(centre.x + flat * Math.cos(angle), centre.y + flat * Math.sin(angle),
                                  centre.z + distance * Math.sin(elevation));
    this.perspective.fov = this.fieldOfView(width, height);
    this.perspective.aspect = width / height;
    this.perspective.lookAt(centre);
    this.perspective.updateProjectionMatrix();
  }

  /** View from above, with the map's x axis upwards, as drawTopView() takes it. */
  topView(moment, width, height) {
    const zoom = Math.min(width, height) / this.top.metres;
    return {x: moment.pose[0] + this.top.dx, y: moment.pose[1] + this.top.dy, yaw: 0, zoom,
            left: width / 2, top: height / 2};
  }

  updateTop(moment, width, height) {
    const {x, y, zoom} = this.topView(moment, width, height);
    const camera = this.orthographic;
    [camera.left, camera.right] = [-width / 2 / zoom, width / 2 / zoom];
    [camera.bottom, camera.top] = [-height / 2 / zoom, height / 2 / zoom];
    camera.position.set(x, y, moment.pose[2] + 500);
    camera.up.set(1, 0, 0);
    camera.lookAt(x, y, moment.pose[2]);
    camera.updateProjectionMatrix();
  }

  /** Pixels per pixel of the camera's image, and where its corner is on the canvas. */
  imageFrame(width, height) {
    const {camera} = this.replay;
    const zoom = Math.min(width / camera.width, height / camera.height);
    return {zoom, left: (width - zoom * camera.width) / 2, top: (height - zoom * camera.height) / 2};
  }

  updateCamera(moment, width, height) {
    const {camera} = this.replay;
    const {zoom, left, top} = this.imageFrame(width, height);
    const toMap = matrixOf(moment.pose).multiply(matrixOf(camera.pose))
                      .multiply(new THREE.Matrix4().makeRotationX(Math.PI));
    toMap.decompose(this.perspective.position, this.perspective.quaternion, this.perspective.scale);
    const u = left + zoom * (camera.cx + 0.5), v = top + zoom * (camera.cy + 0.5);
    const [x, y] = [kNear / (zoom * camera.fx), kNear / (zoom * camera.fy)];
    this.perspective.projectionMatrix.makePerspective(-u * x, (width - u) * x, v * y,
                                                      -(height - v) * y, kNear, kFar);
    this.perspective.projectionMatrixInverse.getInverse(this.perspective.projectionMatrix);
  }

  /** Turns the view, or moves that from above, by a drag [CSS pixels]. */
  drag(dx, dy, width, height) {
    if (this.name === 'top') {
      const zoom = Math.min(width, height) / this.top.metres;
      this.top.dx += dy / zoom;
      this.top.dy += dx / zoom;
    } else if (this.name !== 'camera') {
      const state = this[this.name];
      state.turn -= 0.006 * dx;
      state.elevation = Math.min(1.5, Math.max(0.03, state.elevation + 0.006 * dy));
    }
  }

  /** Moves the centre of the free view, which a drag in the follow view begins. */
  pan(dx, dy, moment, height) {
    if (this.name === 'top' || this.name === 'camera') return;
    if (this.name === 'follow') {
      this.orbit = {...this.follow, turn: yawOf(moment.pose) + Math.PI + this.follow.turn, target: null};
      this.set('orbit', moment);
    }
    const metres = 1.1 * this.orbit.distance / height;
    const {turn, target} = this.orbit;
    target.x += metres * (Math.sin(turn) * dx - Math.cos(turn) * dy);
    target.y += metres * (-Math.cos(turn) * dx - Math.sin(turn) * dy);
  }

  zoom(factor) {
    const {scale} = this.world;
    const limited = (value, low, high) => Math.min(high, Math.max(low, value * factor));
    if (this.name === 'top') this.top.metres = limited(this.top.metres, 4 * scale, 2000);
    else if (this.name !== 'camera') this[this.name].distance = limited(this[this.name].distance, 2 * scale, 800);
  }
}

/** Calls back for drags, pinches, wheel and clicks on an element. */
function listenToGestures(element, {drag, pan, zoom, click}) {
  const pointers = new Map();
  let moved = 0;
  element.addEventListener('pointerdown', (event) => {
    element.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, event);
    if (pointers.size === 1) moved = 0;
  });
  element.addEventListener('pointermove', (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const [dx, dy] = [event.clientX - before.clientX, event.clientY - before.clientY];
    const others = [...pointers.values()].filter(({pointerId}) => pointerId !== event.pointerId);
    pointers.set(event.pointerId, event);
    moved += Math.abs(dx) + Math.abs(dy);
    if (others.length === 1) {
      const distance = (a) => Math.hypot(a.clientX - others[0].clientX, a.clientY - others[0].clientY);
      zoom(distance(before) / Math.max(1, distance(event)));
      pan(dx / 2, dy / 2);
    } else if (others.length === 0) {
      if (event.buttons === 2 || event.shiftKey) pan(dx, dy);
      else drag(dx, dy);
    }
  });
  const end = (event) => {
    if (pointers.delete(event.pointerId) && event.type === 'pointerup' && moved < 5) click(event);
  };
  element.addEventListener('pointerup', end);
  element.addEventListener('pointercancel', end);
  element.addEventListener('contextmenu', (event) => event.preventDefault());
  element.addEventListener('wheel', (event) => {
    event.preventDefault();
    zoom(Math.exp(event.deltaY / 600));
  }, {passive: false});
}
