// ---- Looking ----

function stepFrame(step) {
  model.playing = null;
  model.frame = clamp(model.frame + step, 0, scene().frames.length - 1);
}

function stepView(step) {
  const count = scene().views.length;
  model.view = (model.view + step + count) % count;
}

/** How long each frame is shown: as long as it lasts in the clip. */
function frameTime() {
  const { frames, frames_per_second } = scene();
  return (1000 * Math.max((frames[1] ?? 1) - frames[0], 1)) / (frames_per_second ?? 24);
}

function play() {
  model.playing = model.playing === null ? performance.now() + frameTime() : null;
}

/** The whole clip; while the time is asked for, the part that the answer names. */
function playedFrames() {
  const { frames } = scene();
  const [first, last] = model.mode === "when" ? holds() : whole();
  return [frames.findIndex((frame) => frame >= first), frames.findLastIndex((frame) => frame <= last)];
}

/** The next frame, if it is due. */
function tick(now) {
  if (now < model.playing) return;
  const [first, last] = playedFrames();
  model.frame = model.frame >= first && model.frame < last ? model.frame + 1 : first;
  // Being late once must not make the rest of the clip run.
  model.playing = Math.max(model.playing + frameTime(), now);
  showTime();
}

const MOST_ZOOM = 12;
const ZOOM_STEP = 1.5;
/** How far a key moves the picture, as a share of what is shown. */
const PAN_STEP = 0.125;

function setZoom(x, y, factor) {
  const within = clamp(factor < 1.01 ? 1 : factor, 1, MOST_ZOOM);
  const reach = 0.5 / within;
  model.zoom = { x: clamp(x, reach, 1 - reach), y: clamp(y, reach, 1 - reach), factor: within };
}

const zoomBy = (steps) => setZoom(model.zoom.x, model.zoom.y, model.zoom.factor * ZOOM_STEP ** steps);
const pan = (right, down) =>
  setZoom(model.zoom.x + right / model.zoom.factor, model.zoom.y + down / model.zoom.factor, model.zoom.factor);

/** Zooms to the chosen objects, to all of them if none is chosen, and back. */
function zoomToChosen() {
  if (model.zoom.factor > 1) return setZoom(0.5, 0.5, 1);
  const found = pictures.get(item().scene, scene().views[model.view], model.frame);
  const numbers = chosenNumbers();
  const boxes = [...(found?.objects ?? [])].flatMap(([number, { box }]) =>
    !numbers.length || numbers.includes(number) ? [box] : []);
  if (!boxes.length) return say("None of the chosen objects is in this picture.");
  const least = (k) => Math.min(...boxes.map((box) => box[k]));
  const most = (k) => Math.max(...boxes.map((box) => box[k])) + 1;
  const [width, height] = scene().size;
  const share = Math.max((most(2) - least(0)) / width, (most(3) - least(1)) / height);
  setZoom((least(0) + most(2)) / 2 / width, (least(1) + most(3)) / 2 / height, 0.4 / share);
}
