"use strict";
// What the pages of models share.

const $ = (id) => document.getElementById(id);
const data = JSON.parse($("data").textContent);
const factorText = (value) => (value < 0 ? "\u2212" : "") + Math.abs(value).toFixed(2) + "\u00a0\u00d7";

function make(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

/** Seeds are whole numbers of 64 bits; null for another text. */
function seedOf(text) {
  if (!/^\d{1,20}$/.test(text)) return null;
  const seed = BigInt(text);
  return seed < 2n ** 64n ? seed : null;
}

const shellWord = (text) => (/^[\w\-./:=,+@%]+$/.test(text) ? text : "'" + text.replace(/'/g, "'\\''") + "'");
