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
