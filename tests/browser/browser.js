// SPDX-License-Identifier: Apache-2.0
// A headless Chromium, and pages of models in it that note whatever goes wrong.
import assert from "node:assert/strict";
import {chromium} from "playwright-core";

let browser;
const pageErrors = new Map();

export async function startBrowser() {
  browser = await chromium.launch({
    timeout: 120_000,
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });
}
export const stopBrowser = () => browser?.close();

/** A page that notes whatever goes wrong, and whatever it asks of the network. */
export async function open(url, options = {}, script = null) {
  const context = await browser.newContext({viewport: {width: 1280, height: 900}, ...options});
  context.setDefaultTimeout(120_000);  // machines that build may be slow
  const page = await context.newPage(), wrong = [];
  page.on("console", (message) => { if (["error", "warning"].includes(message.type())) wrong.push(message.text()); });
  page.on("pageerror", (error) => wrong.push(String(error)));
  page.on("request", (request) => { if (!/^(file|data|blob):/.test(request.url())) wrong.push(request.url()); });
  pageErrors.set(page, wrong);
  if (script) await page.addInitScript(script);
  await page.goto(url);
  await page.evaluate(() => emberfold.ready);
  return page;
}
export async function close(page) {
  assert.deepEqual(pageErrors.get(page), []);
  await page.context().close();
}

/** Mean and largest difference of levels between what the page shows, from here on, and each of the frames (data URIs). */
export function frameDifferences(page, frames, name) {
  return page.evaluate(async ([uris, canvasName]) => {
    const all = [];
    for (const [t, frame] of uris.entries()) {
      if (t > 0) emberfold.step();
      const image = new Image();
      image.src = frame;
      await image.decode();
      const canvas = new OffscreenCanvas(image.width, image.height), context = canvas.getContext("2d", {willReadFrequently: true});
      context.drawImage(image, 0, 0);
      const theirs = context.getImageData(0, 0, image.width, image.height).data, ours = emberfold.pixels(canvasName);
      let sum = 0, most = 0;
      for (let i = 0; i < ours.length; ++i) {
        const apart = Math.abs(ours[i] - theirs[i]);
        sum += apart;
        most = Math.max(most, apart);
      }
      all.push({mean: sum / (0.75 * ours.length), most});  // opacity is the fourth
    }
    return all;
  }, [frames, name]);
}
