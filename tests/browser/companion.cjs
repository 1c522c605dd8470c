// The companion's page: an empty folder, a session, captures, then what to do next. Run by companion_test.py.
const fs = require("node:fs");
const path = require("node:path");
const { accessible, assert, close, facts, open, picture, withBrowser } = require("./browser.cjs");

const capture = (name) => {
  for (const sensor of ["left", "right"]) {
    fs.mkdirSync(path.join(facts.growing, sensor), { recursive: true });
    const file = fs.readdirSync(path.join(facts.whole, sensor)).find((one) => one.startsWith(name + "."));
    fs.copyFileSync(path.join(facts.whole, sensor, file), path.join(facts.growing, sensor, "." + file));
    fs.renameSync(path.join(facts.growing, sensor, "." + file), path.join(facts.growing, sensor, file));
  }
};
const says = (page, text) => page.waitForFunction((wanted) => document.querySelector("#headline").textContent.includes(wanted), text);
const counts = (page, text) => page.waitForFunction((wanted) => document.querySelector("#count").textContent === wanted, text);

withBrowser(async (browser) => {
  const page = await open(browser, facts.address + "/", { viewport: { width: 390, height: 844 } });
  await says(page, "session.yaml");
  await accessible(page);

  fs.copyFileSync(path.join(facts.whole, "session.yaml"), path.join(facts.growing, "session.yaml"));
  await says(page, "Hold the board");
  assert.strictEqual(await page.locator("[data-sensor]").count(), 2);
  assert.ok((await page.locator("[data-look]").count()) >= 2, "two cameras see the next place");

  const names = [...new Set(fs.readdirSync(path.join(facts.whole, "left")).map((file) => file.split(".")[0]))].sort();
  capture(names[0]);
  await counts(page, "1 capture");
  assert.ok((await page.locator("[data-sensor=left] circle.corner").count()) > 20, "corners over the picture");
  await page.waitForFunction(() => [...document.querySelectorAll("[data-sensor] image")].length === 2);
  assert.ok((await page.textContent("[data-sensor=right] dl")).includes("1 of 1"), "board found in");
  capture(names[1]);
  capture(names[2]);
  await counts(page, "3 captures");
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390, "nothing beside the phone's screen");
  await picture(page, "companion");
  await accessible(page);

  fs.rmSync(path.join(facts.growing, "right", fs.readdirSync(path.join(facts.growing, "right")).find((file) => file.startsWith(names[2]))));
  await page.waitForFunction((name) => document.querySelector("#remarks").textContent.includes(name + " is missing"), names[2]);
  await close(page);
}).catch((error) => {
  console.error(error);
  process.exit(1);
});
