// SPDX-License-Identifier: Apache-2.0
// `emberfold dytex page` in a headless Chromium: what the page does is held against what the program does.
import assert from "node:assert/strict";
import {after, before, describe, test} from "node:test";
import {close, frameDifferences, open, startBrowser, stopBrowser} from "./browser.js";
import {edit, emberfold, folder, learn, readArray, relativeDifference, removeFolder, stillClip, synthesize} from "./models.js";

const models = {};

/** The page's matrices as plain numbers. */
function modelOf(page) {
  return page.evaluate(() => {
    const plain = ({rows, cols, data}) => ({rows, cols, data: [...data]});
    const {A, B, weights} = emberfold.model;
    return {A: plain(A), B: plain(B), weights: [...weights]};
  });
}

/** B B'. */
function squared({rows, cols, data}) {
  const product = new Array(rows * rows).fill(0);
  for (let k = 0; k < cols; ++k)
    for (let j = 0; j < rows; ++j)
      for (let i = 0; i < rows; ++i) product[j * rows + i] += data[k * rows + i] * data[k * rows + j];
  return {rows, cols: rows, data: product};
}

/** Largest difference between what the page shows, step by step, and frames of the program. */
async function difference(page, frames, name) {
  return Math.max(...(await frameDifferences(page, frames, name)).map(({most}) => most));
}
/** The same from the seed's first frame on. */
async function clipDifference(page, seed, frames) {
  await page.evaluate((s) => { emberfold.pause(); emberfold.restart(s); }, String(seed));
  return difference(page, frames);
}
/** Makes a page that offers no WebGL. */
function withoutGraphics() {
  const get = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, ...rest) { return kind === "webgl2" ? null : get.call(this, kind, ...rest); };
}
const digest = (page, name) => page.evaluate((n) => emberfold.pixels(n).join(), name);

before(async () => {
  await startBrowser();
  const small = ["--scale", "0.2", "--range", "0:40"];
  models.colour = learn("colour", "builtin:fire", "-n", "18", ...small);
  models.grey = learn("grey", "builtin:river", "--grey", "-n", "8", ...small);
  models.longer = learn("longer", "builtin:river", "--grey", "-n", "4", "--method", "n4sid", ...small);  // a state of eight numbers
  models.still = learn("still model's", stillClip("clip", 24, 20, 4, 90), "-n", "3");
});
after(async () => {
  await stopBrowser();
  removeFolder();
});

describe("the same numbers as the program's", () => {
  for (const [name, seed] of [["colour", 7n], ["grey", 2n ** 64n - 1n], ["longer", 1n]])
    test(`a seed gives the clip of dytex synth: ${name}`, async () => {
      const {model, url} = models[name], page = await open(url + "#play=0");
      assert.ok(await clipDifference(page, seed, synthesize(model, seed, 12)) <= 2);
      await close(page);
    });

  const edits = [
    {speed: 2.5}, {flow: 0.4}, {flow: 2}, {flow: 0}, {speed: -1.5, flow: 0.6}, {reverse: true, speed: 0.5, flow: 1.5}, {speed: -1}, {reverse: true}, {intensity: 0.4}, {coarse: 0.5, medium: 2, fine: 0},
    {reverse: true, speed: 0.3, intensity: 1.5, coarse: 1.2, fine: 0.5},
  ];
  for (const name of ["colour", "grey"])
    test(`edits are those of dytex edit: ${name}`, async () => {
      const {model, url} = models[name], page = await open(url + "#play=0");
      for (const settings of edits) {
        const changed = edit(model, settings);
        await page.evaluate((s) => emberfold.set({reverse: false, speed: 1, flow: 1, intensity: 1, coarse: 1, medium: 1, fine: 1, ...s}), settings);
        const {A, B, weights} = await modelOf(page), told = JSON.stringify(settings);
        assert.ok(relativeDifference(A, readArray(changed, "A")) < 1e-9, `A at ${told}`);
        // Where the noise has a null space, flow leaves open which way its inputs lie.
        const [ours, theirs] = "flow" in settings ? [squared(B), squared(readArray(changed, "B"))] : [B, readArray(changed, "B")];
        assert.ok(relativeDifference(ours, theirs) < 1e-7, `B at ${told}`);
        assert.ok(relativeDifference({rows: weights.length, cols: 1, data: weights}, readArray(changed, "weights")) < 1e-12, `weights at ${told}`);
      }
      const last = edit(model, edits.at(-1));
      assert.ok(await clipDifference(page, 5n, synthesize(last, 5n, 6)) <= 2);
      await close(page);
    });

  for (const [name, weights, words] of [["colour", "2:0.5,17:3", [1, 0.5, ...Array(14).fill(1), 3]], ["grey", "2:0", [1, 0]]])
    test(`weights of single components are those of dytex edit: ${name}`, async () => {
      const {model, url} = models[name], page = await open(url + `#play=0&coarse=2&weights=${weights}`);
      const changed = edit(model, {coarse: 2, weights: words.join(",")}), now = (await modelOf(page)).weights;
      assert.ok(relativeDifference({rows: now.length, cols: 1, data: now}, readArray(changed, "weights")) < 1e-12);
      assert.ok((await page.textContent("#command")).includes(`--coarse 2 --weights ${words.join(",")} &&`));
      await close(page);
    });

  for (const [name, frames, edits] of [["colour", 12, {}], ["grey", 30, {speed: 0.5, fine: 2}], ["grey", 5, {reverse: true}], ["still", 4, {}]])
    test(`a loop is that of dytex synth --loop: ${name}`, async () => {
      const {model, url} = models[name], page = await open(url + "#play=0&seed=8");
      await page.evaluate((s) => emberfold.set(s), {...edits, loop: frames});
      const changed = Object.keys(edits).length > 0 ? edit(model, edits) : model;
      assert.ok(await clipDifference(page, 8n, synthesize(changed, 8n, frames, "--loop", String(frames))) <= 3);
      const last = await digest(page, "result");
      await page.evaluate(() => emberfold.step());
      assert.equal(await page.evaluate(() => emberfold.frame), 0);
      const first = await digest(page, "result");
      await page.evaluate((n) => { for (let t = 1; t < n; ++t) emberfold.step(); }, frames);
      assert.equal(await digest(page, "result"), last);
      assert.equal(name === "still", first === last);
      await close(page);
    });

  test("slower flow is that of dytex edit, and at 0 the clip stands still", async () => {
    const {model, url} = models.colour, page = await open(url + "#play=0&flow=0.5");
    assert.ok(await clipDifference(page, 6n, synthesize(edit(model, {flow: 0.5}), 6n, 8)) <= 3);
    await page.evaluate(() => { emberfold.set({flow: 0}); emberfold.restart(6n); });
    const still = await page.evaluate(() => [...emberfold.pixels()]);
    await page.evaluate(() => { for (let t = 0; t < 20; ++t) emberfold.step(); });
    const later = await page.evaluate(() => [...emberfold.pixels()]);
    assert.ok(still.every((v, i) => Math.abs(v - later[i]) <= 1) && still.filter((v, i) => v !== later[i]).length < still.length / 1000);
    await close(page);
  });

  test("a page of an edited model begins from it", async () => {
    const changed = edit(models.colour.model, {speed: 1.5, coarse: 2});
    emberfold("dytex", "page", changed, "-o", `${folder}/edited.html`, "-q");
    const page = await open(`file://${folder}/edited.html#play=0`);
    assert.ok(relativeDifference((await modelOf(page)).A, readArray(changed, "A")) === 0);
    assert.match(await page.textContent("#about"), /edited: --speed 1.5 --coarse 2/);
    assert.ok(await clipDifference(page, 3n, synthesize(changed, 3n, 6)) <= 3);  // twice the coarse components, twice their error
    await close(page);
  });

  test("the source is the training frames as the model keeps them", async () => {
    const {model, url} = models.colour, page = await open(url + "#play=0&speed=2&intensity=3&coarse=0");
    for (let frame = 0; frame < 3; ++frame) {
      assert.equal(await page.textContent("#source-frame"), `frame ${frame} of 40`);
      const [truth] = synthesize(model, 1, 1, "--start", String(frame));
      assert.ok(await difference(page, [truth], "source") <= 2);
      await page.click("#step");
    }
    await close(page);
  });
});

describe("the page", () => {
  test("moves, and stands still when paused", async () => {
    const page = await open(models.colour.url);
    assert.equal(await page.evaluate(() => emberfold.renderer), "webgl2");
    await page.waitForFunction(() => emberfold.frame >= 5);
    const first = await digest(page, "result");
    await page.waitForFunction((at) => emberfold.frame >= at + 3, await page.evaluate(() => emberfold.frame));
    assert.notEqual(await digest(page, "result"), first);
    await page.keyboard.press(" ");
    const frame = await page.evaluate(() => emberfold.frame), still = await digest(page, "result");
    await page.waitForTimeout(200);
    assert.equal(await page.evaluate(() => emberfold.frame), frame);
    assert.equal(await digest(page, "result"), still);
    await page.keyboard.press(".");
    assert.equal(await page.evaluate(() => emberfold.frame), frame + 1);
    await page.keyboard.press("r");
    assert.equal(await page.evaluate(() => emberfold.frame), 0);
    await close(page);
  });

  test("has sliders that each change what they name, by the keyboard alone", async () => {
    const page = await open(models.colour.url + "#play=0&seed=4"), learned = await modelOf(page);
    for (const name of ["speed", "intensity", "coarse", "medium", "fine"]) {
      const before = await digest(page, "result");
      await page.focus("#" + name);
      for (let i = 0; i < 4; ++i) await page.keyboard.press("ArrowRight");
      await page.waitForFunction((n) => Math.abs(emberfold.settings[n] - 1.2) < 1e-9, name);
      assert.match(await page.textContent(`#${name}-value`), /^1.20\s×$/);
      assert.match(await page.textContent("#command"), new RegExp(`dytex edit .* --${name} 1.2 &&[^]*--seed 4$`));
      await page.waitForFunction((n) => location.hash.includes(`${n}=1.2`), name);
      const now = await modelOf(page), same = (part) => relativeDifference(now[part], learned[part]) === 0;
      const weights = now.weights.map((w, i) => w / learned.weights[i]);
      const expected = {coarse: [1.2, 1, 1], medium: [1, 1.2, 1], fine: [1, 1, 1.2]}[name] ?? [1, 1, 1];
      weights.forEach((w, i) => assert.ok(Math.abs(w - expected[i < 5 ? 0 : i < 15 ? 1 : 2]) < 1e-12));
      assert.equal(same("A"), name !== "speed");
      assert.equal(same("B"), name !== "speed" && name !== "intensity");
      if (!["speed", "intensity"].includes(name)) assert.notEqual(await digest(page, "result"), before);  // at once
      await page.click(`#${name}-reset`);
      await page.waitForFunction((n) => emberfold.settings[n] === 1, name);
      assert.equal(await digest(page, "result"), before);
    }
    await close(page);
  });

  test("weighs a single component by its number", async () => {
    const page = await open(models.colour.url + "#play=0"), before = await digest(page, "result");
    await page.fill("#component", "3");
    await page.keyboard.press("Tab");
    await page.focus("#weight");
    await page.keyboard.press("Home");
    await page.waitForFunction(() => emberfold.settings.weights === "3:0");
    assert.notEqual(await digest(page, "result"), before);
    assert.match(await page.textContent("#weights"), /3 \(0.00\s×\)/);
    await page.fill("#component", "99");
    await page.keyboard.press("Tab");
    assert.equal(await page.inputValue("#component"), "18");
    assert.match(await page.textContent("#weight-value"), /1.00/);
    await page.fill("#component", "3");
    await page.keyboard.press("Tab");
    await page.click("#weight-reset");
    await page.waitForFunction(() => emberfold.settings.weights === "");
    assert.equal(await digest(page, "result"), before);
    for (const wrong of ["0:1", "19:1", "2:4", "x", "2", "2:1.5.1"]) {
      await page.evaluate((text) => { location.hash = `#weights=${text}&fine=2&play=0`; }, wrong);
      await page.waitForFunction(() => emberfold.settings.fine === 2);
      assert.equal(await page.evaluate(() => emberfold.settings.weights), "", wrong);
      await page.evaluate(() => emberfold.set({fine: 1}));
      await page.waitForFunction(() => !location.hash.includes("fine"));
    }
    await close(page);
  });

  test("draws what the sliders say", async () => {
    const page = await open(models.colour.url + "#play=0"), source = await digest(page, "source");
    const meanOnly = await page.evaluate(() => { emberfold.set({coarse: 0, medium: 0, fine: 0}); return emberfold.pixels().join(); });
    /** Mean distance of the pixels of 12 frames from the mean frame, and of each from the one before. */
    const movement = (settings) => page.evaluate(([settings, mean]) => {
      const centre = mean.split(",").map(Number), distance = (a, b) => a.reduce((sum, v, i) => sum + Math.abs(v - b[i]), 0) / a.length;
      emberfold.set({reverse: false, speed: 1, intensity: 1, coarse: 1, medium: 1, fine: 1, ...settings});
      emberfold.restart(9);
      let strength = 0, change = 0, last = emberfold.pixels();
      for (let t = 0; t < 12; ++t) {
        emberfold.step();
        const now = emberfold.pixels();
        strength += distance(now, centre);
        change += distance(now, last);
        last = now;
      }
      return {strength, change};
    }, [settings, meanOnly]);
    const learned = await movement({});
    assert.ok(learned.strength > 0 && learned.change > 0);
    assert.deepEqual(await movement({intensity: 0}), {strength: 0, change: 0});
    const weak = await movement({intensity: 0.25}), strong = await movement({intensity: 3});
    assert.ok(weak.strength < 0.65 * learned.strength && strong.strength > 1.3 * learned.strength);
    for (const scale of ["coarse", "medium", "fine"])
      assert.ok((await movement({[scale]: 0})).strength < learned.strength, scale);
    assert.notDeepEqual(await movement({speed: 2}), learned);
    assert.notDeepEqual(await movement({reverse: true}), learned);
    assert.deepEqual(await movement({}), learned);
    await page.evaluate(() => { emberfold.set({intensity: 3, coarse: 0}); emberfold.restart(); });
    assert.equal(await digest(page, "source"), source);
    await close(page);
  });

  test("keeps all settings in its address", async () => {
    const hash = "#speed=-1.5&intensity=2&fine=0.25&reverse=1&seed=18446744073709551615&play=0";
    const page = await open(models.colour.url + hash);
    const settings = () => page.evaluate(() => ({...emberfold.settings, seed: String(emberfold.seed), playing: emberfold.playing}));
    const wanted = {reverse: true, speed: -1.5, flow: 1, intensity: 2, coarse: 1, medium: 1, fine: 0.25, weights: "", loop: 0, seed: "18446744073709551615", playing: false};
    assert.deepEqual(await settings(), wanted);
    assert.match(await page.textContent("#command"), /--reverse --speed -1.5 --intensity 2 --fine 0.25 && [^]*--seed 18446744073709551615$/);
    await page.waitForFunction((h) => location.hash === h, hash);
    await page.reload();
    await page.evaluate(() => emberfold.ready);
    assert.deepEqual(await settings(), wanted);
    await page.evaluate(() => { location.hash = "#coarse=2&seed=8&play=0"; });
    await page.waitForFunction(() => emberfold.settings.coarse === 2 && emberfold.seed === 8n && !emberfold.settings.reverse);
    await page.evaluate(() => { location.hash = "#speed=99&intensity=x&coarse=-1&seed=-3&reverse=maybe&play=0"; });  // wrong: as learned
    await page.waitForFunction(() => emberfold.settings.coarse === 1 && emberfold.seed === 1n && emberfold.settings.speed === 1);
    await page.fill("#seed", "many");
    await page.keyboard.press("Tab");
    assert.match(await page.textContent("#message"), /seed is a whole number/);
    assert.equal(await page.inputValue("#seed"), "1");
    await close(page);
  });

  test("has presets that set the sliders as the program's do", async () => {
    const page = await open(models.colour.url + "#play=0");
    await page.click("button:text-is(\"rain\")");
    await page.waitForFunction(() => emberfold.settings.fine === 2);
    const changed = edit(models.colour.model, {preset: "rain"});
    const {B, weights} = await modelOf(page);
    assert.ok(relativeDifference(B, readArray(changed, "B")) < 1e-12);
    assert.ok(relativeDifference({rows: weights.length, cols: 1, data: weights}, readArray(changed, "weights")) < 1e-12);
    assert.equal(await page.getAttribute("button:text-is(\"rain\")", "aria-pressed"), "true");
    await page.click("#all-reset");
    await page.waitForFunction(() => emberfold.settings.fine === 1);
    assert.equal(await page.getAttribute("button:text-is(\"rain\")", "aria-pressed"), "false");
    await page.click("button:text-is(\"fire-slow\")");
    await page.waitForFunction(() => emberfold.settings.speed === 0.5);
    await page.click("button:text-is(\"rain\")");
    await page.waitForFunction(() => emberfold.settings.fine === 2);
    assert.equal(await page.evaluate(() => emberfold.settings.speed), 0.5);
    await close(page);
  });

  test("writes commands that a shell reads back, whatever the model is called", async () => {
    const page = await open(models.still.url + "#play=0");
    assert.equal(await page.evaluate(() => emberfold.command.match(/synth (.*) -o/)[1].replace(/'\\''/g, "'").slice(1, -1)), "still model's");
    await close(page);
  });

  test("without WebGL 2 is drawn by the processor, and says so", async () => {
    for (const name of ["colour", "grey"]) {
      const page = await open(models[name].url + "#play=0", {}, withoutGraphics);
      assert.equal(await page.evaluate(() => emberfold.renderer), "processor");
      assert.match(await page.textContent("#slow"), /WebGL 2/);
      assert.ok(await clipDifference(page, 2, synthesize(models[name].model, 2, 3)) <= 2);
      await close(page);
    }
  });

  test("of a model without components stands still and says so", async () => {
    const page = await open(models.still.url);
    await page.waitForFunction(() => emberfold.frame >= 2);
    await page.evaluate(() => emberfold.set({speed: 2, reverse: true, fine: 0}));
    assert.ok(await page.evaluate(() => emberfold.pixels().every((v, i) => v === (i % 4 === 3 ? 255 : 90))));
    assert.match(await page.textContent("#message"), /stands still|^$/);
    await close(page);
  });

  test("fits a phone and a desk, and every control has a name", async () => {
    for (const viewport of [{width: 360, height: 740}, {width: 1280, height: 800}]) {
      const page = await open(models.colour.url + "#play=0", {viewport});
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
      const nameless = await page.evaluate(() => [...document.querySelectorAll("input, button")]
        .filter((e) => !(e.labels?.length || e.ariaLabel || e.textContent.trim())).map((e) => e.id));
      assert.deepEqual(nameless, []);
      await close(page);
    }
  });
});
