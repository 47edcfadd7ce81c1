// The sums of other evaluations: tables of their own, named after their protocol and never ranked.

/** The protocol that the address chooses, or undefined for the board of l4d. */
function protocolOf(state) {
  return board.protocols.find((protocol) => protocol.name === state.board);
}

/** What has to be known before any of its numbers is read. */
function protocolNotice(protocol) {
  return el("p", { class: "notice" }, el("strong", {}, `Protocol ${protocol.name}: never ranked.`), ` ${protocol.source}, its sums done again on masks of this benchmark. ${protocol.remark}`);
}

/** What the source leaves out or counts without an answer; methods of which the same is true stand together. */
function leftOut(methods) {
  const shared = new Map();
  for (const method of methods) {
    for (const { what, queries, frames } of method.leftOut) {
      const text = `${counted(frames, "frame", "frames")} of ${counted(queries, "query", "queries")} ${what}.`;
      shared.set(text, [...(shared.get(text) ?? []), method.name]);
    }
  }
  if (shared.size === 0) return null;
  const who = (names) => (names.length === methods.length && names.length > 1 ? "Every method" : names.length > 8 ? `${names.slice(0, 8).join(", ")} and ${names.length - 8} more` : names.join(", "));
  const items = [...shared].map(([text, names]) => el("li", {}, `${who(names)}: ${text}`));
  return [el("h2", {}, "What the source leaves out"), el("ul", { class: "plain" }, items)];
}

/** By the key of a measure; docs/protocols.md has the rules to the end. */
const MEASURES = {
  j_and_f: "Mean of J-Mean and F-Mean: region and contour.",
  j: "IoU of prediction and truth.",
  j_mean: "IoU of prediction and truth, averaged over frames.",
  j_recall: "Share of frames whose IoU is above 0.5.",
  j_decay: "IoU in the first quarter of a clip less that in the last: what is lost on the way. Lower is better.",
  f: "How well the contours of prediction and truth agree.",
  f_mean: "How well the contours of prediction and truth agree, averaged over frames.",
  f_recall: "Share of frames whose agreement of contours is above 0.5.",
  f_decay: "Agreement of contours in the first quarter of a clip less that in the last. Lower is better.",
  miou: "IoU of prediction and truth, averaged as the source does.",
  boundary_miou: "IoU of what lies near the borders of prediction and truth.",
  viou: "IoU summed over the frames in which the target is there, by the number of frames that count.",
  tiou: "IoU of two sets of frames: those in which the target is there, and those in which it is marked.",
  acc: "Share of frames in which the method says rightly whether the target is there.",
  localisation: "Share of pairs of frame and sentence whose most relevant place lies in the box of the target.",
  accuracy: "IoU of prediction and truth over the frames of a sequence; silence where nothing is to be found counts 1.",
};

function aboutMeasure(protocol, { key, title }) {
  return `${MEASURES[key] ?? title} Counted as ${protocol.name} does (${protocol.source}).`;
}

/** Columns of the measures of a protocol; the name of the protocol is in every head. */
function measureColumns(protocol, valueOf) {
  return protocol.measures.map((measure, at) => ({
    key: measure.key,
    title: measure.title,
    over: protocol.name,
    about: aboutMeasure(protocol, measure),
    isNumber: true,
    value: (row) => valueOf(row, at),
    cell: (row) => hundredths(valueOf(row, at)),
  }));
}

function drawProtocolMethod(main, protocol, method) {
  main.append(
    trail([method.name, {}]),
    el("h1", { tabindex: -1 }, `${method.name} under ${protocol.name}`),
    protocolNotice(protocol),
    facts([
      ["Version", method.version],
      ["Remarks", method.reasons.length ? reasons(method) : null],
      ...protocol.measures.map((measure, at) => [`${protocol.name}: ${measure.title}`, hundredths(method.groups["|"][at])]),
      ["Queries with a number", String(method.queries)],
      ["Paper or code", linkTo(method.link)],
    ]),
    el("h2", { id: "groups" }, "By category and scale"),
    protocolGroups(protocol, method),
    el("h2", { id: "scenes" }, "By scene"),
  );
  const holder = el("div", { class: "scroll", tabindex: 0, role: "region", "aria-labelledby": "scenes" });
  main.append(holder);
  const rows = board.scenes.map((scene, at) => ({ scene, values: method.scenes[at] }));
  const columns = [
    sceneColumn(method),
    { key: "scale", title: "Scale", value: (row) => row.scene.scale, cell: (row) => row.scene.scale },
    ...measureColumns(protocol, (row, at) => row.values?.[at]),
  ];
  fillSorted(holder, { caption: `${method.name}, protocol ${protocol.name}, percent`, columns, rows, sort: "name" });
  const told = leftOut([method]);
  if (told) main.append(...told);
}

function protocolGroups(protocol, method) {
  const rows = groupNames().filter(([, category, scale]) => method.groups[`${category}|${scale}`]);
  const lines = rows.map(([name, category, scale]) => {
    const cells = method.groups[`${category}|${scale}`].map((value) => el("td", { class: "number" }, hundredths(value)));
    return el("tr", {}, el("th", { scope: "row" }, name), cells);
  });
  const heads = protocol.measures.map((measure) => headOf({ title: measure.title, over: protocol.name, about: aboutMeasure(protocol, measure) }, { scope: "col", class: "number" }));
  const head = el("tr", {}, headOf({ key: "group", title: "Group" }, { scope: "col" }), heads);
  const table = el("table", {}, captionOf(`Protocol ${protocol.name}, percent, averaged as its source does`), el("thead", {}, head), el("tbody", {}, lines));
  return el("div", { class: "scroll", tabindex: 0, role: "region", "aria-labelledby": "groups" }, table);
}

async function drawProtocolScene(main, protocol, method, scene) {
  main.append(
    trail([method.name, { method: method.name }], [scene.name, {}]),
    el("h1", { tabindex: -1 }, `${scene.name}, ${method.name} under ${protocol.name}`),
    protocolNotice(protocol),
  );
  const holder = el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Queries" }, el("p", {}, "Unpacking the scene."));
  main.append(holder);
  const data = await sceneData(sceneIndex(scene.name));
  const values = data.protocols[protocol.name][method.name];
  // Masks are those of the board of l4d: a method that is not on it has none to show.
  const hasMasks = board.methods[methodIndex(method.name)]?.isDetailed;
  const rows = scene.queries.map((query, at) => ({ query, values: values[at] }));
  const columns = [
    { key: "number", title: "Query", value: (row) => row.query.number, cell: (row) => row.query.number },
    {
      key: "text",
      title: "Sentence",
      isHead: true,
      value: (row) => row.query.text,
      cell: ({ query }) => (hasMasks ? el("a", { href: hrefTo({ method: method.name, scene: scene.name, query: query.number }) }, query.text) : query.text),
    },
    { key: "category", title: "Category", value: (row) => row.query.categories.join(", "), cell: (row) => row.query.categories.join(", ") },
    ...measureColumns(protocol, (row, at) => row.values?.[at]),
  ];
  fillSorted(holder, { caption: `${counted(rows.length, "query", "queries")} of ${scene.name}, protocol ${protocol.name}, percent; a dash where the source has no number`, columns, rows, sort: "number" });
}

/** What a protocol says of one query, beside the numbers of l4d. */
function protocolFacts(protocol, method, data, place) {
  const values = data.protocols[protocol.name]?.[method.name]?.[place];
  if (!values) return [];
  return protocol.measures.map((measure, at) => [`${protocol.name}: ${measure.title}`, hundredths(values[at])]);
}
