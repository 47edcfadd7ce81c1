// One query: what was asked, what the method marked, frame by frame, and what the others did.

async function drawQuery(main, method, scene, query) {
  const place = scene.queries.indexOf(query);
  main.append(
    trail([method.name, { method: method.name }], [scene.name, { method: method.name, scene: scene.name }], [query.number, {}]),
    el("h1", { tabindex: -1 }, `\u201c${query.text}\u201d`),
  );
  const waiting = el("p", {}, "Unpacking the scene.");
  main.append(waiting);
  const data = await sceneData(sceneIndex(scene.name));
  const view = { method, scene, query, place, data, answers: data.answers[methodIndex(method.name)] };
  waiting.remove();
  main.append(queryFacts(view));
  drawFrames(main, view);
  main.append(neighbours(view));
}

function queryFacts({ method, scene, query, place, data, answers }) {
  const protocol = protocolOf(readAddress());
  const own = protocol ? `${board.protocol}: ` : "";
  const spans = query.frames.map(([first, last]) => `${first} to ${last}`).join(", ");
  const values = answers.ratios[place];
  return facts([
    ["Method", choiceOfMethod(method, scene, query)],
    ["Category", query.categories.join(", ")],
    ["Means", query.referents.join(", ")],
    ["Asked for in frames", query.gated ? spans : "the whole clip"],
    ["Prompt", query.verified ? "verified by people" : "not verified by people"],
    [`${own}mIoU`, hundredths(values[MIOU])],
    [`${own}tube IoU`, hundredths(values[METRICS.findIndex((metric) => metric.key === "tube_iou")])],
    ...(protocol ? protocolFacts(protocol, method, data, place) : []),
    ["Took", el("span", {}, takenCell({ query, values, taken: answers.taken[place] }))],
  ]);
}

function choiceOfMethod(method, scene, query) {
  const options = board.methods.filter((other) => other.isDetailed).map((other) => [other.name, other.name]);
  const go = (name) => {
    location.hash = hrefWith({ method: name, scene: scene.name, query: query.number });
  };
  const label = choice("", options, method.name, go);
  label.querySelector("select").setAttribute("aria-label", "Method whose answer is shown");
  return label;
}

/** What is drawn; the choice lasts as long as the page. */
const layers = { truth: true, prediction: true, picture: true, colour: true };

function drawFrames(main, view) {
  const { scene, place, data, answers } = view;
  const masks = answers.masks[place];
  const codes = answers.frames[place];
  const hasPictures = data.backdrops.some(Boolean);
  // Ready before they are asked for: paper does not wait.
  data.backdrops.filter(Boolean).forEach(pictureOf);
  const canvas = el("canvas", { role: "img", width: scene.width, height: scene.height });
  const legend = el("figcaption", {});
  const chart = el("div", {});
  const told = el("output", {});
  const slider = el("input", { type: "range", min: 0, max: scene.shown.length - 1, step: 1, "aria-label": "Frame", "aria-keyshortcuts": "Space" });
  const strip = el("ul", { class: "strip" });
  const others = el("ul", { class: "all" });
  const drawOthers = fillOthers(others, view, layers);
  const wanted = scene.shown.indexOf(Number(readAddress().frame || NaN));
  let at = wanted >= 0 ? wanted : firstOfInterest(data.targets[place]);

  const codeAt = (shownAt) => codes[scene.frames.indexOf(scene.shown[shownAt])];
  const targetAt = (frameAt) => {
    const code = codes[frameAt];
    return code !== undefined && (code >= 0 || code === -1);
  };
  const show = (next) => {
    at = next;
    const frame = scene.shown[at];
    slider.value = String(at);
    const text = `frame ${frame}: ${stateOf(codeAt(at))}`;
    slider.setAttribute("aria-valuetext", text);
    told.textContent = text;
    canvas.setAttribute("aria-label", `Prediction and truth at ${text}`);
    legend.textContent = masks ? "" : "The masks of this method were not at hand when the page was made, or are no longer those that were scored; the truth is shown alone.";
    const factor = Math.max(1, Math.min(4, Math.round(768 / scene.width)));
    paint(canvas, sightOf(data, place, masks, at, scene), layers, factor);
    chart.replaceChildren(timeline(scene.frames, codes, targetAt, frame, (picked) => move(nearest(scene.shown, picked))));
    for (const [index, button] of [...strip.querySelectorAll("button")].entries()) {
      button.setAttribute("aria-current", String(index === at));
    }
    drawOthers(at);
    // Browsers allow few changes of the address a second.
    if (timer === null) noteInAddress({ frame: String(frame) });
  };
  const last = scene.shown.length - 1;
  let timer = null;
  const isPlaying = () => timer !== null;
  const stop = () => {
    clearInterval(timer);
    timer = null;
    button.textContent = "Play";
    told.removeAttribute("aria-live");
  };
  /** From the frame in sight to the end of the clip, or from its beginning where that is the end. */
  const play = () => {
    timer = setInterval(() => {
      // Another view is open.
      if (!canvas.isConnected) return clearInterval(timer);
      if (at + 1 === last) stop();
      show(at + 1);
    }, playMs());
    button.textContent = "Pause";
    told.setAttribute("aria-live", "off");
    if (at === last) show(0);
  };
  const toggle = () => {
    if (!isPlaying()) return play();
    stop();
    show(at);
  };
  const button = el("button", { type: "button", class: "play", "aria-keyshortcuts": "Space", onclick: toggle }, "Play");
  const move = (next) => {
    if (isPlaying()) stop();
    show(Math.max(0, Math.min(last, next)));
  };
  slider.addEventListener("input", () => move(Number(slider.value)));
  const redraw = () => {
    fillStrip(strip, view, layers, codeAt, move);
    show(at);
  };

  const picture = el("figure", { class: "picture" }, canvas, legend);
  const moment = el("div", { class: "moment" }, last > 0 ? button : null, slider, told);
  /** Space plays, except where it means something already. */
  const pressed = (event) => {
    if (event.key !== " " || last === 0 || event.target.closest("button, summary, input[type=checkbox]")) return;
    event.preventDefault();
    toggle();
  };
  main.append(
    el("h2", {}, "Frames"),
    el(
      "div",
      { class: "stage", tabindex: -1, onkeydown: pressed },
      el("div", {}, picture, moment, overlayKey()),
      el("div", {}, layerSwitches(layers, hasPictures, redraw), el("h3", {}, "IoU over the clip, %"), chart, el("p", { class: "small quiet" }, "Shaded: there is something to find. Crosses: something was marked where there is nothing. Click to go there."), frameTable(scene, codes)),
    ),
    strip,
    el("h2", {}, "All methods at this frame"),
    others,
  );
  redraw();
}

/** How long a frame stays in sight: long enough to read its IoU, and longer where less motion is asked for. */
function playMs() {
  return matchMedia("(prefers-reduced-motion: reduce)").matches ? 1200 : 400;
}

/** The middle of the frames that show the target. */
function firstOfInterest(targets) {
  const present = targets.map((target, at) => (target >= 0 ? at : null)).filter((at) => at !== null);
  return present.length > 0 ? present[Math.floor(present.length / 2)] : 0;
}

function nearest(frames, wanted) {
  return frames.reduce((best, frame, at) => (Math.abs(frame - wanted) < Math.abs(frames[best] - wanted) ? at : best), 0);
}

function layerSwitches(layers, hasPictures, redraw) {
  const one = (key, text) => {
    const box = el("input", { type: "checkbox", checked: layers[key], onchange: () => { layers[key] = box.checked; redraw(); } });
    return el("label", {}, box, text);
  };
  return el(
    "fieldset",
    { class: "layers" },
    el("legend", { class: "unseen" }, "What is drawn"),
    one("truth", "truth"),
    one("prediction", "prediction"),
    hasPictures ? [one("picture", "picture"), one("colour", "in colour")] : null,
  );
}

/** The same as the chart, in words. */
function frameTable(scene, codes) {
  const rows = scene.frames.map((frame, at) => el("tr", {}, el("th", { scope: "row" }, String(frame)), el("td", {}, stateOf(codes[at]))));
  const head = el("tr", {}, headOf({ key: "frame", title: "Frame" }, { scope: "col" }), headOf({ key: "state", title: "What happened" }, { scope: "col" }));
  return el("details", {}, el("summary", {}, "Every frame in words"), el("table", {}, captionOf("Frames of the clip"), el("thead", {}, head), el("tbody", {}, rows)));
}

function fillStrip(strip, { scene, place, data, answers }, layers, codeAt, move) {
  const items = scene.shown.map((frame, at) => {
    const canvas = el("canvas", { width: scene.width, height: scene.height, "aria-hidden": "true" });
    whenSeen(canvas, () => paint(canvas, sightOf(data, place, answers.masks[place], at, scene), layers, 1));
    const button = el("button", { type: "button", onclick: () => move(at) }, canvas, `frame ${frame}: ${stateOf(codeAt(at))}`);
    return el("li", {}, button);
  });
  strip.replaceChildren(...items);
}

/** Lists all methods, best first; gives what draws them at a frame, over what they showed before. */
function fillOthers(list, { method, scene, query, place, data }, layers) {
  const entries = Object.entries(data.answers).map(([index, answers]) => ({ other: board.methods[Number(index)], answers }));
  const miou = ({ answers }) => answers.ratios[place][MIOU] ?? -1;
  entries.sort((a, b) => miou(b) - miou(a) || a.other.name.localeCompare(b.other.name));
  const items = entries.map(({ other, answers }) => {
    const canvas = el("canvas", { width: scene.width, height: scene.height, "aria-hidden": "true" });
    const isThis = other.name === method.name;
    const name = el(isThis ? "strong" : "a", {}, breakable(other.name));
    const score = el("span", { class: "quiet" });
    const item = el("li", {}, canvas, el("span", { class: "name" }, name), score, other.rank === null ? el("span", { class: "chips" }, el("span", { class: "chip" }, "not ranked")) : null);
    const drawAt = (at) => {
      const frame = scene.shown[at];
      whenSeen(canvas, () => paint(canvas, sightOf(data, place, answers.masks[place], at, scene), layers, 1));
      if (!isThis) name.href = hrefWith({ method: other.name, scene: scene.name, query: query.number, frame: String(frame) });
      score.textContent = ` mIoU ${hundredths(answers.ratios[place][MIOU])}; here ${stateOf(answers.frames[place][scene.frames.indexOf(frame)])}`;
    };
    return { item, drawAt };
  });
  list.replaceChildren(...items.map(({ item }) => item));
  return (at) => items.forEach(({ drawAt }) => drawAt(at));
}

function neighbours({ method, scene, query }) {
  const at = scene.queries.indexOf(query);
  const step = (other, text) =>
    other ? el("a", { href: hrefTo({ method: method.name, scene: scene.name, query: other.number }) }, `${text}: ${other.number}`) : null;
  return el("nav", { class: "steps", "aria-label": "Other queries of this scene" }, step(scene.queries[at - 1], "Previous query"), step(scene.queries[at + 1], "Next query"));
}
