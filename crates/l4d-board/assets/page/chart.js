// Small drawings in SVG. Each is beside the numbers that it shows, so readers who do not see it lose nothing.

/** A bar from 0 to 100 with its interval. */
function bar(cell, isRanked) {
  const width = 160;
  const drawing = svg("svg", { viewBox: `0 0 ${width} 16`, width, height: 16, "aria-hidden": "true" });
  drawing.append(svg("line", { class: "grid", x1: 0.5, x2: 0.5, y1: 0, y2: 16 }));
  for (const tick of [25, 50, 75, 100]) {
    const x = (tick / 100) * (width - 1) + 0.5;
    drawing.append(svg("line", { class: "grid", x1: x, x2: x, y1: 0, y2: 16 }));
  }
  if (!cell) return drawing;
  const x = (value) => (Math.min(Math.max(value, 0), 100) / 100) * (width - 1);
  drawing.append(svg("rect", { class: isRanked ? "bar" : "bar unranked", x: 0, y: 4, width: x(cell[0]), height: 8 }));
  if (cell[1] !== null) {
    const [low, high] = [x(cell[1]) + 0.5, x(cell[2]) + 0.5];
    drawing.append(svg("path", { class: "whisker", d: `M${low} 8H${high}M${low} 5v6M${high} 5v6` }));
  }
  return drawing;
}

/** IoU over the clip: the line where there is something to find, marks where something was wrongly marked. */
function timeline(frames, codes, targetAt, current, pick) {
  const [width, height, left, top, bottom] = [560, 150, 34, 8, 26];
  const first = frames[0];
  const last = frames[frames.length - 1];
  const x = (frame) => left + ((frame - first) / Math.max(1, last - first)) * (width - left - 10);
  const y = (iou) => top + (1 - iou) * (height - top - bottom);
  const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, width: "100%", "aria-hidden": "true" });
  const step = frames.length > 1 ? x(frames[1]) - x(frames[0]) : 10;
  frames.forEach((frame, at) => {
    if (targetAt(at)) drawing.append(svg("rect", { class: "asked", x: x(frame) - step / 2, y: y(1), width: step, height: y(0) - y(1) }));
  });
  for (const tick of [0, 0.25, 0.5, 0.75, 1]) {
    drawing.append(svg("line", { class: "grid", x1: left, x2: width - 10, y1: y(tick), y2: y(tick) }));
    drawing.append(svg("text", { x: left - 6, y: y(tick) + 4, "text-anchor": "end" }, String(tick * 100)));
  }
  for (const frame of ticks(first, last)) {
    drawing.append(svg("text", { x: x(frame), y: height - 8, "text-anchor": "middle" }, String(frame)));
  }
  let run = [];
  const finish = () => {
    if (run.length === 1) drawing.append(svg("circle", { class: "dot", cx: run[0][0], cy: run[0][1], r: 2.5 }));
    if (run.length > 1) drawing.append(svg("polyline", { class: "line", points: run.map((point) => point.join(",")).join(" ") }));
    run = [];
  };
  frames.forEach((frame, at) => {
    const code = codes[at];
    if (code >= 0 || code === -1) run.push([x(frame), y(Math.max(code, 0) / 1000)]);
    else finish();
    if (code === -2) drawing.append(svg("path", { class: "wrong", d: `M${x(frame) - 3} ${y(0) - 3}l6 6m0 -6l-6 6` }));
  });
  finish();
  if (current !== null) drawing.append(svg("line", { class: "now", x1: x(current), x2: x(current), y1: top, y2: y(0) }));
  drawing.addEventListener("click", (event) => {
    const box = drawing.getBoundingClientRect();
    const asked = first + (((event.clientX - box.left) / box.width) * width - left) / (width - left - 10) * (last - first);
    pick(frames.reduce((best, frame) => (Math.abs(frame - asked) < Math.abs(best - asked) ? frame : best)));
  });
  return drawing;
}

/** Round frame numbers, at most seven. */
function ticks(first, last) {
  const step = [1, 2, 5, 10, 24, 48, 96, 240, 480, 960].find((step) => (last - first) / step <= 6) ?? Math.ceil((last - first) / 6);
  const found = [];
  for (let frame = Math.ceil(first / step) * step; frame <= last; frame += step) found.push(frame);
  return found;
}
