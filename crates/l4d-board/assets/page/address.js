// What is looked at stands behind the # of the address, so that every view can be linked and the back button works.

const FIELDS = ["board", "category", "scale", "find", "sort", "method", "scene", "query", "frame", "a", "b"];

/** What the address asks for; fields that it does not name are empty. */
function readAddress() {
  const asked = new URLSearchParams(location.hash.slice(1));
  return Object.fromEntries(FIELDS.map((field) => [field, asked.get(field) ?? ""]));
}

/** The address of the present view with some fields changed. */
function hrefWith(changes) {
  const state = { ...readAddress(), ...changes };
  const asked = new URLSearchParams();
  for (const field of FIELDS) if (state[field] !== "") asked.set(field, state[field]);
  return `#${asked}`;
}

/** The address of another view: what the board is filtered by stays, what was open does not. */
function hrefTo(target) {
  return hrefWith({ method: "", scene: "", query: "", frame: "", ...target });
}

/** Changes the address without a new entry in the history and without drawing anew. */
function noteInAddress(changes) {
  history.replaceState(null, "", hrefWith(changes));
}
