// SPDX-License-Identifier: BSD-3-Clause
// Shapes of the 3D view: ribbons on the ground, boxes, ellipses, the camera's frustum.
'use strict';

const kEllipseSides = 28;

function flatMaterial(colour, opacity = 1) {
  return new THREE.MeshBasicMaterial({color: colour, transparent: opacity < 1, opacity,
                                      side: THREE.DoubleSide, depthWrite: opacity >= 1});
}

const lineMaterial = (colour, opacity = 1) =>
    new THREE.LineBasicMaterial({color: colour, transparent: opacity < 1, opacity});

/** Directions to the left of a path at each of its points, horizontal and of length 1. */
function leftOf(points) {
  let last = [0, 1];
  return points.map((_, i) => {
    const a = points[Math.max(0, i - 1)];
    const b = points[Math.min(points.length - 1, i + 1)];
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
    if (length > 1e-3) last = [-(b[1] - a[1]) / length, (b[0] - a[0]) / length];
    return last;
  });
}

/** Of what lies on the ground, drawn before points that are a little nearer, as noise makes them. */
function groundMaterial(colour, opacity) {
  const material = flatMaterial(colour, opacity);
  return Object.assign(material, {polygonOffset: true, polygonOffsetFactor: 0, polygonOffsetUnits: -800});
}

/** A horizontal band along a path of places [x, y, z]; six indices a step. */
function ribbonGeometry(points, halfWidth) {
  const positions = new Float32Array(6 * points.length);
  const indices = [];
  leftOf(points).forEach(([lx, ly], i) => {
    const [x, y, z] = points[i];
    const half = typeof halfWidth === 'function' ? halfWidth(i) : halfWidth;
    positions.set([x + half * lx, y + half * ly, z, x - half * lx, y - half * ly, z], 6 * i);
    if (i > 0) indices.push(2 * i - 2, 2 * i - 1, 2 * i, 2 * i, 2 * i - 1, 2 * i + 1);
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
  geometry.setIndex(indices);
  return geometry;
}

function ribbon(points, halfWidth, colour, opacity) {
  const mesh = new THREE.Mesh(ribbonGeometry(points, halfWidth), groundMaterial(colour, opacity));
  mesh.frustumCulled = false;
  return mesh;
}

/** Line segments between consecutive pairs of places. */
function segments(places, colour, opacity) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(places.flat()), 3));
  const lines = new THREE.LineSegments(geometry, lineMaterial(colour, opacity));
  lines.frustumCulled = false;
  return lines;
}

/** Ends of the segments of an ellipse at a predicted point. */
function ellipseSegments([x, y, major, minor, angle], z) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const at = (i) => {
    const turn = 2 * Math.PI * i / kEllipseSides;
    const [u, v] = [major * Math.cos(turn), minor * Math.sin(turn)];
    return [x + c * u - s * v, y + s * u + c * v, z];
  };
  return Array.from({length: kEllipseSides}, (_, i) => [at(i), at(i + 1)]).flat();
}

const kUnitBox = new THREE.BoxBufferGeometry(1, 1, 1);
const kUnitEdges = new THREE.EdgesGeometry(kUnitBox);

/** A box of edge length 1 to be scaled: translucent faces, edges, and a mark of its front. */
function makeBox(colour, opacity) {
  const box = new THREE.Group();
  box.faces = new THREE.Mesh(kUnitBox, flatMaterial(colour, opacity));
  box.edges = new THREE.LineSegments(kUnitEdges, lineMaterial(colour));
  box.front = new THREE.Mesh(new THREE.PlaneBufferGeometry(1, 1), flatMaterial(colour, 0.35));
  box.front.rotation.y = Math.PI / 2;
  box.front.position.x = 0.5;
  box.add(box.faces, box.edges, box.front);
  return box;
}

function placeBox(box, {x, y, z, yaw, length, width, height}) {
  box.position.set(x, y, z);
  box.rotation.set(0, 0, yaw);
  box.scale.set(Math.max(0.05, length), Math.max(0.05, width), Math.max(0.05, height));
}

/** Corners of a box in the map. */
function cornersOf({x, y, z, yaw, length, width, height}) {
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  const corners = [];
  for (const u of [-0.5, 0.5]) {
    for (const v of [-0.5, 0.5]) {
      for (const w of [-0.5, 0.5]) {
        const [forward, left] = [u * length, v * width];
        corners.push(new THREE.Vector3(x + c * forward - s * left, y + s * forward + c * left,
                                       z + w * height));
      }
    }
  }
  return corners;
}

function matrixOf([x, y, z, qx, qy, qz, qw]) {
  return new THREE.Matrix4().compose(new THREE.Vector3(x, y, z),
                                     new THREE.Quaternion(qx, qy, qz, qw),
                                     new THREE.Vector3(1, 1, 1));
}

/** Ends of the edges of what a camera sees up to a depth, in its optical frame. */
function frustumSegments(camera, depth) {
  const corner = (u, v) => [depth * (u - camera.cx) / camera.fx, depth * (v - camera.cy) / camera.fy, depth];
  const corners = [corner(0, 0), corner(camera.width, 0), corner(camera.width, camera.height),
                   corner(0, camera.height)];
  return corners.flatMap((place, i) => [[0, 0, 0], place, place, corners[(i + 1) % 4]]);
}
