// The page: what is chosen, what it makes of that, and every way to choose.

const $ = (id) => document.getElementById(id);

/** An element with properties and children. */
function element(kind, properties = {}, ...children) {
  const made = Object.assign(document.createElement(kind), properties);
  made.append(...children);
  return made;
}

const LAYERS = [
  { key: "gaussians", title: "Gaussians", hint: "" },
  { key: "gaussian-depth", title: "Their depth", hint: "Depth of the Gaussians: yellow is near, violet is far." },
  { key: "picture", title: "Picture", kind: 0, hint: "What the camera saw." },
  { key: "depth", title: "Depth", kind: 1, hint: "" },
  { key: "ids", title: "Ids", kind: 2, hint: "What each pixel belongs to: colours are objects, greys are landmarks." },
];
const CHECKS = [
  { key: "boxes", title: "Boxes", letter: "b", of: "instances" },
  { key: "tracks", title: "Tracks", letter: "t", of: "instances" },
  { key: "names", title: "Names", letter: "n", of: "instances" },
  { key: "landmarks", title: "Landmarks too", letter: "l", of: "instances" },
  { key: "masks", title: "Masks", letter: "m", of: "sentences" },
];
const FREE = "";
/** Longest side of what is drawn, pixels. */
const LONGEST_SIDE = 1600;
/** Shares of the full size at which moving pictures are drawn, where a machine is slow. */
const SHARES = [1, 0.7, 0.5, 0.35, 0.25];

const [FIRST, LAST] = DOCUMENT.clip;
const CAMERAS = new Map(DOCUMENT.cameras.map((camera) => [camera.name, camera]));
const HELD_OUT = DOCUMENT.masks?.[0] ?? DOCUMENT.cameras.find((camera) => camera.held_out)?.name;
const START = CAMERAS.get(HELD_OUT) ?? DOCUMENT.cameras[0];

const state = {
  frame: FIRST,
  playing: false,
  speed: 1,
  camera: FREE,
  layer: "gaussians",
  sentence: null,
  truth: true,
  methods: DOCUMENT.methods.map(() => true),
  boxes: false,
  tracks: false,
  names: false,
  landmarks: false,
  masks: true,
  orbit: null,
};

const gaussians = new Gaussians(DOCUMENT.gaussians, blockBytes("gaussians"));
const pictures = DOCUMENT.pictures && new Pictures(DOCUMENT.pictures, () => ask({ strip: true }));
const overlay = new Overlay($("overlay"));
const drawing = bestDrawing($("gaussians"));

/** Where the free view begins: at the held-out camera, turning about the middle of the things. */
function firstOrbit() {
  const objects = DOCUMENT.instances.filter((instance) => !instance.landmark);
  const sum = objects.reduce((sum, { centre }) => add(sum, centre[0], 1 / objects.length), [0, 0, 0]);
  const middle = objects.length ? sum : gaussians.middle();
  const view = View.ofCamera(START, FIRST, DOCUMENT.size, DOCUMENT.size);
  return Orbit.from(view, Math.max(dot(subtract(middle, view.centre), view.rotation[2]), 0.3));
}

const timeOf = (frame) => (frame - FIRST) / Math.max(LAST - FIRST, 1);
const canShow = (layer) => layer.kind === undefined || (pictures && state.camera !== FREE);

/** The view of now, for a picture of these pixels. */
function viewOf(size) {
  if (state.camera === FREE) return state.orbit.view(View.lens(START.lens, DOCUMENT.size, size), size);
  return View.ofCamera(CAMERAS.get(state.camera), Math.round(state.frame), DOCUMENT.size, size);
}

// ---- Drawing ----

const pace = { place: 0, slow: 0, quick: 0, shown: 0 };
let wanted = null;

/** Asks for a picture; `all` also brings the controls up to date, `strip` the small pictures. */
function ask(what = {}) {
  if (!wanted) requestAnimationFrame(render);
  wanted = { ...wanted, ...what };
}

function render(now) {
  const what = wanted;
  wanted = null;
  if (state.playing) advance(now);
  const size = $("frame").getBoundingClientRect();
  const start = performance.now();
  const isMoving = state.playing || dragging.size > 0;
  drawScene(size, isMoving ? SHARES[pace.place] : 1);
  if (isMoving) keepPace(performance.now() - start, now);
  drawOverlay(size);
  showTime();
  if (what?.all) showControls();
  if (what?.all || what?.strip || (state.playing && pictures && now - pace.strip > 250)) drawStrip(now);
  if (state.playing) ask();
}

/** Smaller pictures where time runs out, larger ones where there is plenty. */
function keepPace(spent, now) {
  const between = now - pace.shown;
  pace.shown = now;
  // WebGL returns before it has drawn: there, the time between pictures says how long they take.
  const isHardware = drawing instanceof Drawing;
  const isSlow = spent > 28 || (isHardware && between > 34 && between < 500);
  const isQuick = spent < 9 && (between < 20 || !isHardware);
  pace.slow = isSlow ? pace.slow + 1 : 0;
  pace.quick = isQuick ? pace.quick + 1 : 0;
  if (pace.slow > 2 && pace.place < SHARES.length - 1) Object.assign(pace, { place: pace.place + 1, slow: 0 });
  if (pace.quick > 60 && pace.place > 0) Object.assign(pace, { place: pace.place - 1, quick: 0 });
}

function drawScene({ width, height }, share) {
  const layer = LAYERS.find((layer) => layer.key === state.layer);
  if (layer.kind !== undefined || width === 0) return;
  const ratio = Math.min(window.devicePixelRatio || 1, LONGEST_SIDE / Math.max(width, height)) * share;
  gaussians.at(timeOf(state.frame));
  drawing.draw(gaussians, viewOf([Math.max(Math.round(width * ratio), 1), Math.max(Math.round(height * ratio), 1)]), {
    background: DOCUMENT.background,
    near: DOCUMENT.near_m,
    depthRange: state.layer === "gaussian-depth" ? depthRange() : undefined,
  });
}

function depthRange() {
  if (pictures && state.camera !== FREE) return pictures.about.depth_range_m;
  const distance = state.camera === FREE ? state.orbit.distance : state.start.distance;
  return [distance * 0.3, distance * 3];
}

const sentenceOf = () => DOCUMENT.sentences.find((sentence) => sentence.number === state.sentence);
const colourOf = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();

/** The frame whose masks are nearest to now. */
function maskFrame(sentence) {
  const frames = Object.keys(sentence.truth ?? sentence.answers.find(Boolean) ?? {}).map(Number);
  return frames.length ? frames[nearestPlace(frames, state.frame)] : undefined;
}

function drawOverlay({ width, height }) {
  overlay.begin(width, height);
  const notes = [];
  const layer = LAYERS.find((layer) => layer.key === state.layer);
  if (layer.kind !== undefined && pictures) {
    const near = pictures.frameNear(state.frame);
    const picture = pictures.get(state.camera, state.frame, layer.kind) ?? state.last;
    if (picture) overlay.picture(picture, layer.kind === 2);
    state.last = picture;
    if (near !== Math.round(state.frame)) notes.push(`picture of frame ${near}`);
  }
  const sentence = sentenceOf();
  const chosen = sentence?.referents ?? [];
  overlay.boxes(viewOf([width, height]), DOCUMENT.instances, state.frame, chosen, state);
  if (sentence && state.masks) notes.push(...drawMasks(sentence));
  $("where").textContent = notes.join(" · ");
}

/** Masks of a sentence, where the held-out camera looks; notes about them. */
function drawMasks(sentence) {
  if (!DOCUMENT.masks) return ["no truth for masks is at hand"];
  const [camera, size] = DOCUMENT.masks;
  const frame = maskFrame(sentence);
  const key = frameKey(frame ?? 0);
  const lists = [sentence.truth, ...sentence.answers];
  const empty = new Uint8Array(size[0] * size[1]);
  const found = lists.map((masks, place) => {
    const name = place === 0 ? "truth" : `method-${place - 1}`;
    const isShown = place === 0 ? state.truth : state.methods[place - 1];
    const counts = masks?.[key];
    if (!counts) return masks && key in masks ? empty : undefined;
    const id = `${sentence.number} ${key} ${name}`;
    if (!isShown || state.camera !== camera) return overlay.masks.get(id)?.pixels ?? maskPixels(counts, ...size);
    return overlay.mask(counts, size, colourOf(name), id, place === 0 ? 5 : 2);
  });
  showOverlaps(found, frame);
  if (state.camera !== camera) return [`masks are drawn in camera ${camera}`];
  return frame !== undefined && frame !== Math.round(state.frame) ? [`masks of frame ${frame}`] : [];
}

/** What each answer has in common with the truth at the frame of the masks. */
function showOverlaps([truth, ...answers], frame) {
  answers.forEach((answer, place) => {
    const output = document.querySelector(`#methods [data-method="${place}"] output`);
    let text = answer && !truth ? "" : "no answer";
    if (answer && truth) {
      const share = overlap(answer, truth);
      text = share === undefined ? `rightly nothing at ${frame}` : `IoU ${(100 * share).toFixed(0)} % at ${frame}`;
    }
    if (output.textContent !== text) output.textContent = text;
  });
}

// ---- Time ----

let clock = null;

function advance(now) {
  const passed = clock === null ? 0 : Math.min((now - clock) / 1000, 0.25);
  clock = now;
  const length = Math.max(LAST - FIRST, 1);
  state.frame = FIRST + ((state.frame - FIRST + passed * DOCUMENT.frames_per_second * state.speed) % length);
}

function play(on = !state.playing) {
  state.playing = on;
  clock = null;
  if (!on) state.frame = Math.round(state.frame);
  ask({ all: true });
}

function go(frame) {
  state.playing = false;
  state.frame = clamp(Math.round(frame), FIRST, LAST);
  ask({ all: true });
}

/** To the next frame that is more than numbers: one with pictures or masks. */
function step(forward) {
  const { frames } = DOCUMENT;
  const next = forward ? frames.find((frame) => frame > state.frame) : frames.findLast((frame) => frame < state.frame);
  go(next ?? (forward ? LAST : FIRST));
}

function showTime() {
  const frame = Math.round(state.frame);
  const seconds = (frame - FIRST) / DOCUMENT.frames_per_second;
  const text = `frame ${frame} of ${LAST} · ${seconds.toFixed(2)} s`;
  if ($("time").textContent !== text) $("time").textContent = text;
  if (Number($("slider").value) !== frame) $("slider").value = frame;
  const place = `${100 * timeOf(state.frame)}%`;
  for (const mark of document.querySelectorAll("#rows b")) mark.style.left = place;
  for (const lane of document.querySelectorAll("#rows .lane.event")) {
    lane.classList.toggle("now", lane.spans.some(([first, last]) => first <= frame && frame <= last));
  }
}

/** A row under the slider; `spans` are [first, last, title]. */
/** A scroll bar beside the bars takes room that the slider above them must leave too. */
function fitSlider() {
  const gutter = $("rows").offsetWidth - $("rows").clientWidth;
  $("timeline").style.setProperty("--gutter", `${gutter}px`);
}

function lane(label, spans, kind) {
  const bar = element("div");
  for (const [first, last, title] of spans) {
    const mark = element("i", { title: title ?? `${label}: frames ${first} to ${last}` });
    const share = (frame) => (100 * (frame - FIRST)) / Math.max(LAST - FIRST, 1);
    mark.style.left = `${share(first)}%`;
    mark.style.width = `${Math.max(share(last) - share(first), 0.6)}%`;
    mark.addEventListener("click", () => go(first));
    bar.append(mark);
  }
  bar.append(element("b"));
  const row = element("div", { className: `lane ${kind}` }, element("span", { textContent: label, title: label }), bar);
  row.spans = spans;
  return row;
}

/** Frames at which there is a mask, as spans of neighbouring sampled frames. */
function spansOf(masks) {
  const frames = Object.keys(masks ?? {}).map(Number);
  const spans = [];
  frames.forEach((frame, place) => {
    if (masks[frameKey(frame)] === null) return;
    const last = spans.at(-1);
    if (last && last[1] === frames[place - 1]) last[1] = frame;
    else spans.push([frame, frame]);
  });
  return spans;
}

function showRows() {
  const rows = [];
  const sentence = sentenceOf();
  if (sentence) {
    const holds = sentence.frames.map(([first, last]) => [Math.max(first, FIRST), Math.min(last, LAST)]);
    if (holds.length) rows.push(lane("holds", holds, "now"));
    if (sentence.truth) rows.push(lane("truth", spansOf(sentence.truth), "truth"));
    sentence.answers.forEach((masks, place) => {
      rows.push(lane(DOCUMENT.methods[place], spansOf(masks), `method-${place}`));
    });
  }
  const events = new Map();
  for (const { subject, verb, object, frames } of DOCUMENT.events) {
    const label = `${subject} ${verb}${object ? " " + object : ""}`;
    events.set(label, [...(events.get(label) ?? []), frames]);
  }
  for (const [label, spans] of events) rows.push(lane(label, spans, "event"));
  $("rows").replaceChildren(...rows);
  fitSlider();
}

// ---- Cameras ----

function lookFrom(camera) {
  if (camera === FREE && state.camera !== FREE) {
    const view = viewOf(DOCUMENT.size);
    const ahead = dot(subtract(state.start.target, view.centre), view.rotation[2]);
    state.orbit = Orbit.from(view, Math.max(ahead, 0.3));
  }
  state.camera = camera;
  if (!canShow(LAYERS.find((layer) => layer.key === state.layer))) state.layer = "gaussians";
  ask({ all: true });
}

function nextCamera(forward) {
  const names = DOCUMENT.cameras.map((camera) => camera.name);
  const place = names.indexOf(state.camera) + (forward ? 1 : -1);
  lookFrom(names[(place + names.length) % names.length]);
}

function home() {
  state.camera = FREE;
  lookFrom(FREE);
  state.orbit = state.start.copy();
}

/** The small pictures, at the moment of now. */
function drawStrip(now = performance.now()) {
  if (!pictures) return;
  pace.strip = now;
  for (const button of $("strip").children) {
    const picture = pictures.get(button.dataset.camera, state.frame, DOCUMENT.pictures.colour ? 0 : 2);
    if (picture) button.firstChild.getContext("2d").drawImage(picture, 0, 0, 96, button.firstChild.height);
  }
}

// ---- Controls ----

function showControls() {
  $("play").textContent = state.playing ? "Pause" : "Play";
  $("play").setAttribute("aria-pressed", state.playing);
  $("camera").value = state.camera;
  for (const button of $("strip").children) {
    button.setAttribute("aria-pressed", button.dataset.camera === state.camera);
  }
  for (const button of document.querySelectorAll("#layers .segments button")) {
    const layer = LAYERS.find((layer) => layer.key === button.dataset.layer);
    button.setAttribute("aria-checked", layer.key === state.layer);
    button.disabled = !canShow(layer);
  }
  const layer = LAYERS.find((layer) => layer.key === state.layer);
  const needs = pictures && state.camera === FREE ? "Pictures, depth and ids are of cameras: look from one." : "";
  const range = pictures?.about.depth_range_m.map((depth) => depth.toFixed(1));
  const depth = range && `Rendered depth: yellow is near (${range[0]} m), violet is far (${range[1]} m).`;
  $("layer-hint").textContent = layer.key === "depth" ? depth : layer.hint || needs;
  for (const box of document.querySelectorAll("#checks input")) box.checked = state[box.name];
  for (const button of $("sentences").children) {
    button.setAttribute("aria-pressed", button.dataset.number === state.sentence);
  }
  $("methods").hidden = !state.sentence;
  // A sentence of one's own has no truth.
  if ($("truth-shown")) $("truth-shown").hidden = !sentenceOf()?.truth;
}

function check(label, checked, change, ...more) {
  const box = element("input", { type: "checkbox", checked });
  box.addEventListener("change", () => {
    change(box.checked);
    ask({ all: true });
  });
  return [element("label", {}, box, ...more, label), box];
}

function choose(number) {
  state.sentence = state.sentence === number ? null : number;
  const sentence = sentenceOf();
  if (sentence && DOCUMENT.masks && CAMERAS.has(DOCUMENT.masks[0])) {
    lookFrom(DOCUMENT.masks[0]);
    const [first, last] = sentence.frames[0] ?? [FIRST, LAST];
    const holds = DOCUMENT.frames.filter((frame) => frame >= first && frame <= last);
    const now = Math.round(state.frame);
    if (!state.playing && !holds.includes(now)) state.frame = holds[holds.length >> 1] ?? state.frame;
  }
  showRows();
  ask({ all: true });
}

function show(layer) {
  const found = LAYERS.find((one) => one.key === layer);
  if (!canShow(found)) {
    if (!pictures) return;
    lookFrom(HELD_OUT ?? DOCUMENT.cameras[0].name);
  }
  state.layer = layer;
  ask({ all: true });
}

function toggle(key) {
  state[key] = !state[key];
  ask({ all: true });
}

function build() {
  const many = (count, one) => `${count} ${one}${count === 1 ? "" : "s"}`;
  $("title").textContent = DOCUMENT.scene;
  $("summary").textContent = [
    `profile ${DOCUMENT.profile}`,
    many(gaussians.count, "Gaussian") + (DOCUMENT.gaussians.moving ? `, ${DOCUMENT.gaussians.moving} of them move` : ""),
    many(DOCUMENT.cameras.length, "camera"),
    ...(DOCUMENT.sentences.length ? [many(DOCUMENT.sentences.length, "sentence")] : []),
  ].join(" · ");
  if (DOCUMENT.description) $("summary").title = DOCUMENT.description;
  Object.assign($("slider"), { min: FIRST, max: LAST, value: FIRST });
  $("frame").style.aspectRatio = DOCUMENT.size.join(" / ");
  $("frame").style.maxWidth = `calc(max(100vh - 330px, 240px) * ${DOCUMENT.size[0] / DOCUMENT.size[1]})`;

  const options = DOCUMENT.cameras.map(({ name, held_out }) => new Option(held_out ? `${name} (held out)` : name, name));
  $("camera").append(new Option("Free view", FREE), ...options);
  if (pictures) {
    for (const { name } of pictures.about.cameras) {
      const height = Math.round((96 * DOCUMENT.size[1]) / DOCUMENT.size[0]);
      const button = element("button", { type: "button", title: `Look from ${name}` });
      button.append(element("canvas", { width: 96, height }), element("span", { textContent: name }));
      button.dataset.camera = name;
      button.addEventListener("click", () => lookFrom(name));
      $("strip").append(button);
    }
  }
  for (const layer of LAYERS.filter((layer) => layer.kind === undefined || pictures)) {
    if (layer.kind === 0 && !pictures.about.colour) continue;
    const button = element("button", { type: "button", textContent: layer.title });
    button.setAttribute("role", "radio");
    button.dataset.layer = layer.key;
    button.addEventListener("click", () => show(layer.key));
    document.querySelector("#layers .segments").append(button);
  }
  for (const { key, title, of } of CHECKS) {
    if (!DOCUMENT[of].length) continue;
    const [label, box] = check(title, state[key], (on) => (state[key] = on));
    box.name = key;
    $("checks").append(label);
  }
  buildSentences();
}

function buildSentences() {
  $("asked").hidden = !DOCUMENT.sentences.length;
  const swatch = (name) => {
    const made = element("span", { className: "swatch" });
    made.style.background = `var(--${name})`;
    return made;
  };
  if (DOCUMENT.masks) {
    const [label] = check("Truth", true, (on) => (state.truth = on), swatch("truth"));
    label.id = "truth-shown";
    $("methods").append(label);
  }
  DOCUMENT.methods.forEach((name, place) => {
    const [label] = check(name, true, (on) => (state.methods[place] = on), swatch(`method-${place}`));
    label.dataset.method = place;
    label.append(element("output"));
    $("methods").append(label);
  });
  $("sentences").append(...DOCUMENT.sentences.map(sentenceButton));
  $("filter").addEventListener("input", () => {
    const word = $("filter").value.toLowerCase();
    for (const button of $("sentences").children) button.hidden = !button.textContent.toLowerCase().includes(word);
  });
}

function sentenceButton({ number, text, categories, temporal, frames }) {
  const when = temporal === "while" ? frames.map((span) => span.join(" to ")).join(", ") : "whole clip";
  const about = `${number} · ${categories.join(" + ")} · ${when}`;
  const button = element("button", { type: "button" }, text, element("small", { textContent: about }));
  button.dataset.number = number;
  button.addEventListener("click", () => choose(number));
  return button;
}

// ---- Keys, mouse, touch ----

const KEYS = {
  " ": () => play(),
  ArrowLeft: () => step(false),
  ArrowRight: () => step(true),
  Home: () => go(FIRST),
  End: () => go(LAST),
  a: () => turn(-0.08, 0),
  d: () => turn(0.08, 0),
  w: () => turn(0, 0.06),
  s: () => turn(0, -0.06),
  "+": () => zoom(0.9),
  "=": () => zoom(0.9),
  "-": () => zoom(1 / 0.9),
  c: () => nextCamera(true),
  C: () => nextCamera(false),
  f: () => lookFrom(FREE),
  h: home,
};
LAYERS.forEach((layer, place) => (KEYS[place + 1] = () => show(layer.key)));
CHECKS.forEach(({ key, letter }) => (KEYS[letter] = () => toggle(key)));

addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const { target } = event;
  const isText = target.matches("input[type=search], input[type=text], select");
  const isButton = target.matches("button, summary, input[type=checkbox]") && event.key === " ";
  const isSlider = target.id === "slider" && event.key !== " " && event.key.length > 1;
  if (isText || isButton || isSlider || !KEYS[event.key]) return;
  event.preventDefault();
  KEYS[event.key]();
});

function free() {
  if (state.camera !== FREE) lookFrom(FREE);
}

function turn(right, up) {
  free();
  state.orbit.turn(right, up);
  ask();
}

function zoom(factor) {
  free();
  state.orbit.zoom(factor);
  ask();
}

const dragging = new Map();

function bindPointers() {
  const canvas = $("overlay");
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    dragging.set(event.pointerId, [event.clientX, event.clientY]);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = dragging.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    const [right, down] = [now[0] - before[0], now[1] - before[1]];
    if (!right && !down) return;
    dragging.set(event.pointerId, now);
    free();
    const { width } = $("frame").getBoundingClientRect();
    if (dragging.size === 2) {
      const other = [...dragging].find(([id]) => id !== event.pointerId)[1];
      const apart = (point) => Math.max(Math.hypot(point[0] - other[0], point[1] - other[1]), 1);
      state.orbit.zoom(apart(before) / apart(now));
      state.orbit.move(right / width / 2, down / width / 2);
    } else if (event.shiftKey || event.buttons & 6) {
      state.orbit.move(right / width, down / width);
    } else {
      state.orbit.turn((4 * right) / width, (4 * down) / width);
    }
    ask();
  });
  for (const kind of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(kind, (event) => {
      dragging.delete(event.pointerId);
      ask();
    });
  }
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      zoom(1.0015 ** clamp(event.deltaY * (event.deltaMode ? 30 : 1), -300, 300));
    },
    { passive: false },
  );
}

// ---- Light and dark ----

const THEMES = ["system", "light", "dark"];
const prefersDark = matchMedia("(prefers-color-scheme: dark)");
let theme = "system";

function paint() {
  document.documentElement.dataset.theme = theme === "system" ? (prefersDark.matches ? "dark" : "light") : theme;
  $("theme").textContent = `Theme: ${theme}`;
  ask();
}

$("theme").addEventListener("click", () => {
  theme = THEMES[(THEMES.indexOf(theme) + 1) % THEMES.length];
  paint();
});
prefersDark.addEventListener("change", paint);

// ---- Begin ----

$("play").addEventListener("click", () => play());
$("back").addEventListener("click", () => step(false));
$("forth").addEventListener("click", () => step(true));
$("home").addEventListener("click", home);
$("slider").addEventListener("input", () => go(Number($("slider").value)));
$("speed").addEventListener("change", () => (state.speed = Number($("speed").value)));
$("camera").addEventListener("change", () => lookFrom($("camera").value));
new ResizeObserver(() => (fitSlider(), ask())).observe($("frame"));

state.start = firstOrbit();
state.orbit = state.start.copy();
bindPointers();
build();
showRows();
paint();
ask({ all: true });
requestAnimationFrame(() => performance.mark("interactive"));

/** For tests and scripts: a picture of the Gaussians as a camera sees it, and how many are drawn in a second. */
globalThis.l4dView = {
  state,
  /** Red, green and blue of each pixel, drawn with `webgl` or by the processor (`software`). */
  picture(camera, frame, size, means) {
    const canvas = document.createElement("canvas");
    this.draw(means === "webgl" ? new Drawing(canvas) : new Software(canvas), camera, frame, size);
    const copy = element("canvas", { width: size[0], height: size[1] }).getContext("2d", { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0);
    return [...copy.getImageData(0, 0, ...size).data].filter((_, at) => at % 4 !== 3);
  },
  draw(drawing, camera, frame, size) {
    gaussians.at(timeOf(frame));
    const view = View.ofCamera(CAMERAS.get(camera), Math.round(frame), DOCUMENT.size, size);
    drawing.draw(gaussians, view, { background: DOCUMENT.background, near: DOCUMENT.near_m });
  },
  picturesPerSecond(camera, size, count) {
    const drawing = bestDrawing(document.createElement("canvas"));
    const start = performance.now();
    for (let k = 0; k < count; k++) this.draw(drawing, camera, FIRST + ((LAST - FIRST) * (k + 0.5)) / count, size);
    createImageBitmap(drawing.canvas);
    return (1000 * count) / (performance.now() - start);
  },
};
