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
