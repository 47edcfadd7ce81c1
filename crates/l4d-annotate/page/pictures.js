// ---- Pictures ----

/** The bytes of a block; its text stays in the page, so that few blocks need be kept. */
function blockBytes(name) {
  const block = $("block-" + name);
  if (!block) throw new Error("this page is incomplete, ask for it again");
  const text = block.textContent.trim();
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let at = 0; at < binary.length; at++) bytes[at] = binary.charCodeAt(at);
  return bytes;
}

/** Numbers of objects, a byte a pixel, of runs: a number, then how long it lasts as LEB128. */
function unpackIds(runs, count) {
  const ids = new Uint8Array(count);
  let place = 0;
  for (let at = 0; at < runs.length; ) {
    const number = runs[at++];
    let [length, shift, byte] = [0, 0, 0];
    do {
      byte = runs[at++];
      length += (byte & 127) * 2 ** shift;
      shift += 7;
    } while (byte & 128);
    ids.fill(number, place, place + length);
    place += length;
  }
  if (place !== count) throw new Error("the outlines of this picture are damaged");
  return ids;
}

/** Takes the oldest entries out of a map that is too large. */
function forget(map, most) {
  while (map.size > most) map.delete(map.keys().next().value);
}

/** Pictures with their objects, decoded when they are asked for. */
class Pictures {
  blocks = new Map();
  entries = new Map();

  /** A picture; undefined until it is decoded, and then the screen is drawn again. */
  get(sceneName, view, place) {
    const key = `${sceneName}/${view}/${place}`;
    if (this.entries.has(key)) return this.entries.get(key).found;
    const entry = { found: undefined };
    this.entries.set(key, entry);
    const [width, height] = SCENES[sceneName].size;
    forget(this.entries, Math.max(8, Math.floor(MOST_PICTURE_BYTES / (width * height * 5))));
    this.decode(sceneName, view, place).then(
      (found) => (entry.found = found),
      (error) => (entry.found = { error: `This picture cannot be shown: ${error.message}` }),
    ).then(askForDrawing);
    return undefined;
  }

  async decode(sceneName, view, place) {
    const scene = SCENES[sceneName];
    const [light, runs] = this.parts(sceneName, view, place);
    const [width, height] = scene.size;
    const ids = unpackIds(runs, width * height);
    const image = await createImageBitmap(new Blob([light], { type: "image/jpeg" }));
    return { image, width, height, objects: objectsIn(ids, width, height, scene.objects), ids };
  }

  parts(sceneName, view, place) {
    const name = `${sceneName}-${view}`;
    if (!this.blocks.has(name)) this.blocks.set(name, blockBytes(name));
    forget(this.blocks, 3);
    const bytes = this.blocks.get(name);
    const lengths = SCENES[sceneName].lengths[view];
    const start = lengths.slice(0, place).reduce((sum, [light, ids]) => sum + light + ids, 0);
    const middle = start + lengths[place][0];
    return [bytes.slice(start, middle), bytes.slice(middle, middle + lengths[place][1])];
  }
}

/** Outline, middle and box of every object in a picture, by number. */
function objectsIn(ids, width, height, count) {
  const found = new Map();
  for (let y = 0, at = 0; y < height; y++) {
    for (let x = 0; x < width; x++, at++) {
      const number = ids[at];
      if (number === 0 || number > count) continue;
      if (!found.has(number)) found.set(number, { pixels: 0, x: 0, y: 0, box: [x, y, x, y], sides: new Map() });
      const object = found.get(number);
      object.pixels++;
      object.x += x + 0.5;
      object.y += y + 0.5;
      object.box = [Math.min(object.box[0], x), object.box[1], Math.max(object.box[2], x), y];
      const corner = y * (width + 1) + x;
      // Sides run so that the object is on their right.
      if (y === 0 || ids[at - width] !== number) addSide(object.sides, corner, 0);
      if (x === width - 1 || ids[at + 1] !== number) addSide(object.sides, corner + 1, 1);
      if (y === height - 1 || ids[at + width] !== number) addSide(object.sides, corner + width + 2, 2);
      if (x === 0 || ids[at - 1] !== number) addSide(object.sides, corner + width + 1, 3);
    }
  }
  for (const [number, object] of found) {
    object.path = outlinePath(object.sides, width + 1);
    object.sides = undefined;
    object.middle = middleOf(object, number, ids, width);
  }
  return found;
}

/** Directions from a corner: 0 right, 1 down, 2 left, 3 up; one bit each. */
function addSide(sides, corner, direction) {
  sides.set(corner, (sides.get(corner) ?? 0) | (1 << direction));
}

/** Follows sides round and round. */
function outlinePath(sides, columns) {
  const path = new Path2D();
  const steps = [1, columns, -1, -columns];
  while (sides.size) {
    const corners = [];
    const first = sides.keys().next().value;
    let corner = first;
    let direction = [0, 1, 2, 3].find((way) => sides.get(corner) & (1 << way));
    do {
      const left = sides.get(corner) & ~(1 << direction);
      if (left) sides.set(corner, left);
      else sides.delete(corner);
      corners.push([corner % columns, Math.floor(corner / columns)]);
      corner += steps[direction];
      // Right first: pixels that touch at a corner alone are not joined.
      const ways = [(direction + 1) % 4, direction, (direction + 3) % 4];
      direction = ways.find((way) => sides.get(corner) & (1 << way));
    } while (direction !== undefined && corner !== first);
    drawLoop(path, smoothed(corners));
  }
  return path;
}

/** Each corner's mean with its neighbours: less than a pixel away, without the stairs of a grid. */
function smoothed(corners) {
  if (corners.length < 12) return corners;
  const at = (k) => corners[(k + corners.length) % corners.length];
  const mean = (k, axis) => (at(k - 2)[axis] + at(k - 1)[axis] + at(k)[axis] + at(k + 1)[axis] + at(k + 2)[axis]) / 5;
  return corners.map((_, k) => [mean(k, 0), mean(k, 1)]);
}

function drawLoop(path, corners) {
  const between = (a, b) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  path.moveTo(...between(corners.at(-1), corners[0]));
  corners.forEach((corner, k) => {
    path.quadraticCurveTo(...corner, ...between(corner, corners[(k + 1) % corners.length]));
  });
  path.closePath();
}

/** The centroid, or the pixel of the object nearest to it where that is beside the object. */
function middleOf({ pixels, x, y, box }, number, ids, width) {
  const centre = [x / pixels, y / pixels];
  if (ids[Math.floor(centre[1]) * width + Math.floor(centre[0])] === number) return centre;
  let [best, least] = [centre, Infinity];
  for (let row = box[1]; row <= box[3]; row++) {
    for (let column = box[0]; column <= box[2]; column++) {
      if (ids[row * width + column] !== number) continue;
      const far = (column + 0.5 - centre[0]) ** 2 + (row + 0.5 - centre[1]) ** 2;
      if (far < least) [best, least] = [[column + 0.5, row + 0.5], far];
    }
  }
  return best;
}
