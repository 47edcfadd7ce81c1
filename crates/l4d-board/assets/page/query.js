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

function drawFrames(main, view) {
  const { scene, place, data, answers } = view;
  const masks = answers.masks[place];
  const codes = answers.frames[place];
  const layers = { truth: true, prediction: true, picture: true };
  const hasPictures = data.backdrops.some(Boolean);
  // Ready before they are asked for: paper does not wait.
  data.backdrops.filter(Boolean).forEach(pictureOf);
  const canvas = el("canvas", { role: "img", width: scene.width, height: scene.height });
  const legend = el("figcaption", {});
  const chart = el("div", {});
  const told = el("output", {});
  const slider = el("input", { type: "range", min: 0, max: scene.shown.length - 1, step: 1, "aria-label": "Frame" });
  const strip = el("ul", { class: "strip" });
  const others = el("ul", { class: "all" });
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
    fillOthers(others, view, at, layers);
    noteInAddress({ frame: String(frame) });
  };
  const move = (next) => show(Math.max(0, Math.min(scene.shown.length - 1, next)));
  slider.addEventListener("input", () => move(Number(slider.value)));
  const redraw = () => {
    fillStrip(strip, view, layers, codeAt, move);
    show(at);
  };

  const picture = el("figure", { class: "picture" }, canvas, legend);
  const moment = el("div", { class: "moment" }, slider, told);
  main.append(
    el("h2", {}, "Frames"),
    el(
      "div",
      { class: "stage" },
      el("div", {}, picture, moment, overlayKey()),
      el("div", {}, layerSwitches(layers, hasPictures, redraw), el("h3", {}, "IoU over the clip, %"), chart, el("p", { class: "small quiet" }, "Shaded: there is something to find. Crosses: something was marked where there is nothing. Click to go there."), frameTable(scene, codes)),
    ),
    strip,
    el("h2", {}, "All methods at this frame"),
    others,
  );
  redraw();
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
    const box = el("input", { type: "checkbox", checked: true, onchange: () => { layers[key] = box.checked; redraw(); } });
    return el("label", {}, box, text);
  };
  return el(
    "fieldset",
    { class: "layers" },
    el("legend", { class: "unseen" }, "What is drawn"),
    one("truth", "truth"),
    one("prediction", "prediction"),
    hasPictures ? one("picture", "picture") : null,
  );
}

/** The same as the chart, in words. */
function frameTable(scene, codes) {
  const rows = scene.frames.map((frame, at) => el("tr", {}, el("th", { scope: "row" }, String(frame)), el("td", {}, stateOf(codes[at]))));
  const head = el("tr", {}, el("th", { scope: "col" }, "Frame"), el("th", { scope: "col" }, "What happened"));
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

function fillOthers(list, { method, scene, query, place, data }, at, layers) {
  const frame = scene.shown[at];
  const frameAt = scene.frames.indexOf(frame);
  const entries = Object.entries(data.answers).map(([index, answers]) => ({ other: board.methods[Number(index)], answers }));
  const miou = ({ answers }) => answers.ratios[place][MIOU] ?? -1;
  entries.sort((a, b) => miou(b) - miou(a) || a.other.name.localeCompare(b.other.name));
  const items = entries.map(({ other, answers }) => {
    const canvas = el("canvas", { width: scene.width, height: scene.height, "aria-hidden": "true" });
    whenSeen(canvas, () => paint(canvas, sightOf(data, place, answers.masks[place], at, scene), layers, 1));
    const isThis = other.name === method.name;
    const name = isThis
      ? el("strong", {}, breakable(other.name))
      : el("a", { href: hrefWith({ method: other.name, scene: scene.name, query: query.number, frame: String(frame) }) }, breakable(other.name));
    const score = ` mIoU ${hundredths(answers.ratios[place][MIOU])}; here ${stateOf(answers.frames[place][frameAt])}`;
    return el("li", {}, canvas, el("span", { class: "name" }, name), el("span", { class: "quiet" }, score), other.rank === null ? el("span", { class: "chips" }, el("span", { class: "chip" }, "not ranked")) : null);
  });
  list.replaceChildren(...items);
}

function neighbours({ method, scene, query }) {
  const at = scene.queries.indexOf(query);
  const step = (other, text) =>
    other ? el("a", { href: hrefTo({ method: method.name, scene: scene.name, query: other.number }) }, `${text}: ${other.number}`) : null;
  return el("nav", { class: "steps", "aria-label": "Other queries of this scene" }, step(scene.queries[at - 1], "Previous query"), step(scene.queries[at + 1], "Next query"));
}
