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
