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

/** A cloud of the replay for the scene. Its points are in random order: the first ones are a sample.
 */
function makeCloud(cloud, size) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(cloud.positions, 3));
  geometry.setAttribute('color', new THREE.BufferAttribute(cloud.colours, 3, true));
  const points = new THREE.Points(geometry,
                                  new THREE.PointsMaterial({size, vertexColors: THREE.VertexColors}));
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
