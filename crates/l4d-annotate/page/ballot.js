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
