// What a column says: shown where its head is pointed at, focused or tapped, until Escape or until one goes on.

/** By the key of a column; metrics as docs/scoring.md defines them. */
const ABOUT = {
  rank: "Place in its track, by mIoU over all queries. Equal printed values share a place, and methods that saw the truth or the held-out view have none.",
  method: "Name and version of the method. Choose it to see what it did, scene by scene and query by query.",
  miou: "Intersection over union (IoU) of prediction and truth, averaged over the frames that show the target and then over queries. It decides the rank.",
  bar: "The mIoU of this row drawn from 0 to 100, with its 95 % interval as a thin line.",
  macc: "Share of the frames with a target in which prediction and truth share at least one pixel. Any overlap counts, so large masks do well.",
  acc25: "Share of the frames with a target whose IoU is above 0.25.",
  acc50: "Share of the frames with a target whose IoU is above 0.5.",
  tube_iou: "Sum of intersections by sum of unions over all frames of the clip. What is marked at the wrong time lowers it.",
  select: "Share of queries in which the thing that the prediction overlaps most over the clip is one that is meant. A tie does not count.",
  false_positive_rate: "Share of the frames without a target in which something was marked. Lower is better.",
  seconds: "Wall time for all queries on the method's own machine, as its card states it.",
  group: "The queries that the row is about: all of them, those of a category, or those of a scale.",
  scene: "Name of the scene. Choose it to see its queries.",
  scale: "Size of the scene: outdoor, a room, or a tabletop.",
  queries: "How many queries the row is about.",
  number: "Number of the query in its scene.",
  text: "The sentence that was asked. Choose it to see the masks.",
  category: "What is needed to find the target: an attribute, an action, a place, or an interaction.",
  taken: "The thing that the prediction overlaps most over the clip, and whether that is what is meant.",
  frame: "Number of the frame in the clip.",
  state: "The IoU where the target was hit; else whether it was missed, rightly absent, or falsely marked.",
};

const tips = new Map();
/** The explanation in sight and the head that it is of. */
let shown = null;
let tipTimer;

function tipOf(text) {
  if (!tips.has(text)) {
    const tip = el("div", { class: "tip", role: "tooltip", id: `tip-${tips.size}`, hidden: true, onmouseenter: () => clearTimeout(tipTimer), onmouseleave: hideTip }, text);
    document.getElementById("foot").append(tip);
    tips.set(text, tip);
  }
  return tips.get(text);
}

/** The head of a column: {key, title, about, over}. `sort` is the button that sorts by it, where there is one. */
function headOf(column, attributes, sort = null) {
  const tip = tipOf(column.about ?? ABOUT[column.key] ?? METRICS.find(({ key }) => key === column.key).about);
  const show = () => showTip(tip, button);
  const button = el(
    "button",
    { type: "button", class: sort ? "about" : "about word", "aria-label": sort ? `About ${column.title}` : null, "aria-describedby": tip.id, onclick: show, onfocus: show, onblur: hideTip },
    sort ? "?" : column.title,
  );
  const later = (act, delay) => () => {
    clearTimeout(tipTimer);
    tipTimer = setTimeout(act, delay);
  };
  // A pointer that only passes shows nothing, and one has the time to go from the head to the text.
  const pointed = { onmouseenter: later(show, 300), onmouseleave: later(hideTip, 200) };
  const over = column.over ? el("span", { class: "over" }, column.over) : null;
  return el("th", { "aria-label": [column.over, column.title].filter(Boolean).join(" "), ...attributes, ...pointed }, over, sort, button);
}

function showTip(tip, button) {
  hideTip();
  if (!button.isConnected) return;
  shown = { tip, button };
  tip.hidden = false;
  placeTip();
}

function hideTip() {
  clearTimeout(tipTimer);
  if (shown) shown.tip.hidden = true;
  shown = null;
}

/** Below the head, or above it where the window ends. */
function placeTip() {
  if (!shown) return;
  const { tip, button } = shown;
  const box = button.getBoundingClientRect();
  const { clientWidth, clientHeight } = document.documentElement;
  const below = box.bottom + 6;
  const isRoom = below + tip.offsetHeight < clientHeight;
  tip.style.left = `${Math.max(8, Math.min(box.left, clientWidth - tip.offsetWidth - 8))}px`;
  tip.style.top = `${isRoom ? below : Math.max(8, box.top - tip.offsetHeight - 6)}px`;
}

addEventListener("scroll", placeTip, true);
addEventListener("resize", placeTip);
addEventListener("hashchange", hideTip);
document.addEventListener("pointerdown", ({ target }) => {
  if (!target.closest("th, .tip")) hideTip();
});
document.addEventListener("keydown", (event) => {
  if (event.key !== "Escape" || !shown) return;
  hideTip();
  // It has done its work: it does not lead up the trail as well.
  event.preventDefault();
});
