// SPDX-License-Identifier: Apache-2.0
// What the tests of pages share: the program, models, pages of them, and the program's own frames and matrices.
import {execFileSync} from "node:child_process";
import {mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync, mkdirSync} from "node:fs";
import {tmpdir} from "node:os";
import {join} from "node:path";

export const folder = mkdtempSync(join(tmpdir(), "emberfold-page-"));
export const removeFolder = () => rmSync(folder, {recursive: true, force: true});

export function emberfold(...words) {
  return execFileSync(process.env.EMBERFOLD, words, {encoding: "utf8", stdio: ["ignore", "pipe", "pipe"]});
}

/** A model of a small clip and its page. */
export function learn(name, clip, ...options) {
  const model = join(folder, name), page = join(folder, name + ".html");
  emberfold("dytex", "learn", clip, "-o", model, "-q", ...options);
  emberfold("dytex", "page", model, "-o", page, "-q");
  return {model, page, url: "file://" + page};
}

/** A folder of equal grey frames. */
export function stillClip(name, width, height, frames, level) {
  const clip = join(folder, name);
  mkdirSync(clip);
  const image = Buffer.concat([Buffer.from(`P5 ${width} ${height} 255\n`), Buffer.alloc(width * height, level)]);
  for (let t = 0; t < frames; ++t) writeFileSync(join(clip, `frame_${t}.pgm`), image);
  return clip;
}

/** The words of `dytex edit` for settings of the page. */
export function editWords(settings) {
  return Object.entries(settings).flatMap(([name, value]) => (name === "reverse" ? ["--reverse"] : [`--${name}`, String(value)]));
}
export function edit(model, settings) {
  const to = `${model}_edited`;
  emberfold("dytex", "edit", model, "-o", to, "-q", ...editWords(settings));
  return to;
}

/** Frames that the program draws, as PNG in data URIs. */
export function synthesize(model, seed, frames, ...options) {
  const to = mkdtempSync(join(folder, "frames-"));
  emberfold("dytex", "synth", model, "-o", join(to, "f"), "--frames", String(frames), "--seed", String(seed), "-q", ...options);
  return readdirSync(join(to, "f")).sort().map((name) => "data:image/png;base64," + readFileSync(join(to, "f", name)).toString("base64"));
}

/** A float64 array of a model: {rows, cols, data}, a column after the other. */
export function readArray(model, name) {
  const bytes = readFileSync(join(model, name + ".npy")), length = bytes.readUInt16LE(8);
  const header = bytes.toString("latin1", 10, 10 + length);
  const shape = header.match(/\(([^)]*)\)/)[1].split(",").filter((s) => s.trim()).map(Number);
  const [rows, cols] = [shape[0], shape[1] ?? 1];
  if (!header.includes("<f8") || (cols > 1 && !header.includes("'fortran_order': True"))) throw new Error("another layout: " + header);
  const data = Array.from({length: rows * cols}, (_, i) => bytes.readDoubleLE(10 + length + 8 * i));
  return {rows, cols, data};
}

/** Largest difference over the largest size of the second. */
export function relativeDifference(a, b) {
  if (a.rows !== b.rows || a.cols !== b.cols) return Infinity;
  const size = Math.max(...b.data.map(Math.abs), 1e-300);
  return Math.max(...b.data.map((v, i) => Math.abs(v - a.data[i]))) / size;
}
