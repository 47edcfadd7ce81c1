// The board: who stands where, in the group of queries that the filters choose.

function drawBoard(main) {
  const title = el("h2", { id: "ranking" });
  const about = el("div", {});
  const told = el("div", {});
  main.append(el("h1", { tabindex: -1 }, `${board.benchmark} ${board.version}`), told, title, about);
  const holder = el("div", { class: "scroll", tabindex: 0, role: "region", "aria-labelledby": "ranking" });
  const below = el("div", {});
  const count = el("p", { class: "count quiet small" });
  const fill = () => {
    const table = chosenTable(readAddress());
    title.textContent = table.title;
    told.replaceChildren(headingFacts(table));
    about.replaceChildren(table.about);
    fillBoard(holder, count, table);
    below.replaceChildren();
    if (table.protocol) below.append(...(leftOut(table.methods) ?? []));
    else drawComparison(below);
  };
  const redraw = (changes) => {
    noteInAddress(changes);
    fill();
    say(`${title.textContent}: ${count.textContent}`);
  };
  const file = () => ["leaderboard", readAddress().board].filter(Boolean).join("-") + ".csv";
  main.append(filters(redraw, count), holder, download("Download CSV", file, () => holder.csv()), below);
  fill();
  drawPublished(main);
  drawSubmission(main);
}

/** What the first filter chooses: the board, the sums of another protocol, or methods that were scored on something else. */
function chosenTable(state) {
  const protocol = protocolOf(state);
  if (protocol) {
    const none = protocol.measures.map(() => null);
    return {
      protocol,
      title: `Under the rules of others: ${protocol.name}`,
      about: protocolNotice(protocol),
      line: protocol.line,
      methods: protocol.methods,
      metrics: protocol.measures,
      cells: (method) => (method.groups[`${state.category}|${state.scale}`] ?? none).map((value) => (value === null ? null : [value, null, null])),
      queries: (method) => method.queries,
    };
  }
  const line = (text) => el("p", { class: "quiet" }, text);
  return {
    title: "Ranking",
    about: line("Percent, means over queries; " + intervalNote() + " Ranked by mIoU within each track: methods that learned from rendered depth are not ranked with those that did not. Equal printed values share a rank. Choose a method to see what it did." + (board.methods.some((method) => method.rank !== null) ? "" : " No method is ranked yet.")),
    line: board.line,
    methods: board.methods,
    metrics: METRICS,
    cells: (method) => METRICS.map((_, metric) => cellOf(method, metric, state.category, state.scale)),
    queries: (method) => cellOf(method, MIOU, state.category, state.scale)?.[3] ?? 0,
  };
}

function headingFacts({ protocol }) {
  const share = board.queries > 0 ? board.verified / board.queries : 0;
  const meter = svg("svg", { class: "share", viewBox: "0 0 100 6", preserveAspectRatio: "none", "aria-hidden": "true" });
  meter.append(svg("rect", { class: "dot", x: 0, y: 0, width: 100 * share, height: 6 }));
  const verified = [meter, `${board.verified} of ${board.queries} (${Math.round(100 * share)} %)`];
  return facts([
    ["Protocol", protocol ? protocol.name : board.protocol],
    ["Profile", board.profile],
    ["Queries", `${board.queries} in ${counted(board.scenes.length, "scene", "scenes")}${board.rejected ? `; ${board.rejected} rejected by people are left out` : ""}`],
    ["Prompts verified by people", verified],
    ["Truth", el("code", { title: board.truthDigest }, board.truthDigest.slice(0, 12))],
    ["Date", board.day],
  ]);
}

function facts(pairs) {
  const entries = pairs.filter(([, value]) => value !== null && value !== "");
  return el("dl", { class: "facts" }, entries.map(([term, value]) => el("div", {}, el("dt", {}, term), el("dd", {}, value))));
}

/** This board first, then the protocols of others. */
function boardOptions() {
  const own = ["", `${board.protocol} \u00b7 ${board.profile} \u00b7 ${board.version}`];
  const protocols = board.protocols.map(({ name }) => [name, `${name} \u00b7 ${board.profile} \u00b7 never ranked`]);
  return [own, ...protocols];
}

function filters(redraw, count) {
  const state = readAddress();
  const capital = (word) => [word, word[0].toUpperCase() + word.slice(1)];
  const search = el("input", { type: "search", value: state.find, oninput: () => redraw({ find: search.value }) });
  const hasOthers = board.protocols.length > 0;
  return el(
    "form",
    { class: "filters", onsubmit: (event) => event.preventDefault() },
    choice("Protocol and profile", boardOptions(), state.board, (value) => redraw({ board: value })),
    choice("Category", [["", "All categories"], ...CATEGORIES.map(capital)], state.category, (value) => redraw({ category: value })),
    choice("Scale", [["", "All scales"], ...SCALES.map(capital)], state.scale, (value) => redraw({ scale: value })),
    el("label", {}, "Method", search),
    count,
    hasOthers ? null : el("span", { class: "unseen" }, "There is one protocol and profile."),
  );
}

/** More rows than these are drawn only when they are asked for. */
const MANY = 250;

function fillBoard(holder, count, table, most = MANY) {
  const state = readAddress();
  const wanted = state.find.trim().toLowerCase();
  const methods = table.methods.filter((method) => method.name.toLowerCase().includes(wanted));
  const rows = methods.map((method) => ({ method, cells: table.cells(method) }));
  const sections = table.protocol ? [{ title: null, rows }] : groupsOf(rows);
  const columns = table.protocol ? protocolColumns(table.protocol) : boardColumns();
  // An order by a column that this table lacks is an order of another one.
  const hasColumn = columns.some((column) => column.key === state.sort.replace(/^-/, ""));
  const sort = hasColumn ? state.sort : table.protocol ? "" : "-miou";
  const change = (next) => {
    noteInAddress({ sort: next });
    fillBoard(holder, count, table, most);
    say(sortedBy(columns, next));
  };
  const queries = Math.max(0, ...methods.map(table.queries));
  const group = [state.category, state.scale].filter(Boolean).join(", ") || "all queries";
  const caption = table.protocol ? `${table.line}. Shown: ${group}.` : `${table.line}. Shown: ${group} (${queries}).`;
  holder.csv = () => csvOf(columns, sections.flatMap(({ rows }) => inOrder(rows, columns, sort)));
  const shown = sections.filter((section) => section.rows.length > 0);
  redrawTable(holder, () => {
    if (shown.length === 0) return el("p", {}, "No method matches.");
    return sortableTable({ caption, columns, sections: shown, sort, change, most });
  });
  if (methods.length > most) {
    const all = () => fillBoard(holder, count, table, methods.length);
    holder.append(el("button", { type: "button", onclick: all }, `Show all ${methods.length} methods`));
  }
  const asked = table.protocol ? "" : `, ${counted(queries, "query", "queries")}`;
  count.textContent = counted(methods.length, "method", "methods") + asked;
}

/** The ranked methods of each track, the headline track first, then those without a rank. */
function groupsOf(rows) {
  const ranked = rows.filter((row) => row.method.rank !== null);
  const tracks = board.tracks.map(({ key, title }) => ({ title: `Track: ${title}`, rows: ranked.filter((row) => row.method.track === key) }));
  for (const track of tracks) {
    const best = bestValues(track.rows);
    for (const row of track.rows) row.best = best;
  }
  return [...tracks, { title: "Not ranked, shown for scale", rows: rows.filter((row) => row.method.rank === null) }];
}

/** The best printed value of each metric; none where there are no two values to compare, or where they are of one scene. */
function bestValues(rows) {
  return METRICS.map((metric, at) => {
    const values = rows.map((row) => row.cells[at]).filter((cell) => cell && !isOfOneScene(cell)).map((cell) => cell[0]);
    if (values.length < 2) return null;
    return metric.higher ? Math.max(...values) : Math.min(...values);
  });
}

/** Metrics that a phone shows in the first line of a method. */
const MAIN = ["miou", "macc", "tube_iou", "select"];

function boardColumns() {
  const metric = (at) => ({
    key: METRICS[at].key,
    title: METRICS[at].title,
    isNumber: true,
    isMinor: !MAIN.includes(METRICS[at].key),
    higher: METRICS[at].higher,
    value: (row) => row.cells[at]?.[0],
    fields: ["", "_low", "_high"].map((end, place) => [METRICS[at].key + end, (row) => row.cells[at]?.[place]]),
    cell: (row) => valueCell(row.cells[at], row.cells[at]?.[0] === row.best?.[at]),
  });
  return [
    {
      key: "rank",
      title: "Rank",
      isNumber: true,
      higher: false,
      value: (row) => row.method.rank,
      cell: (row) => (row.method.rank === null ? "\u2013" : String(row.method.rank)),
    },
    methodColumn([["track", (row) => row.method.track], ["unranked_because", (row) => row.method.reasons.join(", ")]]),
    metric(MIOU),
    { key: "bar", title: "mIoU, 0 to 100", isDrawn: true, cell: (row) => bar(row.cells[MIOU], row.method.rank !== null) },
    ...METRICS.map((_, at) => at).filter((at) => at !== MIOU).map(metric),
    {
      key: "seconds",
      title: "Time",
      isNumber: true,
      isMinor: true,
      higher: false,
      value: (row) => row.method.seconds,
      cell: (row) => duration(row.method.seconds),
    },
  ];
}

function protocolColumns(protocol) {
  return [
    methodColumn([]),
    ...measureColumns(protocol, (row, at) => row.cells[at]?.[0]),
    { key: "queries", title: "Queries", about: "Queries that enter at least one number.", isNumber: true, value: (row) => row.method.queries, cell: (row) => String(row.method.queries) },
  ];
}

function methodColumn(more) {
  const name = (row) => row.method.name;
  return { key: "name", title: "Method", about: ABOUT.method, isHead: true, value: name, cell: methodCell, fields: [["method", name], ["version", (row) => row.method.version], ...more] };
}

function methodCell({ method }) {
  const name = method.isDetailed || method.leftOut ? el("a", { href: hrefTo({ method: method.name }) }, breakable(method.name)) : el("span", {}, breakable(method.name));
  const version = method.version ? el("span", { class: "quiet small" }, ` ${method.version}`) : null;
  return [name, version, reasons(method)];
}

function reasons(method) {
  if (method.reasons.length === 0) return null;
  const text = { "used ground truth": "uses the truth", "saw the held-out view": "saw the held-out view", partial: "partial" };
  return el("span", { class: "chips" }, method.reasons.map((reason) => el("span", { class: "chip warn" }, text[reason] ?? reason)));
}

function drawPublished(main) {
  if (board.published.length === 0) return;
  main.append(
    el("h2", {}, "As reported by papers"),
    el("p", { class: "notice" }, "Numbers of the authors, on their own data: other scenes, other prompts, other masks. Nothing here can be compared with the ranking above."),
  );
  for (const table of board.published) {
    const heads = table.columns.map((column) => headOf({ title: column, about: `What the paper reports for ${column}, on its own data.` }, { scope: "colgroup", colspan: 2, class: "number" }));
    const units = table.columns.flatMap(() => ["mAcc", "mIoU"]).map((title) => headOf({ title, about: `${title} in percent, as the paper defines and reports it.` }, { scope: "col", class: "number" }));
    const rows = table.rows.map((row) =>
      el("tr", {}, el("th", { scope: "row" }, row.setting), row.values.map((value) => el("td", { class: "number" }, hundredths(value)))),
    );
    const head = el("thead", {}, el("tr", {}, headOf({ title: "Setting", about: "The method or the setting that the paper reports in this row." }, { scope: "col", rowspan: 2 }), heads), el("tr", {}, units));
    const caption = captionOf("As reported, percent");
    main.append(
      el("details", {}, el("summary", {}, table.title), el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": table.title }, el("table", {}, caption, head, el("tbody", {}, rows)))),
    );
  }
}

function drawSubmission(main) {
  const code = (text) => el("code", {}, text);
  const options = `--profile ${board.profile}`;
  const steps = [
    [code(`l4d init-results NAME ${options}`), " begins the folder ", code("results/NAME"), ". Fill in its ", code("method.json"), ": version, link, time, and what the method looked at."],
    ["Write the masks of every query below ", code("results/NAME/masks"), ", one file or one folder of pictures a query, as ", code("docs/formats.md"), " describes."],
    [code(`l4d check-results results/NAME ${options}`), " says what is missing or cannot be read."],
    [code(`l4d score results ${options}`), " counts, and ", code(`l4d leaderboard ${options} --html`), " shows the method on a page like this one."],
    ["Open a pull request that adds ", code("results/NAME"), " (", code("git add --force results/NAME"), ", since results are ignored otherwise)."],
  ];
  main.append(
    el("h2", { id: "submit" }, "How to submit"),
    el("ol", { class: "plain" }, steps.map((step) => el("li", {}, step))),
    el("p", { class: "quiet" }, "The repository has more on this in ", code("docs/leaderboard.md"), ", under \u201cHow to submit\u201d."),
  );
}
