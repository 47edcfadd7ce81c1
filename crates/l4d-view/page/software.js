// Draws Gaussians without graphics hardware, as the CPU rasterizer does: tiles of 16 pixels, near ones first, a pixel is
// finished when too little light is left to change a byte. Much faster than WebGL where that is emulated.

const TILE = 16;
const TRANSMITTANCE_MIN = 2e-3;
/** exp(-x / EXP_STEPS) for whole x up to where alpha ends. */
const EXP_STEPS = 1024;
const EXP = Float32Array.from({ length: 8 * EXP_STEPS }, (_, step) => Math.exp(-(step + 0.5) / EXP_STEPS));

class Software {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d", { alpha: false });
    this.colours = new Float32Array(3 * TILE * TILE);
    this.left = new Float32Array(TILE * TILE);
  }

  draw(gaussians, view, { background, near, depthRange }) {
    const { width, height } = view;
    if (this.canvas.width !== width || this.canvas.height !== height || !this.image) {
      [this.canvas.width, this.canvas.height] = [width, height];
      this.image = this.context.createImageData(width, height);
    }
    const found = gaussians.project(view, near);
    const { ordered } = gaussians;
    const columns = Math.ceil(width / TILE);
    const rows = Math.ceil(height / TILE);
    const { starts, list } = this.bin(ordered, found, columns, rows);
    for (let row = 0; row < rows; row++) {
      for (let column = 0; column < columns; column++) {
        const tile = row * columns + column;
        const [right, bottom] = [Math.min((column + 1) * TILE, width), Math.min((row + 1) * TILE, height)];
        const size = [column * TILE, row * TILE, right, bottom];
        this.blend(ordered, list, starts[tile], starts[tile + 1], size, depthRange !== undefined);
        this.put(size, background, depthRange);
      }
    }
    this.context.putImageData(this.image, 0, 0);
  }

  /** Which Gaussians are in which tile, near ones first. */
  bin(ordered, found, columns, rows) {
    const range = (middle, half, count) => [
      clamp(Math.floor((middle - half) / TILE), 0, count),
      clamp(Math.floor((middle + half) / TILE) + 1, 0, count),
    ];
    const starts = new Uint32Array(columns * rows + 1);
    const spans = new Uint16Array(4 * found);
    for (let index = 0; index < found; index++) {
      const from = index * SEEN;
      const [x0, x1] = range(ordered[from], ordered[from + 2], columns);
      const [y0, y1] = range(ordered[from + 1], ordered[from + 3], rows);
      spans[4 * index] = x0;
      spans[4 * index + 1] = x1;
      spans[4 * index + 2] = y0;
      spans[4 * index + 3] = y1;
      for (let y = y0; y < y1; y++) for (let x = x0; x < x1; x++) starts[y * columns + x + 1]++;
    }
    for (let tile = 1; tile < starts.length; tile++) starts[tile] += starts[tile - 1];
    const list = new Uint32Array(starts[columns * rows]);
    const next = starts.slice();
    for (let index = found - 1; index >= 0; index--) {
      const [x0, x1, y0, y1] = [spans[4 * index], spans[4 * index + 1], spans[4 * index + 2], spans[4 * index + 3]];
      for (let y = y0; y < y1; y++) for (let x = x0; x < x1; x++) list[next[y * columns + x]++] = index * SEEN;
    }
    return { starts, list };
  }

  blend(ordered, list, start, end, [x0, y0, x1, y1], isDepth) {
    const { colours, left } = this;
    colours.fill(0);
    left.fill(1);
    let open = (x1 - x0) * (y1 - y0);
    for (let place = start; place < end && open > 0; place++) {
      const at = list[place];
      const column = ordered[at];
      const line = ordered[at + 1];
      const shear = ordered[at + 4];
      const along = 0.5 * ordered[at + 5];
      const down = 0.5 * ordered[at + 6];
      const opacity = ordered[at + 7];
      const red = isDepth ? 1 / ordered[at + 11] : ordered[at + 8];
      const green = isDepth ? 0 : ordered[at + 9];
      const blue = isDepth ? 0 : ordered[at + 10];
      const reach = Math.log(opacity * 255);
      const top = Math.max(Math.ceil(line - ordered[at + 3] - 0.5), y0);
      const bottom = Math.min(Math.floor(line + ordered[at + 3] - 0.5), y1 - 1);
      for (let y = top; y <= bottom; y++) {
        const dy = line - y - 0.5;
        const rest = reach - dy * dy * down;
        if (rest < 0) continue;
        // The pixels of this row in which alpha is not below its least value.
        const middle = column - shear * dy - 0.5;
        const half = Math.sqrt(rest / along);
        const first = Math.max(Math.ceil(middle - half), x0);
        const last = Math.min(Math.floor(middle + half), x1 - 1);
        const fixed = dy * dy * down;
        let pixel = (y - y0) * TILE + first - x0;
        for (let x = first; x <= last; x++, pixel++) {
          const before = left[pixel];
          if (before === 0) continue;
          const d = middle - x;
          let alpha = opacity * EXP[((d * d * along + fixed) * EXP_STEPS) | 0];
          if (alpha > 0.99) alpha = 0.99;
          const weight = alpha * before;
          colours[3 * pixel] += weight * red;
          colours[3 * pixel + 1] += weight * green;
          colours[3 * pixel + 2] += weight * blue;
          let after = before - weight;
          if (after < TRANSMITTANCE_MIN) {
            after = 0;
            open--;
          }
          left[pixel] = after;
        }
      }
    }
  }

  put([x0, y0, x1, y1], background, depthRange) {
    const { colours, left, image } = this;
    const { data, width } = image;
    for (let y = y0; y < y1; y++) {
      for (let x = x0; x < x1; x++) {
        const pixel = (y - y0) * TILE + x - x0;
        const at = 4 * (y * width + x);
        const through = left[pixel];
        if (depthRange) {
          const shown = depthColour((1 - through) / Math.max(colours[3 * pixel], 1e-6), depthRange);
          for (let k = 0; k < 3; k++) data[at + k] = shown[k] * (1 - through) + 18 * through;
        } else {
          for (let k = 0; k < 3; k++) data[at + k] = 255 * (colours[3 * pixel + k] + through * background[k]);
        }
        data[at + 3] = 255;
      }
    }
  }
}

/** The colour of a depth between both ends of the ramp. */
function depthColour(depth, [near, far]) {
  const place = 4 * clamp(Math.log(Math.max(depth, 1e-6) / near) / Math.log(far / near), 0, 1);
  const left = Math.min(Math.floor(place), 3);
  return RAMP[left].map((value, k) => value + (RAMP[left + 1][k] - value) * (place - left));
}

/** WebGL where it is hardware's, else the processor. */
function bestDrawing(canvas) {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return new Software(canvas);
  const about = gl.getExtension("WEBGL_debug_renderer_info");
  const renderer = gl.getParameter(about ? about.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  if (/swiftshader|llvmpipe|software|basic render/i.test(renderer)) return new Software(canvas);
  return new Drawing(canvas);
}
