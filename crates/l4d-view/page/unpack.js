// What is in the file: the document, blocks of bytes, pictures and masks.

const DOCUMENT = JSON.parse(document.getElementById("document").textContent);

/** The bytes of a block; its text is let go. */
function blockBytes(name) {
  const element = document.getElementById("block-" + name);
  const text = element.textContent;
  element.remove();
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let at = 0; at < binary.length; at++) bytes[at] = binary.charCodeAt(at);
  return bytes;
}

const frameKey = (frame) => String(frame).padStart(4, "0");

/** The place in an ascending list of what is nearest to a number. */
function nearestPlace(list, number) {
  let best = 0;
  list.forEach((item, place) => {
    if (Math.abs(item - number) < Math.abs(list[best] - number)) best = place;
  });
  return best;
}

/** Pictures of the cameras, decoded when they are asked for. */
class Pictures {
  constructor(about, changed) {
    this.about = about;
    this.changed = changed;
    this.albums = new Map();
    this.decoded = new Map();
  }

  album(camera) {
    if (!this.albums.has(camera)) {
      const lengths = this.about.cameras.find((album) => album.name === camera).lengths;
      let at = 0;
      const places = lengths.map((files) => files.map((count) => [at, (at += count)]));
      this.albums.set(camera, { bytes: blockBytes("pictures-" + camera), places });
    }
    return this.albums.get(camera);
  }

  /** A picture near a frame: 0 light, 1 depth, 2 ids. Undefined until it is decoded; then `changed` is called. */
  get(camera, frame, kind) {
    const place = nearestPlace(this.about.frames, frame);
    const key = `${camera} ${place} ${kind}`;
    const found = this.decoded.get(key);
    if (found) return found.picture;
    const { bytes, places } = this.album(camera);
    const entry = {};
    this.decoded.set(key, entry);
    if (this.decoded.size > 1500) this.decoded.delete(this.decoded.keys().next().value);
    const type = kind === 2 ? "image/png" : "image/jpeg";
    createImageBitmap(new Blob([bytes.subarray(...places[place][kind])], { type })).then((picture) => {
      entry.picture = picture;
      this.changed();
    });
    return undefined;
  }

  /** The frame whose picture is nearest. */
  frameNear(frame) {
    return this.about.frames[nearestPlace(this.about.frames, frame)];
  }
}

/** Pixels, row by row, of COCO's compressed run lengths, which go down the columns. */
function maskPixels(counts, width, height) {
  const runs = [];
  for (let at = 0; at < counts.length; ) {
    let value = 0;
    let shift = 0;
    let more = true;
    while (more) {
      const five = counts.charCodeAt(at++) - 48;
      value += (five & 31) * 2 ** shift;
      more = (five & 32) !== 0;
      shift += 5;
      if (!more && five & 16) value -= 2 ** shift;
    }
    runs.push(runs.length > 2 ? value + runs[runs.length - 2] : value);
  }
  const pixels = new Uint8Array(width * height);
  let place = 0;
  runs.forEach((run, index) => {
    for (const end = place + run; place < end; place++) {
      if (index % 2) pixels[(place % height) * width + Math.floor(place / height)] = 1;
    }
  });
  return pixels;
}

/** Intersection over union of two masks; none if both are empty. */
function overlap(a, b) {
  let [both, any] = [0, 0];
  for (let at = 0; at < a.length; at++) {
    both += a[at] & b[at];
    any += a[at] | b[at];
  }
  return any ? both / any : undefined;
}
