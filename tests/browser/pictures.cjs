// The pictures of README.md, of the pages of a server with that robot or a fleet. Run by deploy/pictures.
const { close, facts, open, withBrowser } = require("./browser.cjs");

const DESK = { width: 1280, height: 1320 };
const PHONE = { width: 390, height: 844 };
const REPORT = `/robots/${facts.robot}/revisions/1/`;

// Of pages: name, path, and how the browser shows it.
const PAGES = [
  ["report.png", REPORT, { viewport: DESK }],
  ["report-dark.png", REPORT, { viewport: DESK, colorScheme: "dark" }],
  ["report-phone.png", REPORT, { viewport: PHONE }],
  ["fleet.png", "/", { viewport: { width: 1280, height: 1120 } }],
  ["fleet-phone.png", "/", { viewport: PHONE }],
];

// Of the report's own files: name, what finds it on the page, and how wide it is shown.
const FILES = [
  ["cloud-front.png", "img[alt='Coloured cloud of lidar_vertical, front']", 1280],
  ["cloud-oblique.jpg", "img[alt='Coloured cloud of lidar_vertical, oblique']", 960],
  ["overlay.jpg", "img[src$='overlay/front_left.jpg']", 960],
];

async function takePage(browser, [name, path, options]) {
  const page = await open(browser, facts.address + path, options);
  if (path === REPORT) await page.waitForSelector("canvas", { state: "attached" });
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  await page.screenshot({ path: `${facts.out}/${name}` });
  await close(page);
  console.log(name);
}

// The picture alone, as wide as asked.
async function takeFile(browser, [name, selector, width]) {
  const page = await open(browser, facts.address + REPORT);
  const found = await page.$eval(selector, async (image) => {
    const whole = new Image();
    whole.src = image.src;
    await whole.decode();
    return { address: image.src, height_per_width: whole.naturalHeight / whole.naturalWidth };
  });
  await page.setViewportSize({ width, height: Math.round(width * found.height_per_width) });
  await page.evaluate(async ({ address }) => {
    const image = new Image();
    image.src = address;
    await image.decode();
    image.style.cssText = "position: fixed; inset: 0; width: 100vw; height: 100vh; max-width: none; z-index: 9999; border: 0; border-radius: 0";
    document.body.append(image);
  }, found);
  const kind = name.endsWith(".jpg") ? { type: "jpeg", quality: 88 } : { type: "png" };
  await page.screenshot({ path: `${facts.out}/${name}`, ...kind });
  await close(page);
  console.log(name);
}

withBrowser(async (browser) => {
  for (const one of PAGES.filter(([, path]) => (path === REPORT) === (facts.kind === "report"))) await takePage(browser, one);
  if (facts.kind === "report") for (const one of FILES) await takeFile(browser, one);
}).catch((error) => {
  console.error(error);
  process.exit(1);
});
