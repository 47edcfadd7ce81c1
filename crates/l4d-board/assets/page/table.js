// Tables that are sorted by a click or a key on a column's head.

/**
 * A table. `columns`: {key, title, about, isNumber, higher, value(row), cell(row), isHead}; `sections`: {title, rows};
 * `sort`: "key" or "-key" (descending); `change(sort)` is told what is asked for.
 * Rows without a value come last whichever way they are sorted. Of all rows in that order the first `most` are drawn.
 */
function sortableTable({ caption, columns, sections, sort, change, most = Infinity }) {
  const isDown = sort.startsWith("-");
  const key = isDown ? sort.slice(1) : sort;
  const sorted = columns.find((column) => column.key === key);
  const heads = columns.map((column) => {
    const over = column.over ? el("span", { class: "over" }, column.over) : null;
    if (column.isDrawn) return el("th", { scope: "col", class: classOf(column) }, column.title);
    const state = column.key !== key ? "none" : isDown ? "descending" : "ascending";
    const first = column.isNumber && column.higher !== false ? `-${column.key}` : column.key;
    const next = column.key !== key ? first : isDown ? column.key : `-${column.key}`;
    const button = el("button", { type: "button", class: "sort", title: column.about, "data-sort": column.key, onclick: () => change(next) }, column.title);
    return el("th", { scope: "col", class: classOf(column), "aria-sort": state }, over, button);
  });
  let room = most;
  const bodies = sections.map(({ title, rows }) => {
    const ordered = sorted ? [...rows].sort((a, b) => compare(sorted.value(a), sorted.value(b), isDown)) : rows;
    const head = title ? el("tr", { class: "rule" }, el("th", { scope: "rowgroup", colspan: columns.length }, title)) : null;
    const drawn = ordered.slice(0, room);
    room -= drawn.length;
    return drawn.length > 0 ? el("tbody", {}, head, drawn.map((row) => line(row, columns))) : null;
  });
  return el("table", {}, captionOf(caption), el("thead", {}, el("tr", {}, heads)), bodies);
}

/** The caption of a table; it stays in sight when a wide table is scrolled. */
function captionOf(text) {
  return el("caption", {}, el("span", {}, text));
}

function line(row, columns) {
  const cells = columns.map((column) => {
    const content = [column.cell(row)].flat();
    return column.isHead ? el("th", { scope: "row", class: "name" }, content) : el("td", { class: classOf(column) }, content);
  });
  return el("tr", {}, cells);
}

function classOf(column) {
  return column.isNumber ? "number" : column.isDrawn ? "drawn" : null;
}

function compare(a, b, isDown) {
  const [aLacks, bLacks] = [a, b].map((value) => value === null || value === undefined);
  if (aLacks || bLacks) return aLacks - bLacks;
  const order = typeof a === "number" ? a - b : String(a).localeCompare(String(b), "en", { numeric: true });
  return isDown ? -order : order;
}

/** A number with its interval below it. */
function valueCell(cell, isBest = false) {
  if (!cell) return "\u2013";
  const range = rangeText(cell);
  return [
    el("span", { class: isBest ? "best" : null }, hundredths(cell[0])),
    range ? el("span", { class: "range" }, el("span", { class: "unseen" }, "95 % interval "), range, isOfFewScenes(cell) ? fewMark() : null) : null,
  ];
}

/** A table of one section that sorts itself where it stands; the order is not kept in the address. */
function fillSorted(holder, { caption, columns, rows, sort }) {
  const change = (next) => {
    fillSorted(holder, { caption, columns, rows, sort: next });
    say(sortedBy(columns, next));
  };
  redrawTable(holder, () => sortableTable({ caption, columns, sections: [{ title: null, rows }], sort, change }));
}

function sortedBy(columns, sort) {
  const column = columns.find((column) => column.key === sort.replace(/^-/, ""));
  return `Sorted by ${column.title}, ${sort.startsWith("-") ? "highest" : "lowest"} first.`;
}

/** A table draws itself anew where it stands, and the head that was pressed keeps the focus. */
function redrawTable(holder, make) {
  const pressed = holder.contains(document.activeElement) ? document.activeElement.dataset.sort : null;
  holder.replaceChildren(make());
  if (pressed) holder.querySelector(`[data-sort="${CSS.escape(pressed)}"]`)?.focus();
}
