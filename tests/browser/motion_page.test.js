// SPDX-License-Identifier: Apache-2.0
// `emberfold motion page` in a headless Chromium: what the page draws is held against what the program draws.
import assert from "node:assert/strict";
import {mkdtempSync, readFileSync, readdirSync} from "node:fs";
import {join} from "node:path";
import {after, before, describe, test} from "node:test";
import {close, frameDifferences, open, startBrowser, stopBrowser} from "./browser.js";
import {emberfold, folder, removeFolder} from "./models.js";

const model = join(folder, "run", "model"), url = `file://${folder}/motion.html`;
const withoutGraphics = `const all = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, ...rest) { return kind === "webgl2" ? null : all.call(this, kind, ...rest); };`;

/** A clip that the program draws: its graphs, and its frames as PNG in data URIs. */
function synthesize(frames, ...options) {
  const to = mkdtempSync(join(folder, "frames-")), motion = join(to, "motion.jsonl");
  emberfold("synth", model, "-o", join(to, "f"), "--fill", "diffusion", "--frames", String(frames), "--motion", motion, "-q", ...options);
  const graphs = readFileSync(motion, "utf8").trim().split("\n").map((line) => JSON.parse(line)).filter((line) => line.vertices);
  const images = readdirSync(join(to, "f")).filter((name) => name.endsWith(".png")).sort()
    .map((name) => "data:image/png;base64," + readFileSync(join(to, "f", name)).toString("base64"));
  return {graphs, images};
}

/** The page's graphs, from frame 0 of the seed on. */
function graphsOf(page, frames, seed) {
  return page.evaluate(([count, s]) => {
    emberfold.pause();
    emberfold.restart(s);
    const graphs = [emberfold.graph()];
    while (graphs.length < count) {
      emberfold.step();
      graphs.push(emberfold.graph());
    }
    return graphs;
  }, [frames, String(seed)]);
}
/** Largest distance, px, between patches of the page's graphs and the program's; infinite where their numbers differ. */
function apart(ours, theirs) {
  if (ours.length !== theirs.length) return Infinity;
  return Math.max(...ours.map(({patches, edges}, t) => {
    const {vertices, edges: linked} = theirs[t];
    if (patches.length !== 4 * vertices.length || edges.length !== 2 * linked.length) return Infinity;
    return Math.max(0, ...vertices.map((vertex, i) => Math.hypot(vertex.x - patches[4 * i + 1], vertex.y - patches[4 * i + 2])));
  }));
}
/** Mean difference of levels between what the page shows, from frame 0 on, and the program's frames. */
async function differences(page, images) {
  await page.evaluate(() => emberfold.restart(1));
  return (await frameDifferences(page, images)).map(({mean}) => mean);
}

before(async () => {
  await startBrowser();
  emberfold("analyze", "builtin:fire", "-o", join(folder, "run"), "--scale", "0.5", "--range", "0:50", "-q");
  emberfold("motion", "page", model, "-o", `${folder}/motion.html`, "-q");
});
after(async () => {
  await stopBrowser();
  removeFolder();
});

describe("the same clip as the program's", () => {
  test("100 frames have the program's strokes, and nearly its pictures", async () => {
    const page = await open(url + "#play=0"), {graphs, images} = synthesize(100);
    assert.equal(await page.evaluate(() => emberfold.renderer), "webgl2");
    assert.ok(apart(await graphsOf(page, 100, 1), graphs) < 1e-6);
    const wrong = await differences(page, images.slice(0, 40)), mean = wrong.reduce((sum, d) => sum + d, 0) / wrong.length;
    assert.ok(mean < 2, `${mean} levels`);
    await close(page);
  });

  test("another seed draws another clip, the program's", async () => {
    const page = await open(url + "#play=0"), {graphs} = synthesize(20, "--seed", "18446744073709551615");
    assert.ok(apart(await graphsOf(page, 20, 2n ** 64n - 1n), graphs) < 1e-6);
    assert.equal(apart(await graphsOf(page, 20, 5), graphs), Infinity);
    await close(page);
  });

  for (const [settings, words] of [
    [{splits: 3, windx: 1.5, windy: -0.5}, ["--set", "synth.splits=3", "--wind=1.5,-0.5"]],
    [{speed: 0.5, reverse: true, contrast: 1.5}, ["--speed", "0.5", "--reverse", "--contrast", "1.5"]],
    [{births: 2, deaths: 2, intensity: 0.5, flicker: 2}, ["--set", "synth.births=2", "--set", "synth.deaths=2", "--intensity", "0.5", "--flicker", "2"]],
  ])
    test(`sliders edit as the program does: ${words.join(" ")}`, async () => {
      const frames = 60, page = await open(url + "#play=0"), {graphs} = synthesize(frames, ...words);
      await page.evaluate((s) => emberfold.set(s), settings);
      assert.ok(apart(await graphsOf(page, frames, 1), graphs) < 1e-6);
      for (const word of words) assert.ok((await page.textContent("#command")).includes(word), word);
      await close(page);
    });

  test("without WebGL the processor fills the same", async () => {
    const script = withoutGraphics, page = await open(url + "#play=0", {}, script), {images} = synthesize(10);
    assert.equal(await page.evaluate(() => emberfold.renderer), "processor");
    assert.match(await page.textContent("#slow"), /WebGL 2/);
    const other = await open(url + "#play=0"), ours = await differences(page, images), theirs = await differences(other, images);
    ours.forEach((d, t) => assert.ok(Math.abs(d - theirs[t]) < 0.05, `frame ${t}: ${d} and ${theirs[t]}`));
    await close(other);
    await close(page);
  });
});

describe("the page", () => {
  test("plays, pauses, counts events, and shows strokes", async () => {
    const page = await open(url);
    await page.waitForFunction(() => emberfold.frame >= 12);
    await page.keyboard.press(" ");
    const frame = await page.evaluate(() => emberfold.frame), {frames, sums} = await page.evaluate(() => emberfold.events);
    assert.equal(frames, frame);
    assert.equal(await page.textContent("#births-count"), String(sums[0]));
    await page.waitForTimeout(300);
    assert.equal(await page.evaluate(() => emberfold.frame), frame);
    const plain = await page.evaluate(() => emberfold.pixels().join());
    await page.check("#strokes");
    assert.notEqual(await page.evaluate(() => emberfold.pixels().join()), plain);
    await page.uncheck("#strokes");
    assert.equal(await page.evaluate(() => emberfold.pixels().join()), plain);
    await close(page);
  });

  test("keeps its settings in its address", async () => {
    const page = await open(url + "#splits=2&windx=1&reverse=1&seed=9&play=0&births=99&speed=x");
    assert.deepEqual(await page.evaluate(() => emberfold.settings), {
      speed: 1, reverse: true, intensity: 1, flicker: 1, contrast: 1, windx: 1, windy: 0,
      births: 1, deaths: 1, splits: 2, merges: 1, connects: 1, disconnects: 1});
    assert.equal(await page.inputValue("#seed"), "9");
    await page.click("#all-reset");
    await page.waitForFunction(() => document.getElementById("message").textContent === "");
    await page.waitForFunction(() => location.hash === "#seed=9&play=0");
    await close(page);
  });

  test("tells in words what a model cannot do, and goes on as before", async () => {
    const page = await open(url + "#play=0");
    await page.evaluate(() => emberfold.set({births: 4, deaths: 0.1}));
    assert.match(await page.textContent("#message"), /births/);
    assert.equal((await page.evaluate(() => emberfold.settings)).births, 1);
    await page.click("#step");
    assert.equal(await page.evaluate(() => emberfold.frame), 1);
    await close(page);
  });

  for (const viewport of [{width: 390, height: 844}, {width: 1280, height: 900}])
    test(`nothing lies beside the window: ${viewport.width} px`, async () => {
      const page = await open(url + "#play=0", {viewport});
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
      await close(page);
    });
});
