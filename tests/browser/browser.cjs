// Chromium with a watch on everything that a page must not do.
const assert = require("node:assert");
const fs = require("node:fs");
const { chromium } = require("playwright-core");

const facts = JSON.parse(process.argv[2]);
const axeSource = fs.readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

// `facts.draws` "plainly": as Chromium draws where there is no graphics card, instead of on one that is emulated for WebGL, which
// compiles its programs anew before the first picture.
async function withBrowser(work) {
  const plain = facts.draws === "plainly" ? ["--disable-gpu-compositing", "--disable-gpu-rasterization"] : [];
  const browser = await chromium.launch({
    executablePath: facts.chromium,
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-dev-shm-usage", ...plain],
  });
  try {
    await work(browser);
  } finally {
    await browser.close();
  }
}

// Opens `url` with all its scripts in a context of its own, which `prepare` may change before; `page.faults` collects errors of the console and requests that leave the origin.
async function open(browser, url, { prepare, ...options } = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, ...options });
  if (prepare) await prepare(context);
  const page = await context.newPage();
  page.faults = [];
  const origin = url.startsWith("file:") ? "file://" : new URL(url).origin;
  page.on("pageerror", (error) => page.faults.push("error: " + error.message));
  page.on("console", (message) => {
    if (message.type() === "error") page.faults.push("console: " + message.text());
  });
  page.on("request", (request) => {
    const address = request.url();
    if (!address.startsWith(origin) && !/^(data|blob):/.test(address)) page.faults.push("leaves the origin: " + address);
  });
  const reply = await page.goto(url, { waitUntil: "load" });
  if (reply && !url.startsWith("file:")) {
    assert.strictEqual(reply.status(), 200, url);
    const policy = reply.headers()["content-security-policy"] ?? "";
    assert.ok(policy.includes("script-src 'self'") && !policy.includes("unsafe"), "policy of " + url + ": " + policy);
  }
  if (options.javaScriptEnabled !== false) await page.waitForFunction(() => !document.querySelector("script[data-scripts]") || document.documentElement.dataset.whole);
  return page;
}

async function close(page) {
  assert.strictEqual(await page.evaluate(() => window.ran), undefined, "a typed script ran on " + page.url());
  assert.deepStrictEqual(page.faults, [], page.url());
  await page.context().close();
}

async function accessible(page) {
  await page.evaluate(axeSource);
  const found = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
  const serious = found.violations.filter((one) => one.impact === "serious" || one.impact === "critical");
  const texts = serious.map((one) => `${one.id}: ${one.help}: ${one.nodes.slice(0, 3).map((node) => node.html.slice(0, 160)).join(" | ")}`);
  assert.deepStrictEqual(texts, [], "axe on " + page.url());
}

// How many different colours a canvas shows: one is an empty picture.
async function colors(page, selector) {
  return page.$eval(selector, (canvas) => {
    const copy = document.createElement("canvas");
    copy.width = canvas.width;
    copy.height = canvas.height;
    const context = copy.getContext("2d");
    context.drawImage(canvas, 0, 0);
    const seen = new Set();
    const data = context.getImageData(0, 0, copy.width, copy.height).data;
    for (let at = 0; at < data.length; at += 4) seen.add((data[at] << 16) | (data[at + 1] << 8) | data[at + 2]);
    return seen.size;
  });
}

const drawn = (page, selector) => page.waitForFunction((wanted) => {
  const canvas = document.querySelector(wanted);
  return canvas && canvas.width > 0;
}, selector);

// For people to look at, where RIGCAL_PICTURES names a folder.
async function picture(page, name) {
  if (process.env.RIGCAL_PICTURES) await page.screenshot({ path: `${process.env.RIGCAL_PICTURES}/${name}.png` });
}

module.exports = { accessible, assert, close, colors, drawn, facts, open, picture, withBrowser };
