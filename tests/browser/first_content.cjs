// When each of `facts.paths` shows its first content, in seconds from the click: the median of nine loads in fresh contexts, the pages in
// turns, so that what else the machine does meets them all alike.
const { facts, open, withBrowser } = require("./browser.cjs");

const ROUNDS = 9;
const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];

async function once(browser, path) {
  const page = await open(browser, facts.address + path);
  const shown_ms = await page.evaluate(() => new Promise((done) => {
    new PerformanceObserver((list) => list.getEntriesByName("first-contentful-paint").forEach((one) => done(one.startTime))).observe({ type: "paint", buffered: true });
  }));
  await page.context().close();
  return shown_ms / 1000;
}

withBrowser(async (browser) => {
  const shown_s = facts.paths.map(() => []);
  await once(browser, facts.paths[0]);  // the browser's own start
  for (let round = 0; round < ROUNDS; ++round)
    for (const [index, path] of facts.paths.entries()) shown_s[index].push(await once(browser, path));
  console.log(JSON.stringify(shown_s.map(median)));
}).catch((error) => {
  console.error(error);
  process.exit(1);
});
