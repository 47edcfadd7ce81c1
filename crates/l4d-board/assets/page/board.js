// The board: who stands where, in the group of queries that the filters choose.

function drawBoard(main) {
  main.append(
    el("h1", { tabindex: -1 }, `${board.benchmark} ${board.version}`),
    headingFacts(),
    el("h2", { id: "ranking" }, "Ranking"),
    el("p", { class: "quiet" }, "Percent, means over queries; below each number its 95 % interval, clustered by scene. Ranked by mIoU; equal printed values share a rank. Choose a method to see what it did."),
  );
  const holder = el("div", { class: "scroll", tabindex: 0, role: "region", "aria-labelledby": "ranking" });
  const count = el("p", { class: "count quiet small" });
  const redraw = (changes) => {
    noteInAddress(changes);
    fillBoard(holder, count);
    say(count.textContent);
  };
  main.append(filters(redraw, count), holder);
  fillBoard(holder, count);
  drawComparison(main);
  drawPublished(main);
}

function headingFacts() {
  const share = board.queries > 0 ? board.verified / board.queries : 0;
  const meter = svg("svg", { class: "share", viewBox: "0 0 100 6", preserveAspectRatio: "none", "aria-hidden": "true" });
  meter.append(svg("rect", { class: "dot", x: 0, y: 0, width: 100 * share, height: 6 }));
  const verified = [meter, `${board.verified} of ${board.queries} (${Math.round(100 * share)} %)`];
  return facts([
    ["Protocol", board.protocol],
    ["Profile", board.profile],
    ["Queries", `${board.queries} in ${counted(board.scenes.length, "scene", "scenes")}${board.rejected ? `; ${board.rejected} rejected by people are left out` : ""}`],
    ["Prompts verified by people", verified],
    ["Truth", el("code", { title: board.truthDigest }, board.truthDigest.slice(0, 12))],
  ]);
}

function facts(pairs) {
  const entries = pairs.filter(([, value]) => value !== null && value !== "");
  return el("dl", { class: "facts" }, entries.map(([term, value]) => el("div", {}, el("dt", {}, term), el("dd", {}, value))));
}

/** This board first, then those that were scored on something else, by their place. */
function boardOptions() {
  const own = ["", `${board.protocol} \u00b7 ${board.profile} \u00b7 ${board.version}`];
  return [own, ...board.others.map((other, at) => [String(at), other.line])];
}

function filters(redraw, count) {
  const state = readAddress();
  const capital = (word) => [word, word[0].toUpperCase() + word.slice(1)];
  const search = el("input", { type: "search", value: state.find, oninput: () => redraw({ find: search.value }) });
  const hasOthers = board.others.length > 0;
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

function fillBoard(holder, count, most = MANY) {
  const state = readAddress();
  const other = state.board === "" ? null : board.others[Number(state.board)];
  const wanted = state.find.trim().toLowerCase();
  const isWanted = (method) => method.name.toLowerCase().includes(wanted);
  const methods = (other ? other.methods : board.methods).filter(isWanted);
  const rows = methods.slice(0, most).map((method) => ({
    method,
    isOwn: !other,
    cells: METRICS.map((_, metric) => cellOf(method, metric, state.category, state.scale)),
  }));
  const ranked = rows.filter((row) => row.method.rank !== null);
  const unranked = rows.filter((row) => row.method.rank === null);
  const sections = other
    ? [{ title: "Not of this board: scored on something else", rows }]
    : [{ title: null, rows: ranked }, { title: "Not ranked, shown for scale", rows: unranked }];
  const columns = boardColumns(bestValues(ranked), state);
  const sort = state.sort || "-miou";
  const change = (next) => {
    noteInAddress({ sort: next });
    fillBoard(holder, count, most);
    const column = columns.find((column) => column.key === next.replace(/^-/, ""));
    say(`Sorted by ${column.title}, ${next.startsWith("-") ? "highest" : "lowest"} first.`);
  };
  const queries = Math.max(0, ...rows.map((row) => row.cells[MIOU]?.[3] ?? 0));
  const group = [state.category, state.scale].filter(Boolean).join(", ") || "all queries";
  const caption = `${other ? other.line : board.line}. Shown: ${group} (${queries}).`;
  const shown = sections.filter((section) => section.rows.length > 0);
  redrawTable(holder, () => {
    if (shown.length === 0) return el("p", {}, "No method matches.");
    const table = sortableTable({ caption, columns, sections: shown, sort, change });
    return table;
  });
  if (methods.length > rows.length) {
    const all = () => fillBoard(holder, count, methods.length);
    holder.append(el("button", { type: "button", onclick: all }, `Show all ${methods.length} methods`));
  }
  count.textContent = `${counted(methods.length, "method", "methods")}, ${counted(queries, "query", "queries")}`;
}

/** The best printed value of each metric among ranked methods. */
function bestValues(rows) {
  return METRICS.map((metric, at) => {
    const values = rows.map((row) => row.cells[at]).filter(Boolean).map((cell) => cell[0]);
    if (values.length === 0) return null;
    return metric.higher ? Math.max(...values) : Math.min(...values);
  });
}

function boardColumns(best, state) {
  const isFiltered = state.category !== "" || state.scale !== "";
  const metric = (at) => ({
    key: METRICS[at].key,
    title: METRICS[at].title,
    about: METRICS[at].about,
    isNumber: true,
    higher: METRICS[at].higher,
    value: (row) => row.cells[at]?.[0],
    cell: (row) => valueCell(row.cells[at], row.method.rank !== null && row.cells[at]?.[0] === best[at]),
  });
  return [
    {
      key: "rank",
      title: "Rank",
      about: isFiltered ? "Rank over all queries" : "Rank by mIoU",
      isNumber: true,
      higher: false,
      value: (row) => row.method.rank,
      cell: (row) => (row.method.rank === null ? "\u2013" : String(row.method.rank)),
    },
    { key: "name", title: "Method", about: "Name and version", isHead: true, value: (row) => row.method.name, cell: methodCell },
    metric(MIOU),
    { title: "mIoU, 0 to 100", isDrawn: true, cell: (row) => bar(row.cells[MIOU], row.method.rank !== null) },
    ...METRICS.map((_, at) => at).filter((at) => at !== MIOU).map(metric),
    {
      key: "seconds",
      title: "Time",
      about: "Wall time of the method for all queries, as it states",
      isNumber: true,
      higher: false,
      value: (row) => row.method.seconds,
      cell: (row) => duration(row.method.seconds),
    },
  ];
}

function methodCell({ method, isOwn }) {
  const name = isOwn && method.isDetailed ? el("a", { href: hrefTo({ method: method.name }) }, method.name) : el("span", {}, method.name);
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
    const heads = table.columns.map((column) => el("th", { scope: "colgroup", colspan: 2, class: "number" }, column));
    const units = table.columns.flatMap(() => ["mAcc", "mIoU"]).map((unit) => el("th", { scope: "col", class: "number quiet" }, unit));
    const rows = table.rows.map((row) =>
      el("tr", {}, el("th", { scope: "row" }, row.setting), row.values.map((value) => el("td", { class: "number" }, hundredths(value)))),
    );
    const head = el("thead", {}, el("tr", {}, el("th", { scope: "col", rowspan: 2 }, "Setting"), heads), el("tr", {}, units));
    const caption = el("caption", {}, "As reported, percent");
    main.append(
      el("details", {}, el("summary", {}, table.title), el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": table.title }, el("table", {}, caption, head, el("tbody", {}, rows)))),
    );
  }
}
