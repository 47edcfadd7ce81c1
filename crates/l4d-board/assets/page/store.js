// The data of the page: the board at once, scenes when they are looked at.

const board = JSON.parse(document.getElementById("board").textContent);
const METRICS = board.metrics;
const MIOU = 0;
const SELECT = METRICS.findIndex((metric) => metric.key === "select");
const CATEGORIES = ["attribute", "action", "spatial", "interaction"];
const SCALES = ["outdoor", "room", "tabletop"];
const unpacked = new Map();

/** What the page holds of a scene: targets, answers, pool of masks, pictures. Unpacked once. */
function sceneData(index) {
  if (!unpacked.has(index)) unpacked.set(index, unpackScene(index));
  return unpacked.get(index);
}

function unpackScene(index) {
  return unpack(document.getElementById(`scene-${index}`).textContent);
}

async function unpack(text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let at = 0; at < letters.length; at += 1) bytes[at] = letters.charCodeAt(at);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).json();
}

/** `[value, low, high, queries, scenes]` of a metric in a group, or null. */
function cellOf(method, metric, category = "", scale = "") {
  const group = method.groups[`${category}|${scale}`];
  return group ? group[metric] : null;
}

function methodIndex(name) {
  return board.methods.findIndex((method) => method.name === name);
}

function sceneIndex(name) {
  return board.scenes.findIndex((scene) => scene.name === name);
}

/** What a code of a frame says: see the states of docs/scoring.md. */
function stateOf(code) {
  if (code === undefined || code === null) return "not scored";
  if (code >= 0) return `IoU ${(code / 10).toFixed(1)} %`;
  return { "-1": "missed", "-2": "false alarm", "-3": "rightly absent", "-4": "no answer", "-5": "not annotated" }[code];
}
