// SPDX-License-Identifier: BSD-3-Clause
// Clouds of points, of which as many are drawn as the computer can draw smoothly.
'use strict';

const kFrameMs = 1000 / 30;  // longest time between two pictures
const kMeasured = 6;         // pictures between two decisions
const kMinDrawn = 8000;      // points
const kFullSharp = 40000, kHalfSharp = 12000;  // capacities from which pictures are sharper

/** How many points are drawn and how sharp: less while pictures take longer than a thirtieth of a
 * second. */
class PointBudget {
  constructor(total) {
    this.total = total;
    this.max = Math.max(total, 2 * kFullSharp);
    this.capacity = Math.min(this.max, 2 * kFullSharp);
    this.times = [];
    this.rate = 0;
  }
  /** Takes the time since the last picture of a moving view [ms]. */
  measure(milliseconds) {
    this.times.push(milliseconds);
    if (this.times.length < kMeasured) return;
    const mean = this.times.reduce((sum, time) => sum + time, 0) / this.times.length;
    this.times = [];
    this.rate = 1000 / mean;
    if (mean > 0.97 * kFrameMs) this.capacity *= Math.max(0.4, 0.85 * kFrameMs / mean);
    else if (mean < 0.75 * kFrameMs) this.capacity *= 1.25;
    this.capacity = Math.min(this.max, Math.max(0.5 * kHalfSharp, this.capacity));
  }
  /** Forgets the pictures before a pause. */
  rest() {
    this.times = [];
  }
  /** Of the points that are drawn, to all. */
  get ratio() {
    return this.total ? Math.min(1, Math.max(kMinDrawn, this.capacity) / this.total) : 1;
  }
  /** Of a picture's pixels along each side, to those of the screen. */
  get sharpness() {
    return this.capacity > kFullSharp ? 1 : this.capacity > kHalfSharp ? 0.75 : 0.5;
  }
}

/** Of the points between the eye and the robot, only a sample is drawn, less the nearer they are to
 * the eye and to the line of sight, so that a wall hides neither robot nor path; floor is drawn. */
const kFading = `
  float depth = mvPosition.z / robotInView.z;
  if (depth < 1.0 && robotInView.z < 0.0 && isPerspective) {
    vec4 middle = projectionMatrix * vec4(robotInView, 1.0);
    vec2 off = (gl_Position.xy / gl_Position.w - middle.xy / middle.w) * vec2(aspect, 1.0);
    float above = (modelMatrix * vec4(position, 1.0)).z - floorHeight;
    float drawn = max(smoothstep(0.6, 1.0, length(off)) * smoothstep(0.3, 0.7, depth),
                      max(smoothstep(0.9, 1.0, depth), 1.0 - smoothstep(0.1, 0.2, above / robotHeight)));
    if (fract(dot(position, vec3(0.1031, 0.1173, 0.0973))) >= drawn) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  }
`;

/** A material of points that fade before the robot: `uniforms` are shared by all clouds. */
function fadingMaterial(size, uniforms) {
  const material = new THREE.PointsMaterial({size, vertexColors: THREE.VertexColors});
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = `uniform vec3 robotInView;\nuniform float aspect, floorHeight, robotHeight;\n` +
        shader.vertexShader.replace('#include <logdepthbuf_vertex>', `${kFading}#include <logdepthbuf_vertex>`);
  };
  return material;
}

/** A cloud of the replay for the scene. Its points are in random order: the first ones are a sample.
 */
function makeCloud(cloud, size, uniforms) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(cloud.positions, 3));
  geometry.setAttribute('color', new THREE.BufferAttribute(cloud.colours, 3, true));
  const points = new THREE.Points(geometry, fadingMaterial(size, uniforms));
  points.frustumCulled = false;
  points.position.set(...cloud.origin);
  points.scale.set(...cloud.step);
  points.total = cloud.count;
  points.metres = size;
  return points;
}

/** Draws a part of a cloud, with larger points the fewer they are. `magnification`: pixels/m from
 * above; in perspective cot(field of view / 2), because THREE sizes points as if that were 1. */
function showPart(points, ratio, magnification, isFromAbove) {
  points.geometry.setDrawRange(0, Math.ceil(ratio * points.total));
  const size = points.metres * Math.min(2.2, Math.sqrt(1 / Math.max(ratio, 1e-3))) * magnification;
  points.material.size = isFromAbove ? Math.max(1, size) : size;
}
