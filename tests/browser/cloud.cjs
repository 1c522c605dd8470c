// Turns a cloud of two million points. Run by cloud_test.py.
const { accessible, assert, close, colors, facts, open, withBrowser } = require("./browser.cjs");

// A page with the clouds of two lidars, top and base.
async function showAll(browser) {
  const all = await open(browser, facts.address + facts.path);
  await all.click("text=Open all 2 lidars in one scene");
  await all.waitForSelector(".cloud .view[data-frames]");
  const first = await all.$eval(".cloud canvas", (canvas) => canvas.toDataURL());
  await all.selectOption(".cloud select", "lidar");
  await all.waitForFunction((old) => document.querySelector(".cloud canvas").toDataURL() !== old, first, { polling: 200 });
  assert.strictEqual(await all.textContent(".cloud .legend"), "topbase", "a colour for each lidar");
  assert.strictEqual(await all.locator(".cloud option[value=camera]").count(), 0, "each lidar numbers cameras of its own");
  await close(all);
}

withBrowser(async (browser) => {
  const page = await open(browser, facts.address + facts.path);
  const start = Date.now();
  await page.click("text=Open top in 3D");
  await page.waitForSelector(".cloud .view[data-frames]");
  console.log(JSON.stringify({ visible_s: (Date.now() - start) / 1000 }));
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done)))));
  assert.strictEqual(await page.getAttribute(".cloud .view", "data-frames"), "1", "millions of points are drawn once");
  assert.ok((await colors(page, ".cloud canvas")) > 100, "the points are drawn in their colours");
  assert.ok((await page.textContent(".cloud .bar")).includes("2 million points"));
  const drawn = () => page.$eval(".cloud canvas", (canvas) => canvas.toDataURL());
  const seen = new Set([await drawn()]);
  const legend = () => page.textContent(".cloud .legend");
  const legends = new Set([await legend()]);
  for (const mode of ["camera", "depth", "intensity", "uncovered"]) {
    const before = await drawn();
    await page.selectOption(".cloud select", mode);
    const changed = (old) => document.querySelector(".cloud canvas").toDataURL() !== old;
    await page.waitForFunction(changed, before, { polling: 200 });
    seen.add(await drawn());
    legends.add(await legend());
  }
  assert.strictEqual(legends.size, 5, "what the colours mean, for each way");
  assert.strictEqual(seen.size, 5, "each way of colouring looks different");
  await page.focus(".blend input");
  for (const key of ["Home", "ArrowRight"]) await page.keyboard.press(key);
  assert.strictEqual(await page.$eval(".overlay img + img", (image) => getComputedStyle(image).opacity), "0.01", "by the keyboard, too");
  await page.$eval(".blend input", (field) => { field.value = 0; field.dispatchEvent(new Event("input")); });
  assert.strictEqual(await page.$eval(".overlay img + img", (image) => getComputedStyle(image).opacity), "0");
  await accessible(page);
  await close(page);
  if (facts.lidars > 1) await showAll(browser);
  const again = await open(browser, facts.address + facts.path);
  await again.route("**/points.bin", (route) => route.abort());
  await again.click("text=Open top in 3D");
  await again.waitForSelector(".cloud [role=alert]");
  await again.unroute("**/points.bin");
  await again.click("text=Open top in 3D");
  await again.waitForSelector(".cloud .view[data-frames]");
  assert.strictEqual(await again.locator(".cloud [role=alert]").count(), 0, "another attempt may be better");
}).catch((error) => {
  console.error(error);
  process.exit(1);
});
