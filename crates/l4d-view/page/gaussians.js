// The Gaussians at a moment, and what a view sees of them: the equations of the CPU rasterizer, in 64 bits.

const NUMBERS = { centre: 0, scale: 3, rotation: 6, opacity: 10, harmonics: 11 };
const SH0 = 0.28209479177387814;
const SH1 = 0.4886025119029199;
const SH2 = [1.0925484305920792, -1.0925484305920792, 0.31539156525252005, -1.0925484305920792, 0.5462742152960396];
const SH3 = [
  -0.5900435899266435, 2.890611442640554, -0.4570457994644658, 0.3731763325901154, -0.4570457994644658,
  1.445305721320277, -0.5900435899266435,
];
const ALPHA_MIN = 1 / 255;
const BLUR_PX2 = 0.3;
const FRUSTUM_MARGIN = 1.3;
/** Floats of a Gaussian as a picture sees it: place, half size, shape, opacity, colour, depth. */
const SEEN = 12;

class Gaussians {
  constructor(layout, bytes) {
    this.layout = layout;
    this.count = layout.still + layout.moving;
    const width = layout.ranges.length;
    const steps = new Uint16Array(bytes.buffer, bytes.byteOffset, bytes.byteLength / 2);
    const table = (start, rows) => {
      const values = new Float32Array(rows * width);
      layout.ranges.forEach(([least, largest], column) => {
        const step = (largest - least) / 65535;
        for (let row = 0; row < rows; row++) {
          values[row * width + column] = least + step * steps[start + column * rows + row];
        }
      });
      return values;
    };
    this.width = width;
    const still = table(0, layout.still);
    const moment = (_, place) => table(width * (layout.still + place * layout.moving), layout.moving);
    this.moments = layout.moving ? layout.times.map(moment) : [];
    this.values = new Float32Array(this.count * width);
    this.values.set(still);
    /** Own axes of each Gaussian in world axes, as long as its scales. */
    this.axes = new Float32Array(this.count * 9);
    this.time = undefined;
    this.shape(0, layout.still);
    this.seen = new Float32Array(this.count * SEEN);
    this.ordered = new Float32Array(this.count * SEEN);
    this.keys = new Uint32Array(this.count);
    this.order = new Uint32Array(this.count);
    this.spare = new Uint32Array(this.count);
  }

  /** Makes the Gaussians those of a time, 0 to 1 over the clip. */
  at(time) {
    if (time === this.time || !this.layout.moving) return;
    this.time = time;
    const { times } = this.layout;
    let place = 0;
    while (place < times.length - 2 && times[place + 1] <= time) place++;
    const span = times[place + 1] - times[place];
    const share = clamp((time - times[place]) / span, 0, 1);
    const [before, after] = [this.moments[place], this.moments[place + 1]];
    const start = this.layout.still * this.width;
    for (let at = 0; at < before.length; at++) {
      this.values[start + at] = before[at] + (after[at] - before[at]) * share;
    }
    this.shape(this.layout.still, this.count);
  }

  shape(first, end) {
    const { values, width, axes } = this;
    for (let row = first; row < end; row++) {
      const at = row * width;
      let w = values[at + NUMBERS.rotation];
      let x = values[at + NUMBERS.rotation + 1];
      let y = values[at + NUMBERS.rotation + 2];
      let z = values[at + NUMBERS.rotation + 3];
      const norm = 1 / Math.max(Math.sqrt(w * w + x * x + y * y + z * z), 1e-12);
      w *= norm;
      x *= norm;
      y *= norm;
      z *= norm;
      const s0 = Math.exp(values[at + NUMBERS.scale]);
      const s1 = Math.exp(values[at + NUMBERS.scale + 1]);
      const s2 = Math.exp(values[at + NUMBERS.scale + 2]);
      const out = row * 9;
      axes[out] = s0 * (1 - 2 * (y * y + z * z));
      axes[out + 1] = s0 * 2 * (x * y + w * z);
      axes[out + 2] = s0 * 2 * (x * z - w * y);
      axes[out + 3] = s1 * 2 * (x * y - w * z);
      axes[out + 4] = s1 * (1 - 2 * (x * x + z * z));
      axes[out + 5] = s1 * 2 * (y * z + w * x);
      axes[out + 6] = s2 * 2 * (x * z + w * y);
      axes[out + 7] = s2 * 2 * (y * z - w * x);
      axes[out + 8] = s2 * (1 - 2 * (x * x + y * y));
    }
  }

  /** What a view sees, back to front, in `ordered`; gives how many. */
  project(view, near) {
    const { values, width, axes, seen } = this;
    const [[r0, r1, r2], [r3, r4, r5], [r6, r7, r8]] = view.rotation;
    const [c0, c1, c2] = view.centre;
    const beyondX = ((FRUSTUM_MARGIN - 1) * view.width) / (2 * view.fx);
    const beyondY = ((FRUSTUM_MARGIN - 1) * view.height) / (2 * view.fy);
    const leastX = -view.cx / view.fx - beyondX;
    const mostX = (view.width - view.cx) / view.fx + beyondX;
    const leastY = -view.cy / view.fy - beyondY;
    const mostY = (view.height - view.cy) / view.fy + beyondY;
    let found = 0;
    let [nearest, farthest] = [Infinity, 0];
    for (let row = 0; row < this.count; row++) {
      const at = row * width;
      const opacity = values[at + NUMBERS.opacity];
      if (opacity < ALPHA_MIN) continue;
      const [ox, oy, oz] = [values[at] - c0, values[at + 1] - c1, values[at + 2] - c2];
      const z = r6 * ox + r7 * oy + r8 * oz;
      if (z <= near) continue;
      const x = (r0 * ox + r1 * oy + r2 * oz) / z;
      const y = (r3 * ox + r4 * oy + r5 * oz) / z;
      const slopeX = Math.min(Math.max(x, leastX), mostX);
      const slopeY = Math.min(Math.max(y, leastY), mostY);
      const [scaleX, scaleY] = [view.fx / z, view.fy / z];
      let [xx, xy, yy] = [0, 0, 0];
      let own = row * 9;
      // Rows of the map from own axes to the picture, one own axis after the other.
      const p = PROJECTED;
      for (let axis = 0; axis < 3; axis++, own += 3) {
        const [a, b, c] = [axes[own], axes[own + 1], axes[own + 2]];
        const deep = r6 * a + r7 * b + r8 * c;
        const across = scaleX * (r0 * a + r1 * b + r2 * c - slopeX * deep);
        const down = scaleY * (r3 * a + r4 * b + r5 * c - slopeY * deep);
        xx += across * across;
        xy += across * down;
        yy += down * down;
        p[axis] = across;
        p[axis + 3] = down;
      }
      // Lagrange's identity, as in the reference: no digits are lost where both rows are nearly parallel.
      const m0 = p[1] * p[5] - p[2] * p[4];
      const m1 = p[2] * p[3] - p[0] * p[5];
      const m2 = p[0] * p[4] - p[1] * p[3];
      const determinant = m0 * m0 + m1 * m1 + m2 * m2 + BLUR_PX2 * (xx + yy) + BLUR_PX2 * BLUR_PX2;
      xx += BLUR_PX2;
      yy += BLUR_PX2;
      const column = view.fx * x + view.cx;
      const line = view.fy * y + view.cy;
      // Beyond this many standard deviations alpha is below its least value.
      const reach = Math.sqrt(2 * Math.log(opacity / ALPHA_MIN));
      const [halfX, halfY] = [reach * Math.sqrt(xx), reach * Math.sqrt(yy)];
      if (column + halfX < 0 || column - halfX > view.width || line + halfY < 0 || line - halfY > view.height) {
        continue;
      }
      const out = found * SEEN;
      seen[out] = column;
      seen[out + 1] = line;
      seen[out + 2] = halfX;
      seen[out + 3] = halfY;
      seen[out + 4] = xy / yy;
      seen[out + 5] = yy / determinant;
      seen[out + 6] = 1 / yy;
      seen[out + 7] = opacity;
      this.shade(at + NUMBERS.harmonics, ox, oy, oz, out + 8);
      seen[out + 11] = z;
      nearest = Math.min(nearest, z);
      farthest = Math.max(farthest, z);
      found++;
    }
    this.sort(found, nearest, farthest);
    return found;
  }

  /** The colour of a Gaussian that is seen in a direction. */
  shade(at, ox, oy, oz, out) {
    const { values, seen } = this;
    const count = this.layout.harmonics / 3;
    const norm = 1 / Math.hypot(ox, oy, oz);
    const [x, y, z] = [ox * norm, oy * norm, oz * norm];
    const basis = BASIS;
    basis[0] = SH0;
    if (count > 1) {
      basis[1] = -SH1 * y;
      basis[2] = SH1 * z;
      basis[3] = -SH1 * x;
    }
    if (count > 4) {
      basis[4] = SH2[0] * x * y;
      basis[5] = SH2[1] * y * z;
      basis[6] = SH2[2] * (2 * z * z - x * x - y * y);
      basis[7] = SH2[3] * x * z;
      basis[8] = SH2[4] * (x * x - y * y);
    }
    if (count > 9) {
      const [xx, yy, zz] = [x * x, y * y, z * z];
      basis[9] = SH3[0] * y * (3 * xx - yy);
      basis[10] = SH3[1] * x * y * z;
      basis[11] = SH3[2] * y * (4 * zz - xx - yy);
      basis[12] = SH3[3] * z * (2 * zz - 3 * xx - 3 * yy);
      basis[13] = SH3[4] * x * (4 * zz - xx - yy);
      basis[14] = SH3[5] * z * (xx - yy);
      basis[15] = SH3[6] * x * (xx - 3 * yy);
    }
    let [red, green, blue] = [0.5, 0.5, 0.5];
    for (let k = 0; k < count; k++, at += 3) {
      red += values[at] * basis[k];
      green += values[at + 1] * basis[k];
      blue += values[at + 2] * basis[k];
    }
    seen[out] = Math.max(red, 0);
    seen[out + 1] = Math.max(green, 0);
    seen[out + 2] = Math.max(blue, 0);
  }

  /** Far ones first: two passes over 16-bit halves of a 32-bit key. */
  sort(found, nearest, farthest) {
    const { seen, keys, order, spare, ordered } = this;
    // A little below 32 bits: depths in `seen` are rounded, and a key that overflowed would bring the nearest to the back.
    const steps = 4294000000 / Math.max(farthest - nearest, 1e-9);
    for (let row = 0; row < found; row++) {
      keys[row] = Math.max(farthest - seen[row * SEEN + 11], 0) * steps;
      order[row] = row;
    }
    let [from, to] = [order, spare];
    for (const shift of [0, 16]) {
      COUNTS.fill(0);
      for (let row = 0; row < found; row++) COUNTS[((keys[from[row]] >>> shift) & 65535) + 1]++;
      for (let digit = 1; digit < 65536; digit++) COUNTS[digit] += COUNTS[digit - 1];
      for (let row = 0; row < found; row++) to[COUNTS[(keys[from[row]] >>> shift) & 65535]++] = from[row];
      [from, to] = [to, from];
    }
    for (let row = 0; row < found; row++) {
      const start = from[row] * SEEN;
      for (let k = 0; k < SEEN; k++) ordered[row * SEEN + k] = seen[start + k];
    }
  }

  /** The middle Gaussian, axis by axis. */
  middle() {
    return [0, 1, 2].map((axis) => {
      const list = Array.from({ length: this.count }, (_, row) => this.values[row * this.width + axis]);
      return list.sort((a, b) => a - b)[this.count >> 1] ?? 0;
    });
  }
}

const PROJECTED = new Float64Array(6);
const BASIS = new Float64Array(16);
const COUNTS = new Uint32Array(65537);
