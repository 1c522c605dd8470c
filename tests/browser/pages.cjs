// What people do with the pages. Run by pages_test.py.
const { spawnSync } = require("node:child_process");
const { accessible, assert, close, colors, drawn, facts, open, picture, withBrowser } = require("./browser.cjs");

const at = (path) => facts.address + path;

async function everyPage(browser) {
  const paths = ["/", "/?q=rover&sort=edges&order=down", "/robots/rover/", "/robots/rover/revisions/2/", "/robots/rover/revisions/2/certificate.html", "/robots/rover/compare?a=2&b=1", "/robots/broken/revisions/1/", "/experiments/", "/experiments/noise_whitening/"];
  if (facts.pictures) {
    const reply = await (await fetch(at("/api/v1/sessions?robot=stereo"))).json();
    paths.push("/robots/stereo/revisions/1/", "/robots/stereo/revisions/1/certificate.html", "/robots/stereo/", `/robots/stereo/sessions/${reply.sessions[0].session}/`);
  }
  for (const path of paths) {
    const page = await open(browser, at(path));
    await page.$$eval("details", (all) => all.forEach((one) => (one.open = true)));
    await accessible(page);
    await page.emulateMedia({ colorScheme: "dark" });
    await accessible(page);
    await page.setViewportSize({ width: 390, height: 844 });
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= 390, `${path} is ${wide} px wide on a phone`);
    await close(page);
  }
}

async function fleet(browser) {
  const page = await open(browser, at("/"));
  const robots = () => page.$$eval("#live tbody th", (cells) => cells.map((cell) => cell.textContent.trim()));
  assert.strictEqual((await robots())[0], "broken", "what fails comes first");
  await page.waitForSelector("form[data-ready]");
  await page.fill('input[type="search"]', "ROVER");
  await page.waitForFunction(() => document.querySelectorAll("#live tbody tr").length === 1);
  assert.deepStrictEqual(await robots(), ["rover"]);
  assert.ok(page.url().includes("q=ROVER"), "the address says what is shown");
  await page.fill('input[type="search"]', "");
  await page.selectOption("select[name=verdict]", "fail");
  await page.waitForFunction(() => document.querySelector("#live tbody")?.textContent.includes("broken"));
  await page.goto(at("/"));
  await page.click("thead a:has-text('Robot')");
  await page.waitForURL(/sort=robot/);
  const byName = await robots();
  assert.deepStrictEqual(byName, [...byName].sort(), "sorted by name");
  await page.click("thead a:has-text('Robot')");
  await page.waitForURL(/order=down/);
  assert.deepStrictEqual(await robots(), byName.reverse(), "and the other way");
  await page.click("#summary a:has-text('do not drive')");
  await page.waitForURL(/verdict=do_not_drive/);
  assert.ok((await robots()).includes("broken"), "a count leads to what it counts");
  await close(page);
}

// What the table of a comparison says is what the history draws, and a sentence says it first.
async function moved(browser) {
  const page = await open(browser, at("/robots/rover/"));
  const steps = await page.evaluate(() => Object.fromEntries(window.rigcal.trends.map(({ sensor, rows }) => [sensor, rows.find((row) => row.revision === 2).in_sigmas])));
  assert.ok((await page.textContent("#history .what")).includes("3 \u03c3"), "the history in a sentence");
  const drawn = await page.$$eval("#history [data-trend]", (places) => places.map((place) => place.dataset.trend));
  assert.deepStrictEqual(drawn, Object.keys(steps).sort((a, b) => steps[b] - steps[a]), "the farthest step first");
  await page.click("a:has-text('against revision 1')");
  await page.waitForURL(/compare\?a=1&b=2/);
  assert.match(await page.textContent("section[aria-label='What moved'] .what"), /moved/);
  const rows = await page.$$eval("table[data-filter='Filter sensors'] tbody tr", (all) => all.map((row) => [row.cells[0].textContent, Number(row.cells[1].textContent)]));
  assert.strictEqual(rows.length, Object.keys(steps).length);
  for (const [sensor, sigmas] of rows) assert.ok(Math.abs(sigmas - steps[sensor]) <= 0.1, `${sensor}: ${sigmas} and ${steps[sensor]}`);
  await close(page);
}

// Whoever keeps an old report's address must not take its verdict for the robot's.
async function oldReport(browser) {
  const newest = await open(browser, at("/robots/rover/revisions/2/"));
  const rule = (await newest.textContent(".banner .drive")).trim();
  await close(newest);
  for (const sheet of ["", "certificate.html"]) {
    const page = await open(browser, at("/robots/rover/revisions/1/" + sheet));
    await page.waitForSelector(".banner.past");
    const said = await page.$$eval(".banner p", (all) => all.filter((one) => one.getClientRects().length).map((one) => one.textContent));
    assert.ok(said[0].startsWith("An old report. Revision 2 counts: " + rule), said[0]);
    assert.match(said[1], /^Then: /, "what it said is past");
    assert.ok(!said.join(" ").includes("What to do:"), "nothing is to be done for what is past");
    assert.strictEqual(await page.locator(".banner:is(.pass, .warn, .fail), .signature:visible").count(), 0, "neither green nor to be signed");
    await accessible(page);
    await picture(page, "old" + sheet);
    await close(page);
  }
  const page = await open(browser, at("/robots/rover/revisions/1/"));
  const asked = page.waitForResponse((reply) => reply.request().frame().url().endsWith("/2/") && reply.url().includes("/api/v1/status"));
  await page.click(".banner a:text-is('Open revision 2')");
  await asked;
  assert.strictEqual(await page.locator(".banner.past, header .working").count(), 0, "the newest is not past");
  await close(page);
}

// A report is made once; whether it is overdue is found when somebody looks. By the server's clock where there is one, whatever that
// of the browser says; from disk by the browser's.
async function overdue(browser) {
  const AHEAD_MS = 100 * 86_400e3;
  const ahead = (context) => context.addInitScript((ms) => { const now = Date.now.bind(Date); Date.now = () => now() + ms; }, AHEAD_MS);
  const isLate = async (page) => {
    const first = await page.$eval(".banner", (banner) => banner.querySelector("p").textContent);
    assert.strictEqual(await page.locator(".banner.overdue").count(), first.includes(", overdue since ") ? 1 : 0, first);
    assert.strictEqual(await page.locator(".banner .until").isVisible(), !first.includes(", overdue since "), "until when, or since when");
    return first.includes(", overdue since ");
  };
  const report = at("/robots/rover/revisions/2/");
  const asked = (page) => page.waitForFunction(() => performance.getEntriesByType("resource").some((one) => one.name.includes("/api/v1/")));
  for (const [path, live] of [[report, "status"], [at("/robots/rover/"), "live"]]) {
    const page = await open(browser, path, { prepare: ahead });
    await asked(page);
    assert.ok(!(await isLate(page)), "a browser's wrong clock does not count: " + path);
    await page.route(`**/api/v1/${live}*`, async (route) => {
      const reply = await route.fetch(), late = new Date(Date.now() + AHEAD_MS);
      const body = (await reply.text()).replace(/"now":"[^"]*"/, `"now":"${late.toISOString()}"`);
      await route.fulfill({ response: reply, body, headers: { ...reply.headers(), date: late.toUTCString() } });
    });
    await page.reload();
    await page.waitForSelector(".banner.overdue");
    assert.ok(await isLate(page));
    assert.ok((await page.title()).startsWith("Overdue: "));
    assert.deepStrictEqual(await page.$$eval(".banner .word", (all) => all.filter((one) => one.getClientRects().length).map((one) => one.textContent)), ["Overdue"], "one word");
    assert.strictEqual(await page.$eval(".banner", (banner) => getComputedStyle(banner).backgroundColor), await page.evaluate(() => {
      const probe = document.body.appendChild(document.createElement("i"));
      probe.style.color = "var(--warn)";
      const color = getComputedStyle(probe).color;
      probe.remove();
      return color;
    }), "it is not green");
    await accessible(page);
    await picture(page, `overdue-${live}`);
    await close(page);
  }
  const disk = "file://" + facts.copy + "/index.html";
  const now = await open(browser, disk), later = await open(browser, disk, { prepare: ahead });
  assert.ok(!(await isLate(now)) && (await isLate(later)), "from disk by the browser's clock");
  await close(now);
  await close(later);
  const fleet = await open(browser, at("/?q=rover"));
  assert.strictEqual(await fleet.locator("tr.overdue").count(), 0);
  await fleet.route("**/api/v1/live*", async (route) => {
    const reply = await route.fetch();
    await route.fulfill({ response: reply, headers: { ...reply.headers(), date: new Date(Date.now() + AHEAD_MS).toUTCString() } });
  });
  await fleet.reload();
  await fleet.waitForSelector("tr.overdue");
  assert.match(await fleet.textContent("tr.overdue td.verdict"), /^overdue \S.* (Pass|Warn)/s, "the first word of its row");
  assert.ok(!(await fleet.locator("tr.overdue .badge.then").first().isVisible()), "and the only one");
  await picture(fleet, "overdue-fleet");
  await close(fleet);
}

// Whether it may drive, what to do and three numbers, before one scrolls; robots before lists of work; words for fingers.
async function firstScreenOfAPhone(browser) {
  const phone = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };
  const seen = (page, selector) => page.$$eval(selector, (all) => all.filter((one) => {
    const box = one.getBoundingClientRect();
    return box.height > 0 && box.bottom <= innerHeight;
  }).length);
  const fleet = await open(browser, at("/"), phone);
  assert.ok((await seen(fleet, "#live tbody .drive")) > 0 && (await seen(fleet, "#live tbody .do")) > 0, "a robot, its rule and what to do");
  const top = (selector) => fleet.$eval(selector, (one) => one.getBoundingClientRect().top);
  assert.ok((await top("#live")) < (await top("#work")), "robots before lists of work");
  await picture(fleet, "phone-fleet");
  await close(fleet);
  for (const path of ["/robots/rover/", "/robots/broken/", "/robots/rover/revisions/2/", "/robots/broken/revisions/1/"]) {
    const page = await open(browser, at(path), phone);
    assert.strictEqual(await seen(page, ".banner .drive, .banner .late"), 1, "the rule: " + path);
    assert.strictEqual(await seen(page, ".banner .do"), 1, "what to do: " + path);
    assert.ok((await seen(page, ".figure .value")) >= 3, "three numbers: " + path);
    if (path.includes("broken")) assert.strictEqual(await seen(page, ".figure.fail .value"), 1, "the figure that decided: " + path);
    await picture(page, "phone" + path.replace(/\W+/g, "-"));
    if (path.includes("revisions")) assert.match(await page.textContent(".readout"), /^Touch an edge/, path);
    await close(page);
  }
}

async function errors(browser) {
  const cases = [["/nope", "There is no page /nope.", "/"], ["/robots/nobody/", "is not known.", "/"],
    ["/robots/rover/revisions/99/", "over has no revision 99", "/robots/rover/"]];
  for (const [path, text, on] of cases) {
    const context = await browser.newContext({ viewport: { width: 390, height: 844 } });
    const page = await context.newPage();
    assert.strictEqual((await page.goto(at(path))).status(), 404, path);
    assert.ok((await page.textContent("main")).includes(text), path);
    await accessible(page);
    await page.click(`a.button[href='${on}']`);
    await page.waitForURL(at(on));
    await context.close();
  }
}

async function fleetColumns(browser) {
  const page = await open(browser, at("/?sort=worst"));
  const robots = () => page.$$eval("#live tbody th", (cells) => cells.map((cell) => cell.textContent.trim()));
  assert.strictEqual((await robots())[0], "broken", "the worst edge of all comes first");
  assert.ok((await page.textContent("#live tbody tr")).match(/\d σ\s+a → c/), "with its name and its residual");
  await page.waitForSelector("form[data-ready]");
  await page.selectOption("select[name=verdict]", "off");
  await page.waitForFunction(() => document.querySelectorAll("#live tbody tr").length === 1);
  assert.deepStrictEqual(await robots(), ["broken"]);
  await page.goto(at("/"));
  await page.click("thead a:has-text('Due')");
  await page.waitForURL(/sort=due/);
  assert.strictEqual(await page.textContent("thead th[aria-sort='ascending'] a[aria-current]"), "Due \u2191", "which of two headings it is");
  if (facts.pictures) await sharedNames(page);
  await close(page);
}

// A name leads to the robots that share it, whatever somebody typed for one.
async function sharedNames(page) {
  const row = page.locator("#live tbody tr", { hasText: "stereo" });
  assert.ok((await row.locator(".operator").textContent()).startsWith("by <script>"), "as it was typed");
  await row.locator(".place a").last().click();
  await page.waitForURL(/site=/);
  assert.deepStrictEqual(await page.$$eval("#live tbody th", (cells) => cells.map((cell) => cell.textContent.trim())), ["stereo"]);
  await page.click("a:text-is('all sites')");
  await page.waitForFunction(() => document.querySelectorAll("#live tbody tr").length > 1);
}

// Whatever the width: no row is cut, and the rule stands whole.
async function fleetFits(browser) {
  for (const width of [1280, 1024, 390]) {
    const page = await open(browser, at("/"), { viewport: { width, height: 844 } });
    const cut = await page.evaluate(() => [...document.querySelectorAll("#live .scroll, #live td, #live .drive")]
      .filter((one) => getComputedStyle(one).display !== "inline" && one.scrollWidth > one.clientWidth + 1).map((one) => one.outerHTML.slice(0, 120)));
    assert.deepStrictEqual(cut, [], `cut at ${width} px`);
    const rules = await page.$$eval("#live .drive", (all) => all.filter((rule) => {
      const box = rule.getBoundingClientRect(), cell = rule.closest("td").getBoundingClientRect();
      return box.width > 0 && (box.right > cell.right + 1 || box.bottom > cell.bottom + 1);
    }).map((rule) => rule.textContent));
    assert.deepStrictEqual(rules, [], `not whole at ${width} px`);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${width} px`);
    await picture(page, `fleet-${width}`);
    await close(page);
  }
}

async function experiments(browser) {
  const page = await open(browser, at("/"));
  await page.click("a:has-text('1 experiment')");
  await page.click("a:has-text('Noise')");
  await page.waitForURL(/noise_whitening\/$/);
  assert.strictEqual(await page.$eval("h1", (one) => getComputedStyle(one).color), "rgb(1, 2, 3)", "its own style sheet");
  await close(page);
  for (const path of ["/experiments/..%2frigcal.db", "/experiments/noise_whitening/..%2f..%2frigcal.db", "/experiments/none/"])
    assert.ok((await fetch(at(path))).status >= 400, path);
}

async function cameras(browser) {
  if (!facts.pictures) return;
  const page = await open(browser, at("/robots/stereo/revisions/1/"), { javaScriptEnabled: false });
  const one = page.locator("details.camera").first();
  for (const part of [".heat5, .heat4, .heat3", ".usual", ".normal", ".compass .dot", ".certainty .map", ".values dd"])
    assert.ok(await one.locator(part).first().isVisible(), part);
  const reply = await fetch(new URL(await one.locator("a[download]").getAttribute("href"), page.url()));
  const fit = await reply.json();
  const corners = fit.views.reduce((sum, view) => sum + view.uv_px.length / 2, 0);
  assert.ok((await one.locator("summary").textContent()).includes(`${corners} corners`), "what is drawn is what is stored");
  await page.context().close();
}

async function edgeTable(browser) {
  const page = await open(browser, at("/robots/rover/revisions/2/"));
  const column = (index) => page.$$eval("table.edges tbody tr", (rows, cell) => rows.filter((row) => !row.hidden).map((row) => Number(row.cells[cell].textContent)), index);
  await page.click("table.edges th[data-column='5'] button");
  const up = await column(5);
  assert.deepStrictEqual(up, [...up].sort((a, b) => a - b));
  await page.focus("table.edges th[data-column='5'] button");
  await page.keyboard.press("Enter");
  assert.deepStrictEqual(await column(5), [...up].reverse().sort((a, b) => b - a));
  assert.strictEqual(await page.getAttribute("table.edges th[data-column='5']", "aria-sort"), "descending");
  await page.fill(".filter input", "front rear");
  assert.strictEqual((await column(5)).length, 1);
  const csv = await (await fetch(at("/robots/rover/revisions/2/edges.csv"))).text();
  assert.strictEqual(csv.trim().split("\r\n").length, 5, "a heading and four edges");
  await close(page);
}

// The heading stays in view, and a window of usual width shows every column.
async function edgeTableFits(browser) {
  const page = await open(browser, at(`/robots/${facts.pictures ? "stereo/revisions/1" : "rover/revisions/2"}/`));
  const fits = await page.$eval(".scroll:has(> .edges)", (box) => box.scrollWidth <= box.clientWidth);
  assert.ok(fits, "no column is cut");
  const heading = page.locator("table.edges thead th").first();
  assert.strictEqual(await heading.evaluate((cell) => getComputedStyle(cell).position), "sticky");
  await close(page);
}

async function contents(browser) {
  const page = await open(browser, at("/robots/rover/revisions/2/"));
  const parts = await page.$$eval("nav.contents a", (links) => links.map((link) => link.hash));
  assert.ok(parts.length >= 5, "the parts of the page: " + parts);
  for (const part of parts) assert.ok(await page.locator(part).count(), part);
  await page.click("nav.contents a:has-text('Source')");
  await page.waitForFunction(() => document.getElementById("source").getBoundingClientRect().top < innerHeight);
  await close(page);
}

// An edge at the pointer or the keyboard says its numbers, and shows itself without a frame around its box.
async function graph(browser) {
  const page = await open(browser, at("/robots/stereo/revisions/1/"));
  const edge = page.locator("svg.graph a").first();
  const look = () => edge.locator(".link").evaluate((link) => [getComputedStyle(link).stroke, getComputedStyle(link).strokeWidth]);
  const before = await look();
  await page.focus("nav.contents a:last-child");
  for (let step = 0; step < 40 && !(await edge.evaluate((link) => link === document.activeElement)); ++step) await page.keyboard.press("Tab");
  assert.strictEqual(await edge.evaluate((link) => getComputedStyle(link).outlineStyle), "none");
  assert.notDeepStrictEqual(await look(), before, "the focus is seen");
  assert.strictEqual(await page.textContent(".readout"), await edge.getAttribute("aria-label"));
  await page.evaluate(() => document.activeElement.blur());
  assert.ok((await page.textContent(".readout")).startsWith("Point at an edge"));
  await page.locator("svg.graph a .link").first().hover({ force: true });
  await page.waitForFunction(() => document.querySelector(".readout").textContent.includes("\u2192"));
  await close(page);
}

// Names beside sensors never cover each other.
async function names(browser) {
  const page = await open(browser, at("/robots/rover/revisions/2/"));
  await page.waitForSelector("#rig .view[data-frames]");
  for (const view of ["All", "Front", "Top", "Side"]) {
    await page.click(`#rig button:text-is('${view}')`);
    await page.waitForTimeout(0);
    const boxes = await page.$$eval("#rig .labels span", (labels) => labels.filter((label) => label.style.visibility === "visible")
      .map((label) => { const { left, right, top, bottom } = label.getBoundingClientRect(); return { left, right, top, bottom }; }));
    assert.ok(boxes.length > 0, "names in the view " + view);
    const covers = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
    assert.ok(!boxes.some((a, index) => boxes.slice(index + 1).some((b) => covers(a, b))), "names cover each other in the view " + view);
  }
  assert.ok(await page.locator("#rig .labels .chosen").count(), "the chosen sensor stands out");
  await close(page);
}

// What stands on paper has no dark area behind it; pictures, drawings and lines aside.
async function paperIsLight(page) {
  const dark = await page.$$eval("main, main *", (all) => all.filter((one) => one.getClientRects().length && !one.closest("svg, .view, .chart, .key, .swatch, .scale, .pictures, .sheet")).filter((one) => {
    const [r, g, b, a = 1] = getComputedStyle(one).backgroundColor.match(/[\d.]+/g).map(Number);
    return a > 0.5 && 0.3 * r + 0.6 * g + 0.1 * b < 200;
  }).map((one) => one.outerHTML.slice(0, 120)));
  assert.deepStrictEqual(dark, [], "dark on paper: " + page.url());
}

// What failed says so on paper though nobody opened it, and is closed again afterwards.
async function paperOpensWhatFailed(browser) {
  for (const path of ["/", "/robots/broken/", "/robots/broken/revisions/1/", "/robots/broken/revisions/1/certificate.html"]) {
    const page = await open(browser, at(path), { colorScheme: "dark", viewport: { width: 703, height: 995 } });
    const closed = () => page.locator("details.edge.failed:not([open]), .causes details:not([open])").count();
    await page.$$eval("details", (all) => all.forEach((one) => { one.open = false; }));
    const before = await closed();
    await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
    await page.emulateMedia({ media: "print" });
    assert.strictEqual(await closed(), 0, path);
    await paperIsLight(page);
    await page.emulateMedia({ media: "screen" });
    await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
    assert.strictEqual(await closed(), before, path);
    await close(page);
  }
}

// Paper is light whatever the screen is, holds every chart of what is open, and cuts nothing.
async function paper(browser) {
  const page = await open(browser, at(`/robots/${facts.pictures ? "stereo/revisions/1" : "rover/revisions/2"}/`), { colorScheme: "dark", viewport: { width: 703, height: 995 } });
  const color = (name) => page.evaluate((key) => getComputedStyle(document.documentElement).getPropertyValue("--" + key).trim(), name);
  const dark = await color("text");
  await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
  assert.notStrictEqual(await color("text"), dark, "light colours");
  if (facts.pictures) assert.strictEqual(await page.locator("[data-edge-charts] .plot canvas").count(), 3, "charts are drawn though nobody scrolled to them");
  await page.emulateMedia({ media: "print" });
  const cut = await page.evaluate(() => [...document.querySelectorAll("main *")].filter((one) => one.getClientRects().length && !one.closest("svg, .labels, .view") &&
    one.getBoundingClientRect().right > 704).slice(0, 3).map((one) => one.outerHTML.slice(0, 120)));
  assert.deepStrictEqual(cut, [], "beyond the paper's edge");
  assert.ok(!(await page.locator("nav.contents").isVisible()), "nothing to press on paper");
  await paperIsLight(page);
  assert.ok(await page.$eval("#rig .still", (still) => still.getContext("2d").getImageData(3, 3, 1, 1).data[0] > 200), "the rig is light, too");
  await page.emulateMedia({ media: "screen" });
  await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
  assert.strictEqual(await page.locator("#rig .still").count(), 0);
  assert.strictEqual(await color("text"), dark, "the screen is as it was");
  await close(page);
}

// One side of A4, also with names that are far too long; an old one tells that there is a newer revision.
async function certificate(browser) {
  const page = await open(browser, at("/robots/rover/"));
  await page.click("a:text-is('Certificate to print')");
  await page.waitForURL(/\/revisions\/2\/certificate\.html$/);
  for (const robot of facts.pictures ? ["rover/revisions/2", "stereo/revisions/1"] : ["rover/revisions/2"]) {
    await page.goto(at(`/robots/${robot}/certificate.html`));
    const sheets = (await page.pdf({ preferCSSPageSize: true })).toString("latin1").match(/\/Type \/Page\b/g);
    assert.strictEqual(sheets.length, 1, "sheets of " + robot);
    const title = await page.textContent("h1");  // no place to sign where it is none, as of old pictures
    assert.strictEqual(await page.locator(".signature").count(), title.includes("no certificate") ? 0 : 1, robot + ": " + title);
    assert.ok(robot.startsWith("stereo") || !title.includes("no certificate"), robot + ": " + title);
    await page.emulateMedia({ media: "print" });
    const lines = await page.$$eval(".name", (all) => all.filter((one) => one.textContent.length <= 18 && one.getClientRects()[0].height > 1.8 * parseFloat(getComputedStyle(one).fontSize)).map((one) => one.textContent));
    assert.deepStrictEqual(lines, [], "names in two lines");
    await page.emulateMedia({ media: null });  // a sheet is paper by itself
  }
  await page.goto(at("/robots/rover/revisions/1/certificate.html"));
  await page.click(".banner a:text-is('Open revision 2')");
  await page.waitForURL(at("/robots/rover/revisions/2/"));
  await page.click("header a:has-text('Certificate')");
  await page.waitForURL(at("/robots/rover/revisions/2/certificate.html"));
  await close(page);
}

async function rig(browser) {
  const page = await open(browser, at("/robots/rover/revisions/2/"));
  await drawn(page, "#rig canvas");
  await page.waitForSelector("#rig .view[data-frames]");
  assert.ok((await colors(page, "#rig canvas")) > 10, "the rig is drawn");
  const picture = () => page.$eval("#rig canvas", (canvas) => canvas.toDataURL());
  const changes = async (act, what) => {
    const before = await picture();
    await act();
    await page.waitForFunction((old) => document.querySelector("#rig canvas").toDataURL() !== old, before).catch(() => assert.fail(what + " changes nothing"));
  };
  await page.focus("#rig canvas");
  await changes(() => page.keyboard.press("ArrowLeft"), "an arrow key");
  await changes(() => page.click("#rig button:has-text('Top')"), "the button Top");
  await changes(() => page.$eval("#rig input[type=range]", (slider) => { slider.value = slider.max; slider.dispatchEvent(new Event("input")); }), "the slider");
  await changes(() => page.uncheck("#rig .toggle input"), "the ghosts' switch");
  await page.selectOption("#rig select", "rear");
  assert.ok((await page.textContent("#rig .panel")).includes("rear"));
  const box = await page.locator("#rig canvas").boundingBox();
  await page.click("#rig button:has-text('All')");
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await close(page);
}

async function charts(browser) {
  if (!facts.pictures) return;
  const page = await open(browser, at("/robots/stereo/revisions/1/"));
  await page.locator("[data-edge-charts]").first().scrollIntoViewIfNeeded();
  await drawn(page, "[data-edge-charts] canvas");
  assert.ok((await colors(page, "[data-edge-charts] canvas")) > 5, "the residuals are drawn");
  assert.strictEqual(await page.locator("[data-edge-charts] .plot").count(), 3);
  const rms = await page.evaluate(() => {
    const used = window.rigcal.edges[0].captures.filter((one) => !one.unused).map((one) => one.rms);
    return Math.sqrt(used.reduce((sum, one) => sum + one * one, 0) / used.length).toPrecision(3);
  });
  assert.ok((await page.textContent("[data-edge-charts] .plot figcaption")).includes(`${Number(rms)} px`), "the rms of all captures");
  const checks = await page.textContent(".columns .pairs");
  assert.ok(checks.includes("Reprojection error in left, rms") && !/_|fx /.test(checks), "figures in words: " + checks);
  await page.click("button:text-is('Close all')");
  assert.strictEqual(await page.locator("details.edge:not(.camera)[open]").count(), 0);
  await page.click("button:text-is('Open all')");
  assert.ok(await page.locator("[data-edge-charts]").first().isVisible());
  await page.hover("[data-edge-charts] canvas");
  const shown = await page.$$eval("img[src^='evidence/']", (pictures) => pictures.length);
  assert.ok(shown >= 10, "pictures of detections");
  assert.ok((await page.textContent(".provenance")).includes("<script>window.ran=1</script>"), "the operator's name is text");
  await close(page);
  const robot = await open(browser, at("/robots/rover/"));
  await robot.locator("[data-trend]").first().scrollIntoViewIfNeeded();
  await drawn(robot, "[data-trend] canvas");
  assert.ok((await colors(robot, "[data-trend] canvas")) > 5, "the history is drawn");
  await close(robot);
}

async function withoutScript(browser) {
  const page = await open(browser, at("/robots/rover/revisions/2/"), { javaScriptEnabled: false });
  for (const part of [".banner .why", ".banner .until", ".figures", ".changes", "svg.graph", "table.edges", ".provenance"])
    assert.ok(await page.locator(part).first().isVisible(), part + " without a script");
  assert.ok(!(await page.locator("#rig").isVisible()), "no empty frame where a script would draw");
  await page.goto(at("/?q=rover"));
  assert.strictEqual(await page.locator("#live tbody tr").count(), 1, "the search works without a script");
  await page.context().close();
}

async function fromDisk(browser) {
  const page = await open(browser, "file://" + facts.copy + "/index.html");
  await drawn(page, "#rig canvas");
  assert.ok((await colors(page, "#rig canvas")) > 10, "the rig is drawn from disk");
  await page.click("table.edges th[data-column='0'] button");
  assert.strictEqual(await page.locator("a[href^='..']").count(), 0, "no way out of the folder");
  assert.ok((await page.pdf()).length > 20000, "it prints");
  await close(page);
}

const revisions = (page) => page.locator("#live table a[href^='revisions/']").count();
const more = (page, old) => page.waitForFunction((before) => document.querySelectorAll("#live table a[href^='revisions/']").length > before, old);
const asked = (page) => page.waitForResponse((reply) => reply.url().includes("/api/v1/live"));

// As in a tab behind others, until it is looked at.
async function hidden(browser, path) {
  const page = await (await browser.newContext()).newPage();
  await page.addInitScript(() => Object.defineProperty(document, "hidden", { get: () => !window.shown }));
  await Promise.all([asked(page), page.goto(at(path))]);
  return page;
}

// The first time that it is asked for anew, the page does not come.
async function broken(browser, path) {
  const page = await open(browser, at(path));
  let failed = 0;
  await page.route("**" + path, (route) => (failed++ ? route.continue() : route.fulfill({ status: 503, body: "later" })));
  return page;
}

// A page that is open tells what arrives meanwhile.
async function live(browser) {
  const page = await open(browser, at("/robots/rover/"));
  const others = [await hidden(browser, "/robots/rover/"), await broken(browser, "/robots/rover/")];
  const before = await revisions(page);
  await asked(page);
  await page.locator("[data-trend]").first().scrollIntoViewIfNeeded();
  await drawn(page, "[data-trend] canvas");
  await page.focus("#live a[href='revisions/1/']");
  await page.evaluate(() => { document.title = "of before"; });
  const pushed = spawnSync(facts.push[0], facts.push.slice(1));
  assert.ok([0, 5].includes(pushed.status), String(pushed.stderr));
  await more(page, before);
  assert.strictEqual(await page.evaluate(() => document.activeElement.getAttribute("href")), "revisions/1/", "the focus stays where it was");
  assert.match(await page.title(), /^rover: /);
  assert.strictEqual(await page.locator("#compare select[name=a] option").count(), before + 1, "the new one can be compared");
  await page.waitForFunction((count) => window.rigcal.trends.every(({ rows }) => rows.at(-1).revision === count), before + 1);
  await drawn(page, "[data-trend] canvas");
  assert.strictEqual(await page.locator("#history .what").count(), 1, "one sentence");
  assert.strictEqual(await page.locator("[data-trend]").first().locator("canvas").count(), 2, "position and rotation, once");
  await others[0].evaluate(() => { window.shown = true; document.dispatchEvent(new Event("visibilitychange")); });
  for (const other of others) {
    await more(other, before);
    await other.context().close();
  }
  const first = await fetch(at("/api/v1/live?robot=rover"));
  const again = await fetch(at("/api/v1/live?robot=rover"), { headers: { "If-None-Match": first.headers.get("etag") } });
  assert.strictEqual(again.status, 304, "nothing new costs nothing");
  await close(page);
}

withBrowser(async (browser) => {
  for (const work of [everyPage, fleet, moved, oldReport, overdue, firstScreenOfAPhone, errors, fleetColumns, fleetFits, experiments, cameras, edgeTable, edgeTableFits, contents, graph, names, paper, paperOpensWhatFailed, certificate, rig, charts, withoutScript, fromDisk, live]) {
    const start = Date.now();
    await work(browser);
    console.log(`${work.name}: ${((Date.now() - start) / 1000).toFixed(1)} s`);
  }
}).catch((error) => {
  console.error(error);
  process.exit(1);
});
