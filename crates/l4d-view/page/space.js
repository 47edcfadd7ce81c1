"use strict";
// Vectors, poses and cameras. World: right-handed, +Z up, metres. Cameras: x right, y down, z forward; pixel (column,
// row) has its centre at (column + 0.5, row + 0.5).

const add = (a, b, factor = 1) => [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]];
const subtract = (a, b) => add(a, b, -1);
const scaled = (a, factor) => [a[0] * factor, a[1] * factor, a[2] * factor];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a) => Math.hypot(a[0], a[1], a[2]);
const unit = (a) => scaled(a, 1 / Math.max(length(a), 1e-12));
const clamp = (value, least, most) => Math.min(Math.max(value, least), most);

/** What is drawn from: rows of the rotation from world to camera axes, the centre, and the lens in pixels. */
class View {
  constructor(rotation, centre, [fx, fy, cx, cy], [width, height]) {
    Object.assign(this, { rotation, centre, fx, fy, cx, cy, width, height });
  }

  /** The view of a camera whose lens belongs to pictures of `size`, for a picture of `wanted` pixels. */
  static ofCamera(camera, frame, size, wanted) {
    const m = camera.poses[Math.min(frame, camera.poses.length - 1)];
    const rotation = [[m[0], m[4], m[8]], [m[1], m[5], m[9]], [m[2], m[6], m[10]]];
    return new View(rotation, [m[3], m[7], m[11]], View.lens(camera.lens, size, wanted), wanted);
  }

  static lens([fx, fy, cx, cy], size, wanted) {
    const [across, down] = [wanted[0] / size[0], wanted[1] / size[1]];
    return [fx * across, fy * down, cx * across, cy * down];
  }

  toCamera(point) {
    const offset = subtract(point, this.centre);
    return this.rotation.map((row) => dot(row, offset));
  }

  /** Where a point in camera axes is in the picture, pixels from its upper left corner. */
  toPicture([x, y, z]) {
    return [(this.fx * x) / z + this.cx, (this.fy * y) / z + this.cy];
  }
}

/** A view that turns about a point. */
class Orbit {
  constructor(target, yaw, pitch, distance) {
    Object.assign(this, { target, yaw, pitch, distance });
  }

  /** From where a camera is, about a point on its axis `distance` metres ahead; its roll is lost. */
  static from(view, distance) {
    const ahead = view.rotation[2];
    const pitch = Math.asin(clamp(-ahead[2], -1, 1));
    return new Orbit(add(view.centre, ahead, distance), Math.atan2(-ahead[1], -ahead[0]), pitch, distance);
  }

  copy() {
    return new Orbit([...this.target], this.yaw, this.pitch, this.distance);
  }

  turn(right, up) {
    this.yaw -= right;
    this.pitch = clamp(this.pitch + up, -1.5, 1.5);
  }

  zoom(factor) {
    this.distance = clamp(this.distance * factor, 0.05, 500);
  }

  /** Moves the point that is looked at by shares of the distance. */
  move(right, down) {
    const [x, y] = this.axes();
    this.target = add(add(this.target, x, -right * this.distance), y, -down * this.distance);
  }

  axes() {
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    const ahead = [-cy * cp, -sy * cp, -sp];
    const right = unit(cross(ahead, [0, 0, 1]));
    return [right, cross(ahead, right), ahead];
  }

  view(lens, size) {
    const axes = this.axes();
    return new View(axes, add(this.target, axes[2], -this.distance), lens, size);
  }
}
