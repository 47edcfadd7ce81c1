// ---- Drawing ----

/** By number, repeating; all of them light. The number tells objects apart, not the colour. */
const COLOURS = ["#f0e442", "#7cc8f5", "#ff8a3d", "#3ddbaa", "#f0a6cf", "#ffc04d", "#9db4ff"];
const colourOf = (number) => COLOURS[(number - 1) % COLOURS.length];
const canvas = $("picture");
const context = canvas.getContext("2d");
/** What is on the canvas: the picture, pixels of it at the upper left, screen pixels a picture pixel, labels. */
let drawn = null;
let isDrawingAsked = false;

function askForDrawing() {
  if (isDrawingAsked) return;
  isDrawingAsked = true;
  requestAnimationFrame((now) => {
    isDrawingAsked = false;
    draw(now);
  });
}

function draw(now) {
  if (model.mode === "summary" || model.mode === "stopped") return;
  const isReady = drawn?.key === pictureKey();
  if (model.playing !== null && isReady) tick(now);
  const name = item().scene;
  const view = scene().views[model.view];
  const found = pictures.get(name, view, model.frame);
  if (found?.error) {
    model.playing = null;
    complain(found.error);
    showMessage();
  }
  if (found?.image) {
    drawPicture(found);
    drawn.key = pictureKey();
    model.seen.views.add(view);
    model.seen.frames.add(frameNumber());
    pictures.get(name, view, Math.min(model.frame + 1, scene().frames.length - 1));
    describePicture(found);
  } else if (drawn?.key.split(" ")[0] !== item().item) {
    context.clearRect(0, 0, canvas.width, canvas.height);
  }
  if (model.playing !== null && !found?.error) askForDrawing();
}

const pictureKey = () => `${item().item} ${model.view} ${model.frame}`;

function drawPicture(found) {
  const { width, height } = canvas.getBoundingClientRect();
  const ratio = Math.min(window.devicePixelRatio || 1, 3);
  const size = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
  const { x, y, factor } = model.zoom;
  const scale = (width * factor) / found.width;
  const corner = [(x - 0.5 / factor) * found.width, (y - 0.5 / factor) * found.height];
  drawn = { key: "", found, scale, corner, labels: [] };
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  // Small pictures: smooth edges are easier to make out than squares.
  context.imageSmoothingEnabled = true;
  context.imageSmoothingQuality = "high";
  context.drawImage(found.image, ...corner, found.width / factor, found.height / factor, 0, 0, width, height);
  const chosen = new Set(chosenNumbers());
  const order = [...found.objects].sort(([a], [b]) => chosen.has(a) - chosen.has(b) || a - b);
  if (model.outlines) for (const [number, object] of order) drawOutline(object, number, chosen.has(number), ratio);
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  if (model.outlines) drawLabels(order.reverse(), chosen, width, height);
}

/** A light line in a dark one, so that one of them shows on anything. */
function drawOutline({ path }, number, isChosen, ratio) {
  const { scale, corner } = drawn;
  const zoom = scale * ratio;
  context.setTransform(zoom, 0, 0, zoom, -corner[0] * zoom, -corner[1] * zoom);
  context.lineJoin = "round";
  const light = isChosen ? ["#fff", 4] : [colourOf(number), 2];
  for (const [colour, wide] of [["rgb(0 0 0 / 80%)", isChosen ? 7.5 : 4], light]) {
    context.strokeStyle = colour;
    context.lineWidth = wide / scale;
    context.stroke(path);
  }
}

const LABEL = { height: 22, gap: 5 };

/** Numbers, each in a place of its own: in the object if it is large, else beside it. */
function drawLabels(objects, chosen, width, height) {
  context.font = "bold 15px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  for (const [number, object] of objects) {
    const wide = Math.max(LABEL.height, context.measureText(number).width + 12);
    const place = labelPlace(object, wide, width, height);
    if (!place) continue;
    drawn.labels.push({ number, ...place });
    drawLabel(number, place, chosen.has(number));
  }
}

const toScreen = ([x, y]) => [(x - drawn.corner[0]) * drawn.scale, (y - drawn.corner[1]) * drawn.scale];

/** The first place that is in the picture and free; undefined if the object is not on the screen. */
function labelPlace({ middle, box }, wide, width, height) {
  const [left, top] = toScreen([box[0], box[1]]);
  const [right, bottom] = toScreen([box[2] + 1, box[3] + 1]);
  if (right < 0 || bottom < 0 || left > width || top > height) return undefined;
  const anchor = toScreen(middle).map((value, k) => clamp(value, 2, [width, height][k] - 2));
  const { height: tall, gap } = LABEL;
  const [above, below] = [top - gap - tall / 2, bottom + gap + tall / 2];
  const [before, behind] = [left - gap - wide / 2, right + gap + wide / 2];
  const beside = [
    [anchor[0], above], [anchor[0], below], [behind, anchor[1]], [before, anchor[1]],
    [behind, above], [before, above], [behind, below], [before, below],
  ];
  const isLarge = right - left > 2 * wide && bottom - top > 2 * tall;
  const centres = isLarge ? [anchor, ...around(anchor), ...beside] : [...beside, ...around(anchor), anchor];
  const fits = ([x, y]) => x >= wide / 2 && y >= tall / 2 && x <= width - wide / 2 && y <= height - tall / 2;
  const isFree = ([x, y]) => drawn.labels.every((other) =>
    Math.abs(other.x - x) >= (other.wide + wide) / 2 + 1 || Math.abs(other.y - y) >= tall + 1);
  const [x, y] = centres.find((place) => fits(place) && isFree(place)) ?? anchor;
  return { x, y, wide, anchor };
}

/** Places round a point, near ones first. */
function around([x, y]) {
  const angles = [0, 1, 2, 3, 4, 5, 6, 7].map((k) => (k * Math.PI) / 4);
  return [30, 48, 70].flatMap((far) => angles.map((angle) => [x + far * Math.cos(angle), y - far * Math.sin(angle)]));
}

function drawLabel(number, { x, y, wide, anchor }, isChosen) {
  if (Math.hypot(anchor[0] - x, anchor[1] - y) > LABEL.height) {
    for (const [colour, thick] of [["rgb(0 0 0 / 80%)", 4], [isChosen ? "#fff" : colourOf(number), 2]]) {
      context.strokeStyle = colour;
      context.lineWidth = thick;
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(...anchor);
      context.stroke();
    }
  }
  context.beginPath();
  context.roundRect(x - wide / 2, y - LABEL.height / 2, wide, LABEL.height, 5);
  context.fillStyle = isChosen ? "#fff" : "#16171a";
  context.fill();
  context.strokeStyle = isChosen ? "#000" : colourOf(number);
  context.lineWidth = 2;
  context.stroke();
  context.fillStyle = isChosen ? "#000" : "#fff";
  context.fillText(number, x, y + 1);
}

function describePicture({ objects }) {
  const all = Array.from({ length: scene().objects }, (_, k) => k + 1);
  const away = all.filter((number) => !objects.has(number));
  const shown = all.filter((number) => objects.has(number));
  canvas.setAttribute("aria-label", `View ${model.view + 1} of ${scene().views.length}, frame ${frameNumber()}. ` +
    `Objects in this picture: ${shown.join(", ") || "none"}.`);
  const text = away.length ? `Not in this picture: ${away.join(", ")}` : "";
  if ($("hidden-objects").textContent !== text) $("hidden-objects").textContent = text;
  for (const button of $("numbers").children) {
    button.classList.toggle("away", away.includes(Number(button.dataset.number)));
  }
}

/** The object at a place of the canvas: by its label, its pixels, or the nearest pixel a few away. */
function objectAt(x, y) {
  if (!drawn) return 0;
  const label = model.outlines && drawn.labels.find((label) =>
    Math.abs(label.x - x) <= label.wide / 2 && Math.abs(label.y - y) <= LABEL.height / 2);
  if (label) return label.number;
  const { found, scale, corner } = drawn;
  for (const far of [0, 3, 6, 9]) {
    for (const [right, down] of far ? around([0, 0]).slice(0, 8) : [[0, 0]]) {
      const column = Math.floor((x + (right * far) / 30) / scale + corner[0]);
      const row = Math.floor((y + (down * far) / 30) / scale + corner[1]);
      const isInside = column >= 0 && row >= 0 && column < found.width && row < found.height;
      const number = isInside ? found.ids[row * found.width + column] : 0;
      if (number) return number;
    }
  }
  return 0;
}
