// Two methods against each other: how far apart, how sure that is, and what could not have been seen.

function drawComparison(main) {
  const { names, pairs } = board.comparisons;
  if (names.length < 2) return;
  main.append(el("h2", { id: "compare" }, "Compare two methods"));
  const told = el("div", { class: "verdict", role: "status" });
  const state = readAddress();
  const first = names.includes(state.a) ? state.a : names[0];
  const rival = names.find((name) => name !== first && trackOf(name) === trackOf(first));
  let [a, b] = [first, names.includes(state.b) ? state.b : rival];
  const options = names.map((name) => [name, name]);
  const update = (changes) => {
    [a, b] = [changes.a ?? a, changes.b ?? b];
    noteInAddress({ a, b });
    told.replaceChildren(...verdict(a, b, pairs));
  };
  main.append(
    el(
      "div",
      { class: "pair" },
      choice("Method", options, a, (value) => update({ a: value })),
      choice("against", options, b, (value) => update({ b: value })),
    ),
    told,
  );
  told.replaceChildren(...verdict(a, b, pairs));
}

function trackOf(name) {
  return board.methods[methodIndex(name)].track;
}

function verdict(a, b, all) {
  if (a === b) return [el("p", {}, "Choose two different methods.")];
  if (trackOf(a) !== trackOf(b)) return [el("p", {}, "One of them learned from rendered depth and the other did not: methods of two tracks are not compared.")];
  // Corrected are the p values of a track.
  const pairs = all.filter((pair) => trackOf(pair.a) === trackOf(a));
  const straight = pairs.find((pair) => pair.a === a && pair.b === b);
  const found = straight ?? turned(pairs.find((pair) => pair.a === b && pair.b === a));
  if (!found) return [el("p", {}, "No query was answered by both.")];
  const [value, low, high, queries, scenes] = found.gain;
  const points = Math.abs(value).toFixed(2);
  const way = value === 0 ? "as high as" : value > 0 ? "higher than" : "lower than";
  const lead = value === 0 ? `mIoU of ${a} is ${way} that of ${b}` : `mIoU of ${a} is ${points} points ${way} that of ${b}`;
  const few = isOfFewScenes(found.gain) ? `, which may be too narrow from fewer than ${board.fewScenes} scenes` : "";
  const range = low === null ? "no interval: all queries are of one scene" : `95 % interval ${low.toFixed(2)} to ${high.toFixed(2)}${few}`;
  return [
    el("p", {}, el("strong", {}, `${lead}.`)),
    el("p", {}, `${range}; p ${probability(found.p)} for this pair alone, p ${probability(found.holm)} corrected for all ${pairs.length} pairs of the track (Holm).`),
    el("p", {}, outcome(found, pairs.length), found.detectable === null ? "" : ` A true difference of ${found.detectable.toFixed(2)} points would have p below 0.05 four times in five, before correction.`),
    el("p", { class: "quiet small" }, `${counted(queries, "query", "queries")} of ${counted(scenes, "scene", "scenes")}, each method against the other on the same query.`),
  ];
}

/** What the corrected p says, and where it could have said nothing else. */
function outcome({ holm, leastP, gain: [, low, high] }, pairs) {
  if (low === 0 && high === 0) return "They do not differ in any scene.";
  if (holm < 0.05) return "The difference remains after correction.";
  if (leastP >= 0.05) return "So few scenes differ that no outcome could have had p below 0.05.";
  if (pairs * leastP >= 0.05) return `From so few scenes and among ${pairs} pairs, hardly any difference can remain after correction, however large it is.`;
  return "That is no difference that these scenes can show.";
}

/** "= 0.012", or "< 0.001". */
function probability(p) {
  return p < 0.001 ? "< 0.001" : `= ${p.toFixed(3)}`;
}

function turned(pair) {
  if (!pair) return null;
  const [value, low, high, queries, scenes] = pair.gain;
  return { ...pair, gain: [-value, high === null ? null : -high, low === null ? null : -low, queries, scenes] };
}
