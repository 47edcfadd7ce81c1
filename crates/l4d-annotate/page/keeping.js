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
