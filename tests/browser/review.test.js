// SPDX-License-Identifier: Apache-2.0
// review.html in a headless Chromium: questions, keys, undo, and the file that analyze and score take.
import assert from "node:assert/strict";
import {readFileSync, writeFileSync} from "node:fs";
import {join} from "node:path";
import {after, before, describe, test} from "node:test";
import {chromium} from "playwright-core";
import {emberfold, folder, removeFolder} from "./models.js";

let browser, run;
const wrong = [];

async function open(options = {}) {
  const context = await browser.newContext({viewport: {width: 1280, height: 900}, acceptDownloads: true, ...options});
  context.setDefaultTimeout(120_000);  // machines that build may be slow
  const page = await context.newPage();
  page.on("console", (message) => { if (["error", "warning"].includes(message.type())) wrong.push(message.text()); });
  page.on("pageerror", (error) => wrong.push(String(error)));
  page.on("request", (request) => { if (!/^(file|data|blob):/.test(request.url())) wrong.push(request.url()); });
  await page.goto("file://" + join(run, "review.html"));
  return page;
}
const state = (page) => page.evaluate(() => ({answers: [...emberfold.answers], current: emberfold.current,
  events: JSON.parse(document.getElementById("data").textContent).events.map(({strip, ...event}) => event)}));
async function download(page) {
  const [saved] = await Promise.all([page.waitForEvent("download"), page.keyboard.press("w")]);
  assert.equal(saved.suggestedFilename(), "review.json");
  const to = join(folder, "review.json");
  await saved.saveAs(to);
  return to;
}

before(async () => {
  browser = await chromium.launch({
    timeout: 120_000,
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: ["--no-sandbox"],
  });
  run = join(folder, "run");
  emberfold("analyze", "builtin:fire", "-o", run, "--scale", "0.6", "--range", "0:40", "-q");
});
after(async () => {
  await browser?.close();
  removeFolder();
});

describe("review", () => {
  test("asks about doubtful events first, and shows seven frames of each", async () => {
    const page = await open(), {events, current} = await state(page);
    assert.ok(events.length >= 5, `${events.length} events`);
    assert.equal(current, 0);
    const doubts = events.map((event) => Math.abs(event.probability - .5));
    assert.deepEqual(doubts, [...doubts].sort((a, b) => a - b));
    const size = await page.evaluate(async () => {
      const image = new Image();
      image.src = JSON.parse(document.getElementById("data").textContent).events[0].strip;
      await image.decode();
      return [image.width, image.height];
    });
    assert.equal(size[0], 7 * size[1]);
    const frames = await page.locator("#frames li").allTextContents();
    assert.equal(frames.length, 7);
    assert.equal(frames[3], String(events[0].frame));
    // the strip is drawn: not of one colour
    const colours = await page.evaluate(() => {
      const canvas = document.getElementById("strip"), pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
      return new Set(Array.from({length: 2000}, (_, i) => pixels[4 * Math.floor(i * pixels.length / 8000)])).size;
    });
    assert.ok(colours > 10, `${colours} colours`);
    await page.context().close();
  });

  test("keys answer, another class too; undo takes back; the file holds all", async () => {
    const page = await open(), {events} = await state(page);
    await page.keyboard.press("y");
    assert.equal((await state(page)).answers[0], "yes");
    assert.equal((await state(page)).current, 1);
    await page.keyboard.press("n");
    const other = events[2].type === "merge" ? "c" : "m", name = events[2].type === "merge" ? "connect" : "merge";
    await page.keyboard.press(other);
    await page.keyboard.press("n");
    await page.keyboard.press("u");
    const now = await state(page);
    assert.deepEqual(now.answers.slice(0, 4), ["yes", "no", name, null]);
    assert.equal(now.current, 3);
    // the class that it has already is a yes
    await page.locator("#previous").click();
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press({birth: "b", death: "d", split: "s", merge: "m", connect: "c", disconnect: "x"}[events[3].type]);
    assert.equal((await state(page)).answers[3], "yes");
    await page.keyboard.press("u");
    const file = await download(page), review = JSON.parse(readFileSync(file, "utf8"));
    assert.equal(review.format, "emberfold.review");
    const all = JSON.parse(readFileSync(join(run, "events_all.json"), "utf8")).events;
    assert.equal(review.events.length, all.length);
    assert.deepEqual(review.events.map((event) => event.answer).filter((answer) => answer !== null).sort(), ["no", "yes", name].sort());
    await page.context().close();

    // the page goes on from it
    const again = await open();
    await again.locator("#load").setInputFiles(file);
    await again.locator("#note", {hasText: "3 answers"}).waitFor();
    assert.deepEqual((await state(again)).answers.slice(0, 4), ["yes", "no", name, null]);
    writeFileSync(join(folder, "no_review.json"), "{}");
    await again.locator("#load").setInputFiles(join(folder, "no_review.json"));
    await again.locator("#note", {hasText: "was not taken"}).waitFor();
    await again.context().close();

    // analyze takes the answers as facts, score as truth
    const to = join(folder, "reviewed");
    emberfold("analyze", "builtin:fire", "-o", to, "--scale", "0.6", "--range", "0:40", "-q", "--review", file);
    const summary = JSON.parse(readFileSync(join(to, "summary.json"), "utf8"));
    assert.deepEqual([summary.review.yes, summary.review.no, summary.review.other, summary.review.unmatched], [1, 1, 1, 0]);
    const told = JSON.parse(readFileSync(join(to, "events_all.json"), "utf8")).events;
    const at = (event, type) => told.find((one) => one.frame === event.frame && one.type === type &&
      Math.hypot(one.x - event.x, one.y - event.y) < 1e-3);
    assert.equal(at(events[0], events[0].type).probability, 1);
    assert.equal(at(events[1], events[1].type).probability, 0);
    assert.equal(at(events[2], name).probability, 1);
    const score = JSON.parse(emberfold("score", file, join(to, "events.json"), "--json"));
    assert.equal(score.six.all.true, 2);
    assert.equal(score.six.all.recall, 1);
    assert.equal(score.six.all.precision, 1);
  });

  test("fits a narrow screen and needs no mouse", async () => {
    const page = await open({viewport: {width: 390, height: 800}});
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
    assert.ok(wide <= 0, `${wide} px too wide`);
    await page.locator("#yes").focus();
    await page.keyboard.press("Enter");
    assert.equal((await state(page)).answers[0], "yes");
    await page.context().close();
    assert.deepEqual(wrong, []);
  });
});
