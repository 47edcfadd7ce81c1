// COCO's compressed run lengths: runs down the columns, the first outside; from the fourth on, each is stored as its
// difference to the one two before.

/** One byte a pixel, row by row: 1 inside. */
function decodeMask(counts, width, height) {
  const mask = new Uint8Array(width * height);
  let at = 0;
  let position = 0;
  let before = 0;
  let beforeThat = 0;
  for (let run = 0; at < counts.length; run += 1) {
    let value = 0;
    let shift = 0;
    let group;
    do {
      group = counts.charCodeAt(at) - 48;
      value += (group & 0x1f) * 2 ** shift;
      shift += 5;
      at += 1;
    } while (group & 0x20 && at < counts.length);
    if (group & 0x10) value -= 2 ** shift;
    const length = run > 2 ? value + beforeThat : value;
    if (run % 2 === 1) {
      for (let pixel = position; pixel < Math.min(position + length, mask.length); pixel += 1) {
        mask[(pixel % height) * width + Math.floor(pixel / height)] = 1;
      }
    }
    position += length;
    beforeThat = before;
    before = length;
  }
  return mask;
}
