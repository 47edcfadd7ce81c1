"use strict";
// One annotator's ballot of one round, without a network: what was asked, what is answered, and a file to send back.

const $ = (id) => document.getElementById(id);
const clamp = (value, least, most) => Math.min(Math.max(value, least), most);
const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/** An element with properties and children. */
function element(kind, properties = {}, ...children) {
  const made = Object.assign(document.createElement(kind), properties);
  made.append(...children);
  return made;
}

const PACK = JSON.parse($("document").textContent);
const SCENES = PACK.scenes;
/** Longest reason or comment. */
const MOST_REMARK_BYTES = 2000;
/** Largest copy that is read. */
const MOST_COPY_BYTES = 64 << 20;
/** Memory for decoded pictures. */
const MOST_PICTURE_BYTES = 160 << 20;
