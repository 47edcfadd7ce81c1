// What is drawn over the scene: pictures of cameras, masks, boxes, tracks and names.

const at = (list, frame) => list[Math.min(Math.round(frame), list.length - 1)];
const CORNERS = [0, 1, 2, 3, 4, 5, 6, 7].map((place) => [0, 1, 2].map((axis) => ((place >> axis) & 1) - 0.5));
const EDGES = CORNERS.flatMap((_, a) => [1, 2, 4].filter((bit) => !(a & bit)).map((bit) => [a, a | bit]));

class Overlay {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.masks = new Map();
  }

  begin(width, height) {
    const { canvas, context } = this;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const size = [Math.round(width * ratio), Math.round(height * ratio)];
    if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    Object.assign(this, { width, height });
  }

  picture(picture, crisp) {
    this.context.imageSmoothingEnabled = !crisp;
    this.context.drawImage(picture, 0, 0, this.width, this.height);
  }

  /** Fills a mask faintly and outlines it. */
  mask(counts, [width, height], colour, key, line) {
    if (!this.masks.has(key)) {
      const pixels = maskPixels(counts, width, height);
      if (this.masks.size > 400) this.masks.clear();
      this.masks.set(key, { pixels, path: outline(pixels, width, height) });
    }
    const { pixels, path } = this.masks.get(key);
    const { context } = this;
    context.save();
    context.scale(this.width / width, this.height / height);
    context.fillStyle = colour;
    context.globalAlpha = 0.28;
    context.fill(path.filled);
    context.globalAlpha = 1;
    context.strokeStyle = colour;
    context.lineWidth = (line * width) / this.width;
    context.stroke(path.edges);
    context.restore();
    return pixels;
  }

  boxes(view, instances, frame, chosen, { boxes, tracks, names, landmarks }) {
    const { context } = this;
    for (const instance of instances) {
      if (instance.landmark && !landmarks) continue;
      const colour = `rgb(${instance.colour})`;
      const isChosen = chosen.includes(instance.name);
      context.lineWidth = isChosen ? 3 : 1.5;
      context.strokeStyle = colour;
      context.globalAlpha = chosen.length && !isChosen ? 0.5 : 1;
      if (tracks) this.track(view, instance, frame);
      const centre = at(instance.centre, frame);
      const axes = at(instance.axes, frame);
      const extents = at(instance.extents, frame);
      if (boxes) {
        const corners = CORNERS.map((corner) => {
          const own = corner.map((share, axis) => share * extents[axis]);
          return view.toCamera([0, 1, 2].map((row) => centre[row] + dot(axes.slice(row * 3, row * 3 + 3), own)));
        });
        context.beginPath();
        for (const [a, b] of EDGES) this.line(view, corners[a], corners[b]);
        context.stroke();
      }
      context.globalAlpha = 1;
      if (names) this.name(view, instance, centre, colour);
    }
  }

  /** The way of a centre over the clip, and where it is now; nothing of what stands still. */
  track(view, { centre }, frame) {
    const { context } = this;
    if (centre.length < 2 || centre.every((place) => length(subtract(place, centre[0])) < 0.02)) return;
    context.setLineDash([5, 4]);
    context.beginPath();
    const places = centre.map((place) => view.toCamera(place));
    for (let k = 1; k < places.length; k++) this.line(view, places[k - 1], places[k]);
    context.stroke();
    context.setLineDash([]);
    const [x, y, z] = view.toCamera(at(centre, frame));
    if (z < NEAR) return;
    context.fillStyle = context.strokeStyle;
    context.beginPath();
    context.arc(...this.toScreen(view, [x, y, z]), 4, 0, 7);
    context.fill();
  }

  name(view, { name }, centre, colour) {
    const { context } = this;
    const point = view.toCamera(centre);
    if (point[2] < NEAR) return;
    const [x, y] = this.toScreen(view, point);
    context.font = "12px system-ui, sans-serif";
    const wide = context.measureText(name).width;
    context.fillStyle = "rgb(16 16 20 / 75%)";
    context.fillRect(x - wide / 2 - 4, y - 9, wide + 8, 18);
    context.fillStyle = "#fff";
    context.fillText(name, x - wide / 2, y + 4);
    context.fillStyle = colour;
    context.fillRect(x - wide / 2 - 4, y + 8, wide + 8, 2);
  }

  toScreen(view, point) {
    const [x, y] = view.toPicture(point);
    return [(x * this.width) / view.width, (y * this.height) / view.height];
  }

  /** A line between points in camera axes, cut where it passes the camera. */
  line(view, a, b) {
    if (a[2] < NEAR && b[2] < NEAR) return;
    const cut = (near, far) => add(near, subtract(far, near), (NEAR - near[2]) / (far[2] - near[2]));
    this.context.moveTo(...this.toScreen(view, a[2] < NEAR ? cut(a, b) : a));
    this.context.lineTo(...this.toScreen(view, b[2] < NEAR ? cut(b, a) : b));
  }
}

const NEAR = 0.02;

/** The pixels of a mask as runs, and the sides of pixels that have the outside beyond them. */
function outline(pixels, width, height) {
  const [filled, edges] = [new Path2D(), new Path2D()];
  const inside = (x, y) => x >= 0 && y >= 0 && x < width && y < height && pixels[y * width + x] === 1;
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      if (!inside(x, y)) continue;
      let end = x;
      while (inside(end, y)) end++;
      filled.rect(x, y, end - x, 1);
      x = end;
    }
  }
  for (let y = 0; y <= height; y++) {
    for (let x = 0; x <= width; x++) {
      const here = inside(x, y);
      if (here !== inside(x, y - 1)) {
        edges.moveTo(x, y);
        edges.lineTo(x + 1, y);
      }
      if (here !== inside(x - 1, y)) {
        edges.moveTo(x, y);
        edges.lineTo(x, y + 1);
      }
    }
  }
  return { filled, edges };
}
