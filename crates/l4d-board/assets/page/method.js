// One method: where it is strong and weak, scene by scene; and one scene of it, query by query.

/** The steps to a view; those of a protocol lead over its table. */
function trail(...steps) {
  const protocol = protocolOf(readAddress());
  const first = protocol ? [["Leaderboard", { board: "" }], [protocol.name, {}]] : [["Leaderboard", {}]];
  return trailOf([...first, ...steps]);
}

function trailOf(steps) {
  const links = steps.map(([text, target], at) => {
    const isLast = at === steps.length - 1;
    return el("li", {}, isLast ? el("span", { "aria-current": "page" }, text) : el("a", { href: hrefTo(target) }, text));
  });
  return el("nav", { class: "trail", "aria-label": "Where you are" }, el("ol", {}, links));
}

function drawMethod(main, method) {
  main.append(trail([method.name, {}]), el("h1", { tabindex: -1 }, method.name), methodFacts(method));
  main.append(el("h2", { id: "groups" }, "By category and scale"), groupTable(method));
  const holder = el("div", { class: "scroll", tabindex: 0, role: "region", "aria-labelledby": "scenes" });
  main.append(el("h2", { id: "scenes" }, "By scene"), holder, download("Download CSV of all queries", () => `${method.name}.csv`, () => allQueries(method)));
  fillScenes(holder, method);
}

function methodFacts(method) {
  const rank = method.rank === null ? "not ranked" : String(method.rank);
  return facts([
    ["Rank", method.reasons.length ? [rank, reasons(method)] : rank],
    ["Track", trackTitle(method)],
    ["Version", method.version],
    ["mIoU", valueCell(cellOf(method, MIOU))],
    ["Time", duration(method.seconds)],
    ["Paper or code", linkTo(method.link)],
    ["Under the rules of others", otherProtocols(method)],
  ]);
}

/** With whom a method is ranked. */
function trackTitle(method) {
  return board.tracks.find(({ key }) => key === method.track).title;
}

function linkTo(link) {
  return link ? el("a", { href: link, rel: "noreferrer noopener" }, link) : null;
}

/** Protocols that judged a method, as links. */
function otherProtocols(method) {
  const judging = board.protocols.filter((protocol) => protocol.methods.some((other) => other.name === method.name));
  if (judging.length === 0) return null;
  return judging.flatMap((protocol, at) => [at > 0 ? ", " : null, el("a", { href: hrefTo({ board: protocol.name, method: method.name }) }, protocol.name)]);
}

/** Groups of queries that tables go down: `[name, category, scale]`. */
function groupNames() {
  return [
    ["All queries", "", ""],
    ...CATEGORIES.map((category) => [category, category, ""]),
    ...SCALES.map((scale) => [scale, "", scale]),
  ];
}

/** Metrics down, groups across would be wide: groups down, one row each, with bars of mIoU. */
function groupTable(method) {
  const rows = groupNames().filter(([, category, scale]) => method.groups[`${category}|${scale}`]);
  const number = { scope: "col", class: "number" };
  const heads = METRICS.map((metric) => headOf({ key: metric.key, title: metric.title }, number));
  const lines = rows.map(([name, category, scale]) => {
    const cells = METRICS.map((_, at) => el("td", { class: "number" }, valueCell(cellOf(method, at, category, scale))));
    const miou = cellOf(method, MIOU, category, scale);
    const queries = el("td", { class: "number" }, miou ? String(miou[3]) : "\u2013");
    return el("tr", {}, el("th", { scope: "row" }, name), queries, el("td", { class: "drawn" }, bar(miou, method.rank !== null)), cells);
  });
  const head = el("tr", {}, headOf({ key: "group", title: "Group" }, { scope: "col" }), headOf({ key: "queries", title: "Queries" }, number), headOf({ key: "bar", title: "mIoU, 0 to 100" }, { scope: "col", class: "drawn" }), heads);
  const table = el("table", {}, captionOf(`Percent; ${intervalNote()}`), el("thead", {}, head), el("tbody", {}, lines));
  return el("div", { class: "scroll", tabindex: 0, role: "region", "aria-labelledby": "groups" }, table);
}

function fillScenes(holder, method) {
  const rows = board.scenes.map((scene, at) => ({ scene, values: method.scenes[at] }));
  const columns = [
    sceneColumn(method),
    { key: "scale", title: "Scale", value: (row) => row.scene.scale, cell: (row) => row.scene.scale },
    { key: "queries", title: "Queries", isNumber: true, value: (row) => row.scene.queries.length, cell: (row) => String(row.scene.queries.length) },
    ...METRICS.map((metric, at) => ({
      key: metric.key,
      title: metric.title,
      isNumber: true,
      higher: metric.higher,
      value: (row) => row.values?.[at],
      cell: (row) => hundredths(row.values?.[at]),
    })),
  ];
  fillSorted(holder, { caption: `${method.name}, percent, means over the queries of a scene`, columns, rows, sort: "name" });
}

/** The name of a scene behind a small picture of it; both lead to what the method did there. */
function sceneColumn(method) {
  const cell = ({ scene }) => {
    const content = [thumbnail(scene), el("span", {}, breakable(scene.name))];
    return method.isDetailed ? el("a", { class: "scene", href: hrefTo({ method: method.name, scene: scene.name }) }, content) : el("span", { class: "scene" }, content);
  };
  return { key: "name", title: "Scene", about: ABOUT.scene, isHead: true, value: (row) => row.scene.name, cell };
}

async function drawScene(main, method, scene) {
  const at = sceneIndex(scene.name);
  main.append(
    trail([method.name, { method: method.name }], [scene.name, {}]),
    el("h1", { tabindex: -1 }, `${scene.name}, ${method.name}`),
  );
  const holder = el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Queries" }, el("p", {}, "Unpacking the scene."));
  main.append(holder);
  const data = await sceneData(at);
  const rows = queryRows(method, scene, data);
  fillSorted(holder, { caption: `${counted(rows.length, "query", "queries")} of ${scene.name}, percent`, columns: queryColumns(method), rows, sort: "number" });
  main.append(download("Download CSV", () => `${method.name}-${scene.name}.csv`, () => holder.csv()));
}

/** The queries of every scene as a file. Scenes that were not opened are unpacked one after another and not kept. */
async function allQueries(method) {
  const rows = [];
  for (const [at, scene] of board.scenes.entries()) rows.push(...queryRows(method, scene, await (unpacked.get(at) ?? unpackScene(at))));
  return csvOf([{ key: "scene", value: (row) => row.scene.name }, ...queryColumns(method)], rows);
}

function queryRows(method, scene, data) {
  const answers = data.answers[methodIndex(method.name)];
  return scene.queries.map((query, at) => ({ scene, query, values: answers.ratios[at], taken: answers.taken[at] }));
}

function queryColumns(method) {
  return [
    { key: "number", title: "Query", value: (row) => row.query.number, cell: (row) => row.query.number },
    {
      key: "text",
      title: "Sentence",
      isHead: true,
      value: (row) => row.query.text,
      cell: (row) => el("a", { href: hrefTo({ method: method.name, scene: row.scene.name, query: row.query.number }) }, row.query.text),
    },
    { key: "category", title: "Category", value: (row) => row.query.categories.join(", "), cell: (row) => row.query.categories.join(", ") },
    ...METRICS.map((metric, at) => at).filter((at) => at !== SELECT).map((at) => ({
      key: METRICS[at].key,
      title: METRICS[at].title,
      isNumber: true,
      higher: METRICS[at].higher,
      value: (row) => row.values[at],
      cell: (row) => hundredths(row.values[at]),
    })),
    { key: "taken", title: "Took", value: (row) => row.taken, cell: takenCell },
  ];
}

function takenCell({ query, values, taken }) {
  if (taken === null) return el("span", { class: "quiet" }, "nothing");
  if (values[SELECT] === 100) return taken;
  const isMeant = query.referents.includes(taken);
  return [taken, " ", el("span", { class: "chip warn" }, isMeant ? "tied" : "not meant")];
}
