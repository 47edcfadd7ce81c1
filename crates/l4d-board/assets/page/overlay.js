// Prediction over truth over what the camera saw. Colour is never alone: what is missed and what is too much are
// striped in different directions.

const GROUND = [34, 38, 43];
const HIT = [86, 180, 233];
const MISSED = [240, 228, 66];
const EXTRA = [213, 94, 0];

// What else is there, where no picture shows it.
const OBJECT = [74, 81, 91];
const LANDMARK = [50, 56, 63];

/** Masks and picture of a query at one of the shown frames; `answers` may be null. */
function sightOf(data, query, answers, place, scene) {
  const mask = (index) => (index >= 0 ? decodeMask(data.pool[index], scene.width, scene.height) : null);
  return {
    width: scene.width,
    height: scene.height,
    target: mask(data.targets[query][place]),
    answer: answers ? mask(answers[place]) : null,
    backdrop: data.backdrops[place],
    // Decoded only where no picture shows them.
    things: () => data.things.map((thing) => ({ colour: thing.isObject ? OBJECT : LANDMARK, mask: mask(thing.places[place]) })),
  };
}

const pictures = new Map();
const turns = new WeakMap();

function pictureOf(base64) {
  if (!pictures.has(base64)) {
    const image = new Image();
    image.src = `data:image/jpeg;base64,${base64}`;
    // A picture that does not decode is left out; the masks say what matters.
    pictures.set(base64, image.decode().then(() => image, () => null));
  }
  return pictures.get(base64);
}

/** Paints onto a canvas of `factor` pixels a pixel of the mask. `layers`: truth, prediction, picture, colour. */
async function paint(canvas, sight, layers, factor) {
  const { width, height, target, answer } = sight;
  const turn = (turns.get(canvas) ?? 0) + 1;
  turns.set(canvas, turn);
  const image = layers.picture && sight.backdrop ? await pictureOf(sight.backdrop) : null;
  // While the picture was decoded something newer may have been asked for.
  if (turns.get(canvas) !== turn) return;
  canvas.dataset.picture = image ? "shown" : "none";
  canvas.width = width * factor;
  canvas.height = height * factor;
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.fillStyle = `rgb(${GROUND})`;
  context.fillRect(0, 0, canvas.width, canvas.height);
  if (image) context.drawImage(image, 0, 0, canvas.width, canvas.height);
  const things = image ? [] : sight.things();
  const drawn = context.getImageData(0, 0, canvas.width, canvas.height);
  const pixels = drawn.data;
  const stripe = 3 * factor;
  const marksAt = (inside) => [layers.truth && target !== null && target[inside] === 1, layers.prediction && answer !== null && answer[inside] === 1];
  // Over colours that may be those of the overlay a dark line runs around what is marked.
  const isEdged = image && layers.colour && factor > 1;
  const isEdge = (x, y, meant, found) =>
    [[x - 1, y], [x + 1, y], [x, y - 1], [x, y + 1]].some(([column, line]) => {
      if (column < 0 || line < 0 || column >= canvas.width || line >= canvas.height) return false;
      const [otherMeant, otherFound] = marksAt(Math.floor(line / factor) * width + Math.floor(column / factor));
      return otherMeant !== meant || otherFound !== found;
    });
  for (let y = 0; y < canvas.height; y += 1) {
    const row = Math.floor(y / factor) * width;
    for (let x = 0; x < canvas.width; x += 1) {
      const at = 4 * (y * canvas.width + x);
      const inside = row + Math.floor(x / factor);
      if (image && !layers.colour) {
        // Grey and a little darker, so that the overlay is what is coloured.
        const grey = 0.62 * (0.299 * pixels[at] + 0.587 * pixels[at + 1] + 0.114 * pixels[at + 2]) + 12;
        pixels[at] = pixels[at + 1] = pixels[at + 2] = grey;
      } else if (!image) {
        const thing = things.find((thing) => thing.mask !== null && thing.mask[inside] === 1);
        if (thing) pixels.set(thing.colour, at);
      }
      const [meant, found] = marksAt(inside);
      if (!meant && !found) continue;
      let colour = HIT;
      let strength = 0.72;
      if (!found) {
        colour = MISSED;
        strength = Math.floor((x + y) / stripe) % 2 === 0 ? 0.92 : 0.35;
      } else if (!meant) {
        colour = EXTRA;
        strength = Math.floor((x - y + 4096 * stripe) / stripe) % 2 === 0 ? 0.95 : 0.4;
      }
      if (isEdged && isEdge(x, y, meant, found)) [colour, strength] = [GROUND, 0.85];
      for (let channel = 0; channel < 3; channel += 1) {
        pixels[at + channel] += strength * (colour[channel] - pixels[at + channel]);
      }
    }
  }
  context.putImageData(drawn, 0, 0);
}

/** A small picture of a scene; where the page has none, the outlines of what is there. */
function thumbnail(scene) {
  const { width, height } = scene;
  const canvas = el("canvas", { class: "thumbnail", width, height, "aria-hidden": "true" });
  const ready = unpack(document.getElementById(`thumbnail-${sceneIndex(scene.name)}`).textContent);
  return whenSeen(canvas, async () => {
    const { picture, things } = await ready;
    const outlines = () => things.map(([isObject, counts]) => ({ colour: isObject ? OBJECT : LANDMARK, mask: decodeMask(counts, width, height) }));
    paint(canvas, { width, height, target: null, answer: null, backdrop: picture, things: outlines }, { picture: true, colour: true }, 1);
  });
}

/** Calls `draw` for an element when it comes near the window, once. */
function whenSeen(element, draw) {
  element.draw = draw;
  seen.observe(element);
  return element;
}

/** Paper shows all of it, whatever was in sight. */
addEventListener("beforeprint", () => {
  for (const element of document.querySelectorAll("canvas")) {
    if (!element.draw) continue;
    seen.unobserve(element);
    element.draw();
    element.draw = null;
  }
});

const seen = new IntersectionObserver(
  (entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      seen.unobserve(target);
      target.draw();
      target.draw = null;
    }
  },
  { rootMargin: "200px" },
);

/** What the colours mean. */
function overlayKey() {
  const swatch = (colour, stripes) => {
    const lines = [];
    for (let at = -14; at < 28 && stripes !== 0; at += 6) {
      const ends = stripes > 0 ? { x1: at, y1: 14, x2: at + 14, y2: 0 } : { x1: at, y1: 0, x2: at + 14, y2: 14 };
      lines.push(svg("line", { ...ends, stroke: "#22262b", "stroke-width": 2 }));
    }
    return svg("svg", { width: 22, height: 14, "aria-hidden": "true" }, svg("rect", { width: 22, height: 14, fill: colour }), lines);
  };
  return el(
    "ul",
    { class: "keys" },
    el("li", {}, swatch("#56b4e9", 0), "found: prediction and truth"),
    el("li", {}, swatch("#f0e442", 1), "missed: truth alone"),
    el("li", {}, swatch("#d55e00", -1), "too much: prediction alone"),
  );
}
