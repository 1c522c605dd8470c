// The fleet's page of a new server, and the first robot that comes. Run by pages_test.py.
const { spawnSync } = require("node:child_process");
const { accessible, assert, close, facts, open, withBrowser } = require("./browser.cjs");

withBrowser(async (browser) => {
  const page = await open(browser, facts.address + "/");
  await accessible(page);
  assert.ok((await page.textContent("#live")).includes("rigcal push"), "what to do first");
  await page.waitForResponse((reply) => reply.url().includes("/api/v1/live"));
  const pushed = spawnSync(facts.push[0], facts.push.slice(1));
  assert.ok([0, 5].includes(pushed.status), String(pushed.stderr));
  await page.waitForFunction(() => document.querySelector("#live tbody th")?.textContent === "rover");
  assert.ok(await page.locator("form[role=search]").isVisible(), "it is the page of a fleet");
  await close(page);
}).catch((error) => {
  console.error(error);
  process.exit(1);
});
