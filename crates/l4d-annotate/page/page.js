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
