// Tables that are sorted by a click or a key on a column's head.

/**
 * A table. `columns`: {key, title, about, isNumber, isMinor, higher, value(row), cell(row), isHead}; `sections`: {title, rows};
 * `sort`: "key" or "-key" (descending); `change(sort)` gets what is asked for.
 * Rows without a value come last whichever way they are sorted. Of all rows in that order the first `most` are drawn.
 * On a phone a row is a block with a label at each value. Roles are written out, since some browsers take a table that
 * is laid out as blocks for none.
 */
function sortableTable({ caption, columns, sections, sort, change, most = Infinity }) {
  const isDown = sort.startsWith("-");
  const key = isDown ? sort.slice(1) : sort;
  const heads = columns.map((column) => {
    const attributes = { scope: "col", role: "columnheader", class: classOf(column) };
    if (column.isDrawn) return headOf(column, attributes);
    const state = column.key !== key ? "none" : isDown ? "descending" : "ascending";
    const first = column.isNumber && column.higher !== false ? `-${column.key}` : column.key;
    const next = column.key !== key ? first : isDown ? column.key : `-${column.key}`;
    const button = el("button", { type: "button", class: "sort", "data-sort": column.key, onclick: () => change(next) }, column.title);
    return headOf(column, { ...attributes, "aria-sort": state }, button);
  });
  let room = most;
  const bodies = sections.map(({ title, rows }) => {
    const head = title ? el("tr", { class: "rule", role: "row" }, el("th", { scope: "rowgroup", role: "rowheader", colspan: columns.length }, title)) : null;
    const drawn = inOrder(rows, columns, sort).slice(0, room);
    room -= drawn.length;
    return drawn.length > 0 ? el("tbody", { role: "rowgroup" }, head, drawn.map((row) => line(row, columns))) : null;
  });
  return el("table", { class: "stacked", role: "table" }, captionOf(caption), el("thead", { role: "rowgroup" }, el("tr", { role: "row" }, heads)), bodies);
}

/** Rows by the values of a column; as they are where the table has no such column. */
function inOrder(rows, columns, sort) {
  const isDown = sort.startsWith("-");
  const sorted = columns.find((column) => column.key === (isDown ? sort.slice(1) : sort));
  return sorted ? [...rows].sort((a, b) => compare(sorted.value(a), sorted.value(b), isDown)) : rows;
}

/** The caption of a table; it stays in sight when a wide table is scrolled. */
function captionOf(text) {
  return el("caption", {}, el("span", {}, text));
}

function line(row, columns) {
  const cells = columns.map((column) => {
    const content = [column.cell(row)].flat();
    if (column.isHead) return el("th", { scope: "row", role: "rowheader", class: "name" }, content);
    return el("td", { role: "cell", class: classOf(column), "data-label": [column.over, column.title].filter(Boolean).join(" ") }, content);
  });
  return el("tr", { role: "row" }, cells);
}

function classOf(column) {
  return column.isNumber ? (column.isMinor ? "number minor" : "number") : column.isDrawn ? "drawn" : null;
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
  holder.csv = () => csvOf(columns, inOrder(rows, columns, sort));
  redrawTable(holder, () => sortableTable({ caption, columns, sections: [{ title: null, rows }], sort, change }));
}

function sortedBy(columns, sort) {
  const column = columns.find((column) => column.key === sort.replace(/^-/, ""));
  return `Sorted by ${column.title}, ${sort.startsWith("-") ? "highest" : "lowest"} first.`;
}

/** A table draws itself anew where it stands, and the head that was pressed keeps the focus. */
function redrawTable(holder, make) {
  const pressed = holder.contains(document.activeElement) ? document.activeElement.dataset.sort : null;
  hideTip();
  holder.replaceChildren(make());
  if (pressed) holder.querySelector(`[data-sort="${CSS.escape(pressed)}"]`)?.focus();
}
