// Elements. Text from data only ever becomes text nodes and attribute values, never markup.

const SVG = "http://www.w3.org/2000/svg";

/** An element; `on…` attributes are listeners, null and false ones are left out, true ones are empty. */
function el(name, attributes = {}, ...children) {
  return furnish(document.createElement(name), attributes, children);
}

/** The same in SVG. */
function svg(name, attributes = {}, ...children) {
  return furnish(document.createElementNS(SVG, name), attributes, children);
}

function furnish(element, attributes, children) {
  for (const [key, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else element.setAttribute(key, value === true ? "" : String(value));
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return element;
}

/** A name that may be broken behind its seams. */
function breakable(name) {
  return name.split(/(?<=[_.-])/).flatMap((part, at) => (at > 0 ? [el("wbr"), part] : [part]));
}

/** Tells a reader who does not see the page what has changed. */
function say(text) {
  document.getElementById("said").textContent = text;
}

/** A select with a label; `options` are [value, text]. */
function choice(label, options, chosen, change) {
  const select = el("select", { onchange: () => change(select.value) });
  for (const [value, text] of options) {
    select.append(el("option", { value, selected: value === chosen }, text));
  }
  return el("label", {}, label, select);
}

/** 62.5 -> "62.50"; nothing -> an en dash. */
function hundredths(value) {
  return value === null || value === undefined ? "\u2013" : value.toFixed(2);
}

/** "58.1 to 66.9", or nothing where there is no interval. */
function rangeText(cell) {
  return cell && cell[1] !== null ? `${cell[1].toFixed(1)}\u2013${cell[2].toFixed(1)}` : null;
}

/** Whether an interval rests on so few scenes that it may be too narrow. */
function isOfFewScenes(cell) {
  return cell[4] < board.fewScenes;
}

/** Of one scene there is nothing to say of others. A cell without intervals does not know its scenes. */
function isOfOneScene(cell) {
  return board.sceneCount < 2 || cell[4] === 1;
}

function fewMark() {
  return [el("span", { "aria-hidden": "true" }, " !"), el("span", { class: "unseen" }, ` of fewer than ${board.fewScenes} scenes`)];
}

/** What is below the numbers of a table, and what the mark there means. */
function intervalNote() {
  if (board.sceneCount < 2) return "one scene says nothing of others, so that there are no intervals and no p values.";
  return `below each number its 95 % interval, clustered by scene, marked ! where it rests on fewer than ${board.fewScenes} scenes and may be too narrow.`;
}

/** 1 -> "1 query", 2 -> "2 queries". */
function counted(count, one, many) {
  return `${count} ${count === 1 ? one : many}`;
}

/** Hours, minutes or seconds, as a person says it. */
function duration(seconds) {
  if (seconds === null || seconds === undefined) return "\u2013";
  if (seconds < 120) return `${seconds.toFixed(1)} s`;
  if (seconds < 7200) return `${(seconds / 60).toFixed(1)} min`;
  return `${(seconds / 3600).toFixed(1)} h`;
}
