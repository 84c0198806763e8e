// Opens the page that `penumbral chart` writes in headless Chromium and clicks through it:
//
//     npm install && node check.mjs DIR/report.html [picture.png]
//
// It fails on an error in the page, on anything asked for from elsewhere, and where the slider, the selects and the error maps
// do not change what is shown. CHROMIUM names the browser where it is not /usr/bin/chromium.

import assert from "node:assert/strict";
import path from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [page_file, picture] = process.argv.slice(2);
assert(page_file, "give the page: node check.mjs DIR/report.html");
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox"],
});
try {
  const page = await browser.newPage({ viewport: { width: 1600, height: 1200 } });
  const problems = [];
  const url = pathToFileURL(path.resolve(page_file)).href;
  page.on("pageerror", error => problems.push(`error: ${error.message}`));
  page.on("console", message => message.type() === "error" && problems.push(message.text()));
  page.on("request", request => {
    if (request.url() !== url && !request.url().startsWith("data:")) problems.push(`asks for ${request.url()}`);
  });
  await page.goto(url);

  const charts = await page.locator("figure svg").count();
  assert(charts >= 2, `${charts} charts`);
  const scenes = await page.locator("#scene option").count();
  const methods = await page.locator("#left option").count();
  assert(scenes >= 1 && methods >= 10, `${scenes} scenes, ${methods} methods`);

  const shown = () => page.evaluate(() => {
    const image = id => document.getElementById(id);
    return {
      left: image("above").src.length,
      right: image("below").src.length,
      loaded: image("above").naturalWidth > 0 && image("below").naturalWidth > 0,
      clip: image("above").style.clipPath,
      words: document.getElementById("words").textContent,
    };
  });
  const first = await shown();
  assert(first.loaded, "the shadows are not shown");

  await page.locator("#slider").fill("20");
  const slid = await shown();
  assert.notEqual(slid.clip, first.clip, "the slider moves nothing");

  await page.locator("#errors").check();
  const errors = await shown();
  assert.notEqual(errors.right, slid.right, "error maps are the shadows");

  for (let scene = 0; scene < scenes; scene++) {
    await page.locator("#scene").selectOption(String(scene));
    for (let method = 0; method < methods; method++) {
      await page.locator("#left").selectOption(String(method));
      await page.locator("#right").selectOption(String((method + 3) % methods));
      const now = await shown();
      assert.match(now.words, /levels at most/, `scene ${scene}, method ${method}`);
    }
  }
  await page.waitForFunction(() => document.getElementById("above").naturalWidth > 0);

  const rows = await page.locator("#rows tr").count();
  assert(rows >= methods / 2, `${rows} rows`);
  const options = await page.locator("#rows-scene option").count();
  await page.locator("#rows-scene").selectOption(String(options - 1));

  assert.deepEqual(problems, []);
  if (picture) await page.screenshot({ path: picture, fullPage: true });
  console.log(`${charts} charts, ${scenes} scenes, ${methods} methods, ${rows} rows of the first scene: all shown, nothing asked for`);
} finally {
  await browser.close();
}
