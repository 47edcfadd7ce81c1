"use strict";
// One annotator's ballot of one round, without a network: what was asked, what is answered, and a file to send back.

const $ = (id) => document.getElementById(id);
const clamp = (value, least, most) => Math.min(Math.max(value, least), most);
const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/** An element with properties and children. */
function element(kind, properties = {}, ...children) {
  const made = Object.assign(document.createElement(kind), properties);
  made.append(...children);
  return made;
}

const PACK = JSON.parse($("document").textContent);
const SCENES = PACK.scenes;
/** Longest reason or comment. */
const MOST_REMARK_BYTES = 2000;
/** Largest copy that is read. */
const MOST_COPY_BYTES = 64 << 20;
/** Memory for decoded pictures. */
const MOST_PICTURE_BYTES = 160 << 20;

// ---- Digests ----

const SHA256_START = [
  0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19,
];
const SHA256_ROUNDS = [
  0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
  0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
  0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
  0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
  0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
  0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
  0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
  0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2,
];

/** SHA-256 of a text in UTF-8, as hex. Browsers keep theirs from pages that were opened as files. */
function sha256(text) {
  const bytes = new TextEncoder().encode(text);
  const padded = new DataView(new ArrayBuffer(((bytes.length + 72) >> 6) << 6));
  new Uint8Array(padded.buffer).set(bytes);
  padded.setUint8(bytes.length, 0x80);
  padded.setUint32(padded.byteLength - 8, Math.floor(bytes.length / 2 ** 29));
  padded.setUint32(padded.byteLength - 4, bytes.length << 3);
  const turn = (word, by) => (word >>> by) | (word << (32 - by));
  const words = new Int32Array(64);
  const sums = Int32Array.from(SHA256_START);
  for (let block = 0; block < padded.byteLength; block += 64) {
    for (let k = 0; k < 16; k++) words[k] = padded.getInt32(block + 4 * k);
    for (let k = 16; k < 64; k++) {
      const [early, late] = [words[k - 15], words[k - 2]];
      const first = turn(early, 7) ^ turn(early, 18) ^ (early >>> 3);
      const second = turn(late, 17) ^ turn(late, 19) ^ (late >>> 10);
      words[k] = words[k - 16] + first + words[k - 7] + second;
    }
    let [a, b, c, d, e, f, g, h] = sums;
    for (let k = 0; k < 64; k++) {
      const mixed = turn(e, 6) ^ turn(e, 11) ^ turn(e, 25);
      const one = (h + mixed + ((e & f) ^ (~e & g)) + SHA256_ROUNDS[k] + words[k]) | 0;
      const two = ((turn(a, 2) ^ turn(a, 13) ^ turn(a, 22)) + ((a & b) ^ (a & c) ^ (b & c))) | 0;
      [h, g, f, e, d, c, b, a] = [g, f, e, (d + one) | 0, c, b, a, (one + two) | 0];
    }
    [a, b, c, d, e, f, g, h].forEach((word, k) => (sums[k] += word));
  }
  return Array.from(sums, (word) => (word >>> 0).toString(16).padStart(8, "0")).join("");
}

// ---- The ballot: lines of text, each with the digest of the line before ----

const HEADER = JSON.stringify({
  schema: "l4d/offline-ballot/1", round: PACK.round, annotator: PACK.annotator, round_sha256: PACK.round_sha256,
  pack: PACK.pack, program: PACK.program,
});
const ITEMS = new Map(PACK.items.map((item) => [item.item, item]));

/** The line of an act: only the fields that belong to it, in their order. */
function lineOf(act, prev) {
  const { at, item, event, choice, frames, text, seen, elapsed_ms, acts } = act;
  if (event === "seal") return JSON.stringify({ at, event, acts, prev });
  const own = { choose: { choice, frames }, comment: { text } }[event] ?? {};
  return JSON.stringify({ at, item, event, ...own, seen, elapsed_ms, prev });
}

/** Why a text can be no reason or comment; undefined if it can. */
function remarkProblem(text) {
  if (typeof text !== "string" || !text.trim()) return "it says nothing";
  if (/[\p{Cc}\p{Cs}]/u.test(text)) return "it has characters that cannot be shown";
  const over = new TextEncoder().encode(text).length - MOST_REMARK_BYTES;
  return over > 0 ? `it is ${over} bytes longer than ${MOST_REMARK_BYTES}` : undefined;
}

const wholeOf = ({ frames }) => [frames[0], frames.at(-1)];
const isAscending = (list) => list.every((value, k) => k === 0 || list[k - 1] < value);
const isNumber = (value, least, most) => Number.isSafeInteger(value) && value >= least && value <= most;

function isChoice(choice, scene) {
  if (choice === "none") return true;
  if (choice?.ambiguous) return same(choice, { ambiguous: { reason: choice.ambiguous.reason } }) &&
    !remarkProblem(choice.ambiguous.reason);
  const numbers = choice?.objects;
  return Array.isArray(numbers) && numbers.length > 0 && same(choice, { objects: numbers }) &&
    numbers.every((number) => isNumber(number, 1, scene.objects)) && isAscending(numbers);
}

function isSeen(seen, scene) {
  const { views, frames } = seen ?? {};
  return Array.isArray(views) && Array.isArray(frames) && same(seen, { views, frames }) &&
    views.every((view) => scene.views.includes(view)) && isAscending(views) &&
    frames.every((frame) => scene.frames.includes(frame)) && isAscending(frames);
}

/** Whether an act is one that this page could have written. */
function isAct(act) {
  if (Number.isNaN(Date.parse(act.at))) return false;
  if (act.event === "seal") return isNumber(act.acts, 0, 1e9);
  const scene = SCENES[ITEMS.get(act.item)?.scene];
  if (!scene || !isSeen(act.seen, scene) || !isNumber(act.elapsed_ms, 0, Number.MAX_SAFE_INTEGER)) return false;
  if (act.event === "comment") return !remarkProblem(act.text);
  if (act.event !== "choose") return act.event === "undo" || act.event === "skip";
  const [first, last] = wholeOf(scene);
  const { frames } = act;
  return isChoice(act.choice, scene) && Array.isArray(frames) && frames.length === 2 &&
    isNumber(frames[0], first, frames[1]) && isNumber(frames[1], first, last);
}

class Ballot {
  lines = [HEADER];
  acts = [];
  isSealed = false;

  get text() {
    return this.lines.join("\n") + "\n";
  }

  add(act) {
    this.lines.push(lineOf(act, sha256(this.lines.at(-1))));
    this.acts.push(act);
    this.isSealed = act.event === "seal";
  }

  /** The ballot in a text up to the first line that is not right, and what is wrong with that. */
  static read(text) {
    const ballot = new Ballot();
    const lines = text.split("\n");
    if (lines.at(-1) === "") lines.pop();
    const problem = headerProblem(lines[0] ?? "");
    if (problem) return { ballot, problem };
    let last = lines[0];
    for (let k = 1; k < lines.length; k++) {
      const wrong = ballot.lineProblem(lines[k], last);
      if (wrong) return { ballot, problem: `line ${k + 1} ${wrong}` };
      last = lines[k];
      ballot.add(JSON.parse(last));
    }
    return { ballot };
  }

  lineProblem(line, last) {
    const act = parsed(line);
    if (!act) return "is no act";
    if (this.isSealed) return "follows the seal";
    if (act.prev !== sha256(last)) return "does not continue the line before it";
    if (!isAct(act) || lineOf(act, act.prev) !== line) return "is not as this page writes it";
    if (act.event !== "seal") return undefined;
    const isWhole = act.acts === this.acts.length && [...responsesOf(this.acts).values()].every(isDecided);
    return isWhole ? undefined : "is a seal that does not fit the lines above it";
  }
}

function parsed(line) {
  try {
    const value = JSON.parse(line);
    return value !== null && typeof value === "object" ? value : undefined;
  } catch {
    return undefined;
  }
}

function headerProblem(line) {
  const header = parsed(line);
  const expected = JSON.parse(HEADER);
  if (header?.schema !== expected.schema) return "it is no ballot of a voting page";
  if (header.round !== expected.round) return `it belongs to round ${header.round}, this page to ${expected.round}`;
  if (header.annotator !== expected.annotator) {
    return `it is the ballot of ${header.annotator}, this page is for ${expected.annotator}`;
  }
  if (header.pack !== expected.pack) return "it was made with another page of this round, where numbers differ";
  return line === HEADER ? undefined : "its first line was changed";
}

/** What is said about each item: acts push, an undo takes back the latest of its item, and the newest answer or skip
 * counts. */
function responsesOf(acts) {
  const stacks = new Map(PACK.items.map(({ item }) => [item, []]));
  acts.forEach((act, place) => {
    if (act.event === "undo") stacks.get(act.item).pop();
    else stacks.get(act.item)?.push({ ...act, place });
  });
  return new Map([...stacks].map(([item, stack]) => [item, responseOf(stack)]));
}

function responseOf(stack) {
  const decision = stack.findLast((act) => act.event !== "comment");
  const isAnswer = decision?.event === "choose";
  return {
    answer: isAnswer ? { choice: decision.choice, frames: decision.frames } : null,
    skipped: decision?.event === "skip",
    comments: stack.filter((act) => act.event === "comment").map((act) => act.text),
    /** Place of the act that an undo would take back. */
    undoable: stack.at(-1)?.place ?? -1,
  };
}

const isDecided = (response) => response.answer !== null || response.skipped;

// ---- Pictures ----

/** The bytes of a block; its text stays in the page, so that few blocks need be kept. */
function blockBytes(name) {
  const block = $("block-" + name);
  if (!block) throw new Error("this page is incomplete, ask for it again");
  const text = block.textContent.trim();
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let at = 0; at < binary.length; at++) bytes[at] = binary.charCodeAt(at);
  return bytes;
}

/** Numbers of objects, a byte a pixel, of runs: a number, then how long it lasts as LEB128. */
function unpackIds(runs, count) {
  const ids = new Uint8Array(count);
  let place = 0;
  for (let at = 0; at < runs.length; ) {
    const number = runs[at++];
    let [length, shift, byte] = [0, 0, 0];
    do {
      byte = runs[at++];
      length += (byte & 127) * 2 ** shift;
      shift += 7;
    } while (byte & 128);
    ids.fill(number, place, place + length);
    place += length;
  }
  if (place !== count) throw new Error("the outlines of this picture are damaged");
  return ids;
}

/** Takes the oldest entries out of a map that is too large. */
function forget(map, most) {
  while (map.size > most) map.delete(map.keys().next().value);
}

/** Pictures with their objects, decoded when they are asked for. */
class Pictures {
  blocks = new Map();
  entries = new Map();

  /** A picture; undefined until it is decoded, and then the screen is drawn again. */
  get(sceneName, view, place) {
    const key = `${sceneName}/${view}/${place}`;
    if (this.entries.has(key)) return this.entries.get(key).found;
    const entry = { found: undefined };
    this.entries.set(key, entry);
    const [width, height] = SCENES[sceneName].size;
    forget(this.entries, Math.max(8, Math.floor(MOST_PICTURE_BYTES / (width * height * 5))));
    this.decode(sceneName, view, place).then(
      (found) => (entry.found = found),
      (error) => (entry.found = { error: `This picture cannot be shown: ${error.message}` }),
    ).then(askForDrawing);
    return undefined;
  }

  async decode(sceneName, view, place) {
    const scene = SCENES[sceneName];
    const [light, runs] = this.parts(sceneName, view, place);
    const [width, height] = scene.size;
    const ids = unpackIds(runs, width * height);
    const image = await createImageBitmap(new Blob([light], { type: "image/jpeg" }));
    return { image, width, height, objects: objectsIn(ids, width, height, scene.objects), ids };
  }

  parts(sceneName, view, place) {
    const name = `${sceneName}-${view}`;
    if (!this.blocks.has(name)) this.blocks.set(name, blockBytes(name));
    forget(this.blocks, 3);
    const bytes = this.blocks.get(name);
    const lengths = SCENES[sceneName].lengths[view];
    const start = lengths.slice(0, place).reduce((sum, [light, ids]) => sum + light + ids, 0);
    const middle = start + lengths[place][0];
    return [bytes.slice(start, middle), bytes.slice(middle, middle + lengths[place][1])];
  }
}

/** Outline, middle and box of every object in a picture, by number. */
function objectsIn(ids, width, height, count) {
  const found = new Map();
  for (let y = 0, at = 0; y < height; y++) {
    for (let x = 0; x < width; x++, at++) {
      const number = ids[at];
      if (number === 0 || number > count) continue;
      if (!found.has(number)) found.set(number, { pixels: 0, x: 0, y: 0, box: [x, y, x, y], sides: new Map() });
      const object = found.get(number);
      object.pixels++;
      object.x += x + 0.5;
      object.y += y + 0.5;
      object.box = [Math.min(object.box[0], x), object.box[1], Math.max(object.box[2], x), y];
      const corner = y * (width + 1) + x;
      // Sides run so that the object is on their right.
      if (y === 0 || ids[at - width] !== number) addSide(object.sides, corner, 0);
      if (x === width - 1 || ids[at + 1] !== number) addSide(object.sides, corner + 1, 1);
      if (y === height - 1 || ids[at + width] !== number) addSide(object.sides, corner + width + 2, 2);
      if (x === 0 || ids[at - 1] !== number) addSide(object.sides, corner + width + 1, 3);
    }
  }
  for (const [number, object] of found) {
    object.path = outlinePath(object.sides, width + 1);
    object.sides = undefined;
    object.middle = middleOf(object, number, ids, width);
  }
  return found;
}

/** Directions from a corner: 0 right, 1 down, 2 left, 3 up; one bit each. */
function addSide(sides, corner, direction) {
  sides.set(corner, (sides.get(corner) ?? 0) | (1 << direction));
}

/** Follows sides round and round. */
function outlinePath(sides, columns) {
  const path = new Path2D();
  const steps = [1, columns, -1, -columns];
  while (sides.size) {
    const corners = [];
    const first = sides.keys().next().value;
    let corner = first;
    let direction = [0, 1, 2, 3].find((way) => sides.get(corner) & (1 << way));
    do {
      const left = sides.get(corner) & ~(1 << direction);
      if (left) sides.set(corner, left);
      else sides.delete(corner);
      corners.push([corner % columns, Math.floor(corner / columns)]);
      corner += steps[direction];
      // Right first: pixels that touch at a corner alone are not joined.
      const ways = [(direction + 1) % 4, direction, (direction + 3) % 4];
      direction = ways.find((way) => sides.get(corner) & (1 << way));
    } while (direction !== undefined && corner !== first);
    drawLoop(path, smoothed(corners));
  }
  return path;
}

/** Each corner's mean with its neighbours: less than a pixel away, without the stairs of a grid. */
function smoothed(corners) {
  if (corners.length < 12) return corners;
  const at = (k) => corners[(k + corners.length) % corners.length];
  const mean = (k, axis) => (at(k - 2)[axis] + at(k - 1)[axis] + at(k)[axis] + at(k + 1)[axis] + at(k + 2)[axis]) / 5;
  return corners.map((_, k) => [mean(k, 0), mean(k, 1)]);
}

function drawLoop(path, corners) {
  const between = (a, b) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  path.moveTo(...between(corners.at(-1), corners[0]));
  corners.forEach((corner, k) => {
    path.quadraticCurveTo(...corner, ...between(corner, corners[(k + 1) % corners.length]));
  });
  path.closePath();
}

/** The centroid, or the pixel of the object nearest to it where that is beside the object. */
function middleOf({ pixels, x, y, box }, number, ids, width) {
  const centre = [x / pixels, y / pixels];
  if (ids[Math.floor(centre[1]) * width + Math.floor(centre[0])] === number) return centre;
  let [best, least] = [centre, Infinity];
  for (let row = box[1]; row <= box[3]; row++) {
    for (let column = box[0]; column <= box[2]; column++) {
      if (ids[row * width + column] !== number) continue;
      const far = (column + 0.5 - centre[0]) ** 2 + (row + 0.5 - centre[1]) ** 2;
      if (far < least) [best, least] = [[column + 0.5, row + 0.5], far];
    }
  }
  return best;
}

// ---- What the page knows ----

const blankDraft = () => ({ choice: { objects: [] }, frames: null, typed: "" });

const model = {
  ballot: new Ballot(),
  responses: responsesOf([]),
  at: 0,
  /** choose, when, reason, comment, summary, or stopped. */
  mode: "choose",
  /** What would be saved now; `frames` is null for the whole clip, `typed` the start of a number of two digits. */
  draft: blankDraft(),
  /** Drafts of items that were left without saving, by place. */
  drafts: new Map(),
  view: 0,
  /** Place in the frames of the scene. */
  frame: 0,
  zoom: { x: 0.5, y: 0.5, factor: 1 },
  outlines: true,
  /** When the next frame is due. */
  playing: null,
  seen: { views: new Set(), frames: new Set() },
  shownAt: performance.now(),
  notice: null,
  /** Whether the browser keeps the ballot, and how many of its lines are in a copy. */
  isKept: true,
  copied: 1,
};
const pictures = new Pictures();

const item = () => PACK.items[model.at];
const scene = () => SCENES[item().scene];
const response = () => model.responses.get(item().item);
const whole = () => wholeOf(scene());
const holds = () => model.draft.frames ?? whole();
const frameNumber = () => scene().frames[model.frame];
const chosenNumbers = () => model.draft.choice.objects ?? [];
const placeOf = (id) => PACK.items.findIndex(({ item }) => item === id);
const places = (test) => PACK.items.flatMap(({ item }, place) => (test(model.responses.get(item)) ? [place] : []));
const openPlaces = () => places((response) => !isDecided(response));
/** Places of the items without an answer: open ones first, then skipped ones. */
const unanswered = () => [...openPlaces(), ...places((response) => response.skipped)];
const isBlank = ({ choice, typed }) => choice.objects?.length === 0 && !typed;
const isUnsaved = () => !isBlank(model.draft) && !same(draftAnswer(), response().answer);
const isTyping = () => model.mode === "reason" || model.mode === "comment";

/** What would be saved; null while nothing is said. Where nothing is meant, nothing could hold at a time. */
function draftAnswer() {
  const { choice } = model.draft;
  if (choice.objects?.length === 0) return null;
  return { choice, frames: choice.objects ? holds() : whole() };
}

function draftOf({ choice, frames }) {
  return { choice: structuredClone(choice), frames: same(frames, whole()) ? null : frames, typed: "" };
}

function recallDraft() {
  const { answer } = response();
  model.draft = answer ? draftOf(answer) : blankDraft();
}

const say = (text) => (model.notice = { text, isError: false });
const complain = (text) => (model.notice = { text, isError: true });

// ---- Answers ----

function toggle(number) {
  const { draft } = model;
  model.mode = "choose";
  const numbers = new Set(chosenNumbers());
  if (!numbers.delete(number)) numbers.add(number);
  draft.choice = { objects: [...numbers].sort((a, b) => a - b) };
  draft.typed = "";
}

/** Reads a number digit by digit; it is complete when no further digit can follow. */
function digit(text) {
  model.mode = "choose";
  const number = Number(model.draft.typed + text);
  const count = scene().objects;
  if (number < 1 || number > count) {
    model.draft.typed = "";
    return complain(`There is no such object: the numbers go from 1 to ${count}.`);
  }
  if (number * 10 <= count) model.draft.typed = String(number);
  else toggle(number);
}

function none() {
  model.mode = "choose";
  model.draft = { ...blankDraft(), ...(model.draft.choice === "none" ? {} : { choice: "none" }) };
}

function clear() {
  model.mode = "choose";
  model.draft = blankDraft();
}

function back() {
  if (model.mode === "when") model.mode = "choose";
  else if (isTyping() || (model.mode === "summary" && !model.ballot.isSealed)) model.mode = "choose";
  else if (model.playing !== null) model.playing = null;
  else model.zoom = { x: 0.5, y: 0.5, factor: 1 };
}

function hold(first, last) {
  model.draft.frames = same([first, last], whole()) ? null : [first, last];
}

function holdsFrom() {
  const first = frameNumber();
  hold(first, holds()[1] < first ? whole()[1] : holds()[1]);
}

function holdsUntil() {
  const last = frameNumber();
  hold(holds()[0] > last ? whole()[0] : holds()[0], last);
}

/** Objects lead to the question when, everything else is saved. */
function accept() {
  if (model.draft.typed) toggle(Number(model.draft.typed));
  const answer = draftAnswer();
  if (!answer) return complain("Choose objects by their numbers, or none, or ambiguous.");
  if (model.mode === "choose" && answer.choice.objects) model.mode = "when";
  else save(answer);
}

function save(answer) {
  if (same(answer, response().answer)) {
    say("This is the saved answer already.");
    return goOn();
  }
  const { item: id } = item();
  if (!record({ event: "choose", ...answer })) return;
  say(`Saved ${id}.`);
  goOn();
}

function skip() {
  if (response().skipped) return goOn();
  const { item: id } = item();
  if (!record({ event: "skip" })) return;
  model.draft = blankDraft();
  say(`Skipped ${id}. "What is left" lists what was skipped.`);
  goOn();
}

/** One line: white space becomes spaces, and what cannot be shown is left out. */
const cleaned = (text) => text.replace(/\s/gu, " ").replace(/[\p{Cc}\p{Cs}]/gu, "").trim();

function startTyping(mode) {
  model.mode = mode;
  model.playing = null;
  $("remark").value = mode === "reason" ? model.draft.choice.ambiguous?.reason ?? "" : "";
}

function finishTyping() {
  const text = cleaned($("remark").value);
  if (!text && model.mode === "comment") return (model.mode = "choose");
  if (!text) return complain("Say in a few words what makes it ambiguous, or go back.");
  const problem = remarkProblem(text);
  if (problem) return complain(`The text was not saved: ${problem}.`);
  if (model.mode === "reason") {
    model.draft = { ...blankDraft(), choice: { ambiguous: { reason: text } } };
    return save(draftAnswer());
  }
  if (!record({ event: "comment", text })) return;
  model.mode = "choose";
  say("Saved the comment.");
}

/** Takes back, in this order: what was not saved, the latest act on this item, the latest act at all. */
function undo() {
  const isOnItem = model.mode !== "summary";
  if (isOnItem && isUnsaved()) {
    model.mode = "choose";
    recallDraft();
    return say("Took back what was not saved.");
  }
  if (!isOnItem || response().undoable < 0) {
    const latest = Math.max(...[...model.responses.values()].map(({ undoable }) => undoable));
    if (latest < 0) return say("There is nothing to take back.");
    open(placeOf(model.ballot.acts[latest].item));
  }
  const before = response();
  if (record({ event: "undo" })) takenBack(before);
}

function takenBack(before) {
  const now = response();
  let what = "the answer";
  if (now.comments.length < before.comments.length) what = "the comment";
  else if (before.skipped && !now.skipped) what = "the skip";
  model.mode = "choose";
  // What was taken back is most often wanted again with one change.
  if (what === "the answer" && before.answer) model.draft = draftOf(before.answer);
  else recallDraft();
  say(`Took back ${what} of ${item().item}.`);
}

function stepItem(step) {
  const place = clamp(model.at + step, 0, PACK.items.length - 1);
  if (place !== model.at) return open(place);
  say(`This is the ${step < 0 ? "first" : "last"} item. "What is left" shows what is left.`);
}

/** To the next open item, from the beginning again if none follows, or to what is left. */
function goOn() {
  const count = PACK.items.length;
  const following = PACK.items.map((_, k) => (model.at + k + 1) % count);
  const next = following.find((place) => !isDecided(model.responses.get(PACK.items[place].item)));
  if (next !== undefined) return open(next);
  model.drafts.delete(model.at);
  recallDraft();
  summarise();
}

/** Puts an item on the screen as if it were seen for the first time; what was entered there before is kept. */
function open(place) {
  if (place !== model.at) {
    if (isUnsaved()) model.drafts.set(model.at, model.draft);
    model.at = place;
    lookAfresh();
  }
  model.mode = "choose";
}

function lookAfresh() {
  Object.assign(model, {
    view: 0, frame: scene().opening, zoom: { x: 0.5, y: 0.5, factor: 1 }, outlines: true, playing: null,
    seen: { views: new Set(), frames: new Set() }, shownAt: performance.now(),
  });
  const kept = model.drafts.get(model.at);
  model.drafts.delete(model.at);
  if (kept) model.draft = kept;
  else recallDraft();
}

function summarise() {
  model.playing = null;
  model.mode = "summary";
}

function askForSeal() {
  const open = openPlaces().length;
  if (open) return complain(`${open === 1 ? "1 item is" : `${open} items are`} open: answer or skip before sealing.`);
  const skipped = unanswered().length;
  const left = skipped === 0 ? "" : skipped === 1
    ? " The skipped item stays without an answer."
    : ` The ${skipped} skipped items stay without an answer.`;
  askWhether("Seal the ballot?", `Nothing can be changed afterwards, and the ballot may be used.${left} ` +
    "You then save the sealed ballot as a file and send it to the person who runs the round.", "Seal", seal);
}

function seal() {
  if (!append({ at: new Date().toISOString(), event: "seal", acts: model.ballot.acts.length })) return;
  model.drafts.clear();
  recallDraft();
  summarise();
  say("The ballot is sealed.");
}

/** Appends an act on the item of now; false if it was not taken. */
function record(own) {
  const sorted = (set, order) => [...set].sort(order);
  return append({
    at: new Date().toISOString(),
    item: item().item,
    ...own,
    seen: { views: sorted(model.seen.views), frames: sorted(model.seen.frames, (a, b) => a - b) },
    elapsed_ms: Math.max(0, Math.round(performance.now() - model.shownAt)),
  });
}

function append(act) {
  if (model.ballot.isSealed || model.mode === "stopped") return false;
  if (wasWrittenElsewhere()) {
    stop("Another window has written into this ballot.");
    return false;
  }
  model.ballot.add(act);
  keep();
  model.responses = responsesOf(model.ballot.acts);
  return true;
}

// ---- What the browser keeps ----

const KEY = `l4d vote ${PACK.pack}`;
const WINDOW_KEY = `${KEY} window`;
/** Tells this window from others. */
const WINDOW = `${Date.now()} ${Math.random()}`;
/** What this window left in the browser; null before it left anything. */
let lastKept = null;

/** Something of the browser's storage; undefined where there is none. */
function stored(use) {
  try {
    return use(window.localStorage);
  } catch {
    return undefined;
  }
}

function keep() {
  const { text } = model.ballot;
  model.isKept = stored((storage) => {
    storage.setItem(KEY, text);
    return storage.getItem(KEY) === text;
  }) === true;
  if (model.isKept) lastKept = text;
}

/** The event that tells of other windows may be late, and an act must not be lost until it comes. */
function wasWrittenElsewhere() {
  const found = stored((storage) => storage.getItem(KEY)) ?? null;
  return found !== null && lastKept !== null && found !== lastKept;
}

/** Makes this window the one that writes; others hear of it and stop. */
function claim() {
  stored((storage) => storage.setItem(WINDOW_KEY, WINDOW));
}

function recallBallot() {
  const text = stored((storage) => storage.getItem(KEY));
  if (typeof text === "string") {
    const { ballot, problem } = Ballot.read(text);
    model.ballot = ballot;
    lastKept = text;
    if (problem) {
      stored((storage) => storage.setItem(`${KEY} damaged ${new Date().toISOString()}`, text));
      complain(`What this browser kept is damaged (${problem}). What comes before that is here; go on from a copy if ` +
        "you have one.");
    } else if (ballot.acts.length && !ballot.isSealed) say("Your work goes on where you stopped.");
  }
  claim();
  keep();
}

function stop(why) {
  Object.assign(model, { mode: "stopped", playing: null, notice: null });
  $("why-stopped").textContent =
    `${why} Only one window may write, so that no answer is lost. Close this window and go on in the other one.`;
  closeDialogs();
  show();
}

window.addEventListener("storage", (event) => {
  if (model.mode === "stopped") return;
  const isClaim = event.key === WINDOW_KEY && event.newValue !== null && event.newValue !== WINDOW;
  const isWrite = event.key === KEY && event.newValue !== null && event.newValue !== lastKept;
  if (isClaim || isWrite) stop("The same page is open in another window.");
});
window.addEventListener("pageshow", (event) => {
  if (event.persisted) window.location.reload();
});
window.addEventListener("beforeunload", (event) => {
  if (model.mode === "stopped") return;
  const isOnlyHere = !model.isKept && model.ballot.lines.length > model.copied;
  const hasText = isTyping() && $("remark").value.trim() !== "";
  if (!isOnlyHere && !hasText && (model.ballot.isSealed || (!isUnsaved() && model.drafts.size === 0))) return;
  event.preventDefault();
  // What browsers of before 2024 go by.
  event.returnValue = true;
});

function download() {
  const url = URL.createObjectURL(new Blob([model.ballot.text], { type: "application/x-ndjson" }));
  const link = element("a", { href: url, download: `${PACK.round}-${PACK.annotator}.ballot.jsonl` });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
  model.copied = model.ballot.lines.length;
  say(`Saved the file ${link.download} where your browser saves files.`);
}

/** Goes on from the text of a copy, unless it has less than is here or is not right. */
function resumeFrom(text) {
  const { ballot, problem } = Ballot.read(text);
  if (problem) return complain(`Nothing was changed: the copy cannot be used, ${problem}.`);
  const here = model.ballot.text;
  if (ballot.text === here) return say("The copy is the same as what is here.");
  if (here.startsWith(ballot.text)) return say("Nothing was changed: all acts of the copy are here already.");
  if (model.ballot.isSealed) return complain("Nothing was changed: the ballot here is sealed.");
  if (ballot.text.startsWith(here)) return take(ballot);
  const count = acts(model.ballot.acts.length);
  askWhether("Replace what is here?", `The copy does not continue the ballot in this window. Made here and ` +
    `lost: ${count}. Save a copy first if you are not sure.`, "Replace", () => take(ballot));
}

const acts = (count) => (count === 1 ? "1 act" : `${count} acts`);

function take(ballot) {
  if (wasWrittenElsewhere()) return stop("Another window has written into this ballot.");
  model.ballot = ballot;
  model.copied = ballot.lines.length;
  model.drafts.clear();
  keep();
  begin();
  say(`Goes on from the copy with ${acts(ballot.acts.length)}.`);
}

/** To the first open item, or to what is left. */
function begin() {
  model.responses = responsesOf(model.ballot.acts);
  const open = openPlaces();
  model.at = open[0] ?? 0;
  lookAfresh();
  model.mode = open.length ? "choose" : "summary";
}

async function readCopy() {
  const [file] = $("file").files;
  if (!file) return;
  try {
    if (file.size > MOST_COPY_BYTES) throw new Error("it is larger than any ballot");
    const text = await file.text();
    act(() => resumeFrom(text));
  } catch (error) {
    act(() => complain(`Nothing was changed: the file cannot be read, ${error.message}.`));
  }
  $("file").value = "";
}

// ---- Looking ----

function stepFrame(step) {
  model.playing = null;
  model.frame = clamp(model.frame + step, 0, scene().frames.length - 1);
}

function stepView(step) {
  const count = scene().views.length;
  model.view = (model.view + step + count) % count;
}

/** How long each frame is shown: as long as it lasts in the clip. */
function frameTime() {
  const { frames, frames_per_second } = scene();
  return (1000 * Math.max((frames[1] ?? 1) - frames[0], 1)) / (frames_per_second ?? 24);
}

function play() {
  model.playing = model.playing === null ? performance.now() + frameTime() : null;
}

/** The whole clip; while the time is asked for, the part that the answer names. */
function playedFrames() {
  const { frames } = scene();
  const [first, last] = model.mode === "when" ? holds() : whole();
  return [frames.findIndex((frame) => frame >= first), frames.findLastIndex((frame) => frame <= last)];
}

/** The next frame, if it is due. */
function tick(now) {
  if (now < model.playing) return;
  const [first, last] = playedFrames();
  model.frame = model.frame >= first && model.frame < last ? model.frame + 1 : first;
  // Being late once must not make the rest of the clip run.
  model.playing = Math.max(model.playing + frameTime(), now);
  showTime();
}

const MOST_ZOOM = 12;
const ZOOM_STEP = 1.5;
/** How far a key moves the picture, as a share of what is shown. */
const PAN_STEP = 0.125;

function setZoom(x, y, factor) {
  const within = clamp(factor < 1.01 ? 1 : factor, 1, MOST_ZOOM);
  const reach = 0.5 / within;
  model.zoom = { x: clamp(x, reach, 1 - reach), y: clamp(y, reach, 1 - reach), factor: within };
}

const zoomBy = (steps) => setZoom(model.zoom.x, model.zoom.y, model.zoom.factor * ZOOM_STEP ** steps);
const pan = (right, down) =>
  setZoom(model.zoom.x + right / model.zoom.factor, model.zoom.y + down / model.zoom.factor, model.zoom.factor);

/** Zooms to the chosen objects, to all of them if none is chosen, and back. */
function zoomToChosen() {
  if (model.zoom.factor > 1) return setZoom(0.5, 0.5, 1);
  const found = pictures.get(item().scene, scene().views[model.view], model.frame);
  const numbers = chosenNumbers();
  const boxes = [...(found?.objects ?? [])].flatMap(([number, { box }]) =>
    !numbers.length || numbers.includes(number) ? [box] : []);
  if (!boxes.length) return say("None of the chosen objects is in this picture.");
  const least = (k) => Math.min(...boxes.map((box) => box[k]));
  const most = (k) => Math.max(...boxes.map((box) => box[k])) + 1;
  const [width, height] = scene().size;
  const share = Math.max((most(2) - least(0)) / width, (most(3) - least(1)) / height);
  setZoom((least(0) + most(2)) / 2 / width, (least(1) + most(3)) / 2 / height, 0.4 / share);
}

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

// ---- The page ----

function show() {
  const isOnItem = ["choose", "when", "reason", "comment"].includes(model.mode);
  $("item").hidden = !isOnItem;
  $("asked").hidden = !isOnItem;
  $("summary").hidden = model.mode !== "summary";
  $("stopped").hidden = model.mode !== "stopped";
  document.querySelector("nav").hidden = model.mode === "stopped";
  showHeader(isOnItem);
  showMessage();
  if (isOnItem) showItem();
  if (model.mode === "summary") showSummary();
  askForDrawing();
}

function showHeader(isOnItem) {
  const answered = places((response) => response.answer !== null).length;
  const skipped = places((response) => response.skipped).length;
  $("title").textContent = `Round ${PACK.round} · ${PACK.annotator}`;
  $("progress").textContent = `${answered} of ${PACK.items.length} answered` + (skipped ? `, ${skipped} skipped` : "");
  $("before").hidden = $("after").hidden = !isOnItem;
  $("left").hidden = !isOnItem;
  // What is being typed would be lost.
  $("left").disabled = isTyping();
  $("before").disabled = isTyping() || model.at === 0;
  $("after").disabled = isTyping() || model.at === PACK.items.length - 1;
  $("kept").className = model.isKept ? "" : "wrong";
  const isSafe = "The sealed ballot is kept in this browser until its data is cleared. What counts is the saved file.";
  $("kept").textContent = model.isKept && model.ballot.isSealed ? isSafe : model.isKept
    ? "Each act is kept in this browser as soon as it is done, and sent nowhere. A copy also protects it if the " +
      "browser clears its data."
    : "This browser does not keep your answers: save a copy before you close this page.";
  $("copy").hidden = $("resume").hidden = model.mode === "stopped" || model.ballot.isSealed;
}

function showMessage() {
  $("message").textContent = model.notice?.text ?? "";
  $("message").className = model.notice?.isError ? "wrong" : "";
}

const press = (button, isPressed) => button.setAttribute("aria-pressed", String(isPressed));

/** Makes a group have as many buttons as there are, and no fewer or more. */
function fillGroup(group, titles, make) {
  if (group.dataset.titles === titles.join()) return;
  group.dataset.titles = titles.join();
  group.replaceChildren(...titles.map(make));
}

function showItem() {
  const { views, objects, size } = scene();
  $("which-item").textContent = `Item ${model.at + 1} of ${PACK.items.length} · ${item().item}`;
  if ($("sentence").textContent !== item().text) $("sentence").textContent = item().text;
  $("frame").style.setProperty("--aspect", size[0] / size[1]);
  fillGroup($("views"), views.map((_, k) => `View ${k + 1}`), (title, k) =>
    button(title, () => (model.view = k)));
  [...$("views").children].forEach((view, k) => press(view, k === model.view));
  $("views").hidden = views.length < 2;
  $("smaller").disabled = model.zoom.factor === 1;
  $("larger").disabled = model.zoom.factor === MOST_ZOOM;
  const closer = chosenNumbers().length ? "Zoom to chosen" : "Zoom to objects";
  $("closer").textContent = model.zoom.factor > 1 ? "Whole picture" : closer;
  canvas.classList.toggle("zoomed", model.zoom.factor > 1);
  press($("outlines"), model.outlines);
  showWhich(objects);
  showTime();
  showWhen();
  showText();
}

function button(title, does) {
  const made = element("button", { type: "button", textContent: title });
  made.addEventListener("click", () => act(does));
  return made;
}

function showWhich(count) {
  const titles = Array.from({ length: count }, (_, k) => String(k + 1));
  fillGroup($("numbers"), titles, (title) => {
    const made = button(title, () => toggle(Number(title)));
    made.setAttribute("aria-label", `Object ${title}`);
    made.dataset.number = title;
    made.style.setProperty("--colour", colourOf(Number(title)));
    return made;
  });
  const chosen = chosenNumbers();
  for (const number of $("numbers").children) press(number, chosen.includes(Number(number.dataset.number)));
  const { choice } = model.draft;
  press($("none"), choice === "none");
  press($("ambiguous"), Boolean(choice.ambiguous));
  $("clear").disabled = isBlank(model.draft);
  $("answer").textContent = answerInWords();
  $("undo").disabled = model.ballot.acts.length === 0 && !isUnsaved();
  $("go-on").textContent = choice.objects ? "Go on: when is it so?" : "Save answer";
  $("go-on").hidden = model.mode !== "choose";
  $("which").classList.toggle("asked", model.mode === "choose");
  $("comments").replaceChildren(...response().comments.map((text) => element("li", { textContent: text })));
}

function answerInWords() {
  const { choice, typed } = model.draft;
  const { answer, skipped } = response();
  let state = "no answer yet";
  if (isUnsaved()) state = "not saved yet";
  else if (answer) state = "saved";
  else if (skipped) state = "skipped";
  let text = typed ? `${typed}_` : chosenNumbers().join(", ");
  if (choice === "none") text = "none";
  if (choice.ambiguous) text = `ambiguous: ${choice.ambiguous.reason}`;
  return text ? `${text} (${state})` : state[0].toUpperCase() + state.slice(1);
}

function seconds(frame) {
  const rate = scene().frames_per_second;
  return rate ? ` · ${(frame / rate).toFixed(2)} s` : "";
}

function showTime() {
  const { frames } = scene();
  const slider = $("slider");
  slider.max = frames.length - 1;
  slider.value = model.frame;
  slider.disabled = $("play").disabled = frames.length < 2;
  const moment = `frame ${frameNumber()}${seconds(frameNumber())}`;
  slider.setAttribute("aria-valuetext", moment);
  $("moment").textContent = moment;
  $("play").textContent = model.playing === null ? "Play" : "Stop";
}

/** Where a frame is on the slider, in percent. */
function percentOf(frame) {
  const { frames } = scene();
  const place = Math.max(frames.findLastIndex((other) => other <= frame), 0);
  return (100 * place) / Math.max(frames.length - 1, 1);
}

function showWhen() {
  const isAsked = model.mode === "when";
  const isOfObjects = Boolean(model.draft.choice.objects);
  const [first, last] = isOfObjects ? holds() : whole();
  const isWhole = same([first, last], whole());
  $("interval").textContent = isWhole ? "Whole clip"
    : first === last ? `Frame ${first}` : `Frames ${first} to ${last}`;
  $("when").classList.toggle("asked", isAsked);
  $("limits").hidden = $("saving").hidden = !isAsked;
  press($("always"), isWhole);
  const bar = $("holds").firstElementChild;
  bar.style.left = `${percentOf(first)}%`;
  bar.style.right = `${100 - percentOf(last)}%`;
  $("holds").classList.toggle("asked", isAsked);
}

function showText() {
  const isReason = model.mode === "reason";
  $("text").hidden = !isTyping();
  $("which").hidden = $("when").hidden = $("acts").hidden = isTyping();
  $("remark-title").textContent = isReason ? "What makes it ambiguous?" : "Your comment";
  $("remark-hint").textContent = isReason
    ? "A few words, for example: two cats are on the floor. Saved with the answer."
    : "It is kept with your ballot. Write nothing about yourself or others.";
}

function showSummary() {
  const list = unanswered();
  const open = openPlaces().length;
  const { isSealed } = model.ballot;
  const answered = PACK.items.length - list.length;
  $("summary-title").textContent = isSealed ? "The ballot is sealed. Thank you." : "What is left";
  $("counts").textContent =
    `${PACK.items.length} items: ${answered} answered, ${list.length - open} skipped, ${open} open`;
  $("unanswered").replaceChildren(...(isSealed ? [] : list.map(unansweredLine)));
  $("closing").textContent = closingText(isSealed, open);
  $("seal").hidden = $("to-items").hidden = $("undo-any").hidden = isSealed;
  $("seal").disabled = open > 0;
  $("take").hidden = !isSealed;
}

function closingText(isSealed, open) {
  if (isSealed) {
    return "Nothing can be changed any more. Save the sealed ballot as a file, and send the file to the person who " +
      "runs the round.";
  }
  if (open) return "The ballot can be sealed when every item is answered or skipped.";
  return "Nothing is open. Sealing the ballot ends your work on this round: nothing can be changed afterwards.";
}

function unansweredLine(place) {
  const { item: id, text } = PACK.items[place];
  const state = model.responses.get(id).skipped ? "skipped" : "open";
  const made = button("", () => open(place));
  made.append(element("span", { textContent: id }), " ", element("span", { textContent: state }), " ",
    element("b", { textContent: text }));
  return element("li", {}, made);
}

// ---- Dialogs ----

let whenSure = null;

function askWhether(title, text, yes, does) {
  $("sure-title").textContent = title;
  $("sure-text").textContent = text;
  $("yes").textContent = yes;
  whenSure = does;
  $("sure").showModal();
  // A stray Enter must not seal.
  $("no").focus();
}

function confirm() {
  const does = whenSure;
  whenSure = null;
  $("sure").close();
  does?.();
}

function closeDialogs() {
  for (const dialog of document.querySelectorAll("dialog")) dialog.close();
}

// ---- Ways to act ----

/** Does something that the person asked for, shows what came of it, and moves the focus where work goes on. */
function act(does) {
  if (model.mode === "stopped") return;
  const { at, mode, ballot } = model;
  const before = { at, mode, isSealed: ballot.isSealed, lines: ballot.lines.length };
  model.notice = null;
  does();
  if (!model.isKept && model.ballot.lines.length > Math.max(before.lines, model.copied)) {
    complain(`${model.notice?.text ?? ""} This browser does not keep it: save a copy.`.trim());
  }
  show();
  if (model.mode !== before.mode || model.at !== before.at || model.ballot.isSealed !== before.isSealed) {
    moveFocus(before);
  }
}

function moveFocus(before) {
  const isOther = model.at !== before.at || before.mode === "summary" || model.mode === "summary";
  const goal = {
    choose: isOther ? "sentence" : "which-title", when: "when-title", reason: "remark", comment: "remark",
    summary: "summary-title", stopped: "stopped-title",
  }[model.mode];
  $(goal).focus({ preventScroll: true });
  if (isOther) window.scrollTo(0, 0);
  else if (model.mode !== "choose") $(goal).closest("fieldset, form")?.scrollIntoView({ block: "nearest" });
}

const MOST_STEPS = 1e9;
const ITEM_KEYS = {
  n: none, a: () => startTyping("reason"), Enter: accept, Escape: back, Backspace: clear, Delete: clear,
  u: undo, s: skip, c: () => startTyping("comment"),
  ArrowLeft: () => stepFrame(-1), ArrowRight: () => stepFrame(1),
  Home: () => stepFrame(-MOST_STEPS), End: () => stepFrame(MOST_STEPS), " ": play,
  "[": holdsFrom, "]": holdsUntil, w: () => (model.draft.frames = null),
  ArrowUp: () => stepView(-1), ArrowDown: () => stepView(1),
  "+": () => zoomBy(1), "=": () => zoomBy(1), "-": () => zoomBy(-1), _: () => zoomBy(-1), z: zoomToChosen,
  h: () => pan(-PAN_STEP, 0), l: () => pan(PAN_STEP, 0), k: () => pan(0, -PAN_STEP), j: () => pan(0, PAN_STEP),
  x: () => (model.outlines = !model.outlines),
  "<": () => stepItem(-1), ">": () => stepItem(1), S: summarise, "?": () => $("keys").showModal(),
};
const SHIFTED = { ArrowLeft: ITEM_KEYS.h, ArrowRight: ITEM_KEYS.l, ArrowUp: ITEM_KEYS.k, ArrowDown: ITEM_KEYS.j };
const SUMMARY_KEYS = {
  u: undo, S: askForSeal, Escape: back, "?": ITEM_KEYS["?"], "<": back, ">": back,
  ArrowUp: () => stepLine(-1), ArrowDown: () => stepLine(1), Enter: () => openLine(),
};

/** Moves the focus along the items without an answer. */
function stepLine(step) {
  const lines = [...$("unanswered").querySelectorAll("button")];
  const now = lines.indexOf(document.activeElement);
  lines[clamp(now + step, 0, lines.length - 1)]?.focus();
}

function openLine() {
  const list = unanswered();
  if (!list.length) return say("Everything is answered: the ballot can be sealed.");
  open(list[0]);
}

/** What a key does now; undefined if nothing. */
function meaningOf(key, isShifted) {
  // Arrows scroll the list where the window is low.
  if ($("keys").open) return /^(Arrow|Page)/.test(key) ? undefined : () => $("keys").close();
  if ($("sure").open) return key === "y" ? confirm : () => $("sure").close();
  if (isTyping()) return { Enter: finishTyping, Escape: back }[key];
  if (model.mode === "summary") return model.ballot.isSealed ? undefined : SUMMARY_KEYS[key];
  if (model.mode === "stopped") return undefined;
  if (/^[0-9]$/.test(key)) return () => digit(key);
  return (isShifted && SHIFTED[key]) || (Object.hasOwn(ITEM_KEYS, key) ? ITEM_KEYS[key] : undefined);
}

/** Keys that the focused element needs for itself. */
function isTakenBy(target, key) {
  const isButton = target.matches?.("button, summary, a");
  return key === "Tab" || key === "Shift" || (isButton && (key === "Enter" || key === " "));
}

document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey || event.isComposing) return;
  if (isTakenBy(event.target, event.key)) return;
  // The form takes Enter by itself.
  if (isTyping() && event.key === "Enter") return;
  const does = meaningOf(event.key, event.shiftKey);
  if (!does) return;
  event.preventDefault();
  act(does);
});

const CLICKS = {
  before: () => stepItem(-1), after: () => stepItem(1), left: summarise, help: () => $("keys").showModal(),
  smaller: () => zoomBy(-1), larger: () => zoomBy(1), closer: zoomToChosen, outlines: ITEM_KEYS.x, play,
  none, ambiguous: ITEM_KEYS.a, clear, "go-on": accept, from: holdsFrom, until: holdsUntil, always: ITEM_KEYS.w,
  save: accept, back, cancel: back, skip, comment: ITEM_KEYS.c, undo, seal: askForSeal, "to-items": back,
  "undo-any": undo, take: download, copy: download, yes: confirm,
};
for (const [id, does] of Object.entries(CLICKS)) $(id).addEventListener("click", () => act(does));
$("resume").addEventListener("click", () => $("file").click());
$("file").addEventListener("change", readCopy);
$("here").addEventListener("click", () => window.location.reload());
$("close-keys").addEventListener("click", () => $("keys").close());
$("no").addEventListener("click", () => $("sure").close());
$("text").addEventListener("submit", (event) => {
  event.preventDefault();
  act(finishTyping);
});
$("slider").addEventListener("input", () => act(() => stepFrame(Number($("slider").value) - model.frame)));
// A button that was clicked must not take the Enter that is meant to save.
document.addEventListener("mousedown", (event) => {
  if (event.target.closest?.("button")) event.preventDefault();
});

/** A drag that began on the picture. */
let drag = null;

canvas.addEventListener("pointerdown", (event) => {
  if (!event.isPrimary || event.button !== 0) return;
  drag = { start: [event.clientX, event.clientY], last: [event.clientX, event.clientY], isFar: false };
  canvas.setPointerCapture(event.pointerId);
});
canvas.addEventListener("pointermove", (event) => {
  const box = canvas.getBoundingClientRect();
  if (!drag) {
    canvas.classList.toggle("object", objectAt(event.clientX - box.left, event.clientY - box.top) > 0);
    return;
  }
  drag.isFar ||= Math.hypot(event.clientX - drag.start[0], event.clientY - drag.start[1]) > 6;
  if (drag.isFar && model.zoom.factor > 1) {
    pan((drag.last[0] - event.clientX) / box.width, (drag.last[1] - event.clientY) / box.height);
    askForDrawing();
  }
  drag.last = [event.clientX, event.clientY];
});
canvas.addEventListener("pointerup", (event) => {
  const box = canvas.getBoundingClientRect();
  const number = drag && !drag.isFar ? objectAt(event.clientX - box.left, event.clientY - box.top) : 0;
  drag = null;
  if (number && !isTyping()) act(() => toggle(number));
});
canvas.addEventListener("pointercancel", () => (drag = null));

// ---- Light and dark ----

const THEMES = ["system", "light", "dark"];
const prefersDark = matchMedia("(prefers-color-scheme: dark)");
let theme = "system";

function paint() {
  document.documentElement.dataset.theme = theme === "system" ? (prefersDark.matches ? "dark" : "light") : theme;
  $("theme").textContent = `Theme: ${theme}`;
}

$("theme").addEventListener("click", () => {
  theme = THEMES[(THEMES.indexOf(theme) + 1) % THEMES.length];
  paint();
});
prefersDark.addEventListener("change", paint);

// ---- Begin ----

/** For tests: what the page knows, and keys. In a text field, anything that is no key is typed. */
window.vote = {
  press(key) {
    if (isTyping() && key !== "Enter" && key !== "Escape") $("remark").value += key;
    else {
      const does = meaningOf(key, false);
      if (does) act(does);
    }
    return window.vote.state();
  },
  state() {
    const { choice } = model.draft;
    return {
      at: model.at, item: item().item, mode: $("sure").open ? "sure" : $("keys").open ? "keys" : model.mode,
      answered: places((response) => response.answer !== null).length,
      skipped: places((response) => response.skipped).length,
      sealed: model.ballot.isSealed, chosen: structuredClone(choice.objects ?? choice), frames: [...holds()],
      view: scene().views[model.view], frame: frameNumber(), message: model.notice?.text ?? "",
    };
  },
  ballot: () => model.ballot.text,
  /** Goes on from the text of a copy, as if its file had been chosen. */
  resume(text) {
    act(() => resumeFrom(text));
    return window.vote.state();
  },
};

paint();
recallBallot();
begin();
show();
new ResizeObserver(askForDrawing).observe($("frame"));
performance.mark("interactive");
