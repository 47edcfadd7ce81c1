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
