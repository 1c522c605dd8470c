// Loads one page three times in a fresh context and prints the median: bytes, first content, when it can be used.
const { facts, open, withBrowser } = require("./browser.cjs");

const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];

async function readiness(page) {
  if (await page.locator("#rig").count()) await page.waitForSelector("#rig .view[data-frames]");
  else if (await page.locator("form.search").count()) await page.waitForSelector("form[data-ready]");
  return page.evaluate(() => performance.now() / 1000);
}

async function searched(page) {
  if (!(await page.locator("form.search input[type=search]").count())) return 0;
  const start = Date.now();
  await page.fill("form.search input[type=search]", "robot-4321");
  await page.waitForFunction(() => document.querySelectorAll("#live tbody tr").length === 1);
  return (Date.now() - start) / 1000;
}

async function once(browser) {
  const page = await open(browser, facts.path);
  const ready_s = await readiness(page);
  const measured = await page.evaluate(() => ({
    bytes: [...performance.getEntriesByType("navigation"), ...performance.getEntriesByType("resource")].reduce((sum, entry) => sum + entry.transferSize, 0),
    first_content_s: performance.getEntriesByName("first-contentful-paint")[0]?.startTime / 1000,
    count: document.querySelector(".count")?.textContent ?? "",
  }));
  const search_s = await searched(page);
  await page.context().close();
  return { ...measured, ready_s, search_s };
}

withBrowser(async (browser) => {
  const rounds = [];
  for (let round = 0; round < 3; ++round) rounds.push(await once(browser));
  const of = (name) => median(rounds.map((one) => one[name]));
  console.log(JSON.stringify({ bytes: of("bytes"), first_content_s: of("first_content_s"), ready_s: of("ready_s"), search_s: of("search_s"), count: rounds[0].count }));
}).catch((error) => {
  console.error(error);
  process.exit(1);
});
