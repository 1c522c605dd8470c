// The login page on a phone and at a desk: with no script, by keyboard, back to where one wanted to go, and out. Run by login_test.py.
const { accessible, assert, close, facts, open, picture, withBrowser } = require("./browser.cjs");

const at = (page) => new URL(page.url()).pathname;
// Refused passwords and pages are no faults here.
const forgive = (page) => { page.faults = page.faults.filter((one) => !one.includes("status of 403")); };

async function logIn(page, password) {
  await page.fill("input[name=name]", "ada");
  await page.fill("input[name=password]", password);
  await Promise.all([page.waitForNavigation(), page.keyboard.press("Enter")]);
}

async function wide(page) {
  return page.evaluate(() => document.documentElement.scrollWidth > document.documentElement.clientWidth);
}

withBrowser(async (browser) => {
  for (const [name, width, colorScheme] of [["phone", 390, "light"], ["desk", 1280, "dark"]]) {
    const page = await open(browser, facts.address + "/boards/?a=1", { viewport: { width, height: 844 }, colorScheme, ignoreHTTPSErrors: true });
    assert.strictEqual(at(page), "/login");
    await page.waitForFunction(() => document.activeElement.name === "name");  // one types at once
    await accessible(page);
    assert.ok(!(await wide(page)), "nothing sticks out");
    await picture(page, "login-" + name);
    await logIn(page, "wrong wrong wrong");
    assert.ok((await page.textContent("[role=alert]")).includes("no such name with this password"));
    assert.strictEqual(await page.inputValue("input[name=name]"), "ada", "the name is still there");
    await accessible(page);
    await picture(page, "login-wrong-" + name);
    await logIn(page, facts.password);
    forgive(page);
    assert.strictEqual(page.url(), facts.address + "/boards/?a=1", "back to where one wanted to go");
    await Promise.all([page.waitForNavigation(), page.click("text=ada, approver")]);
    assert.ok((await page.textContent("main")).includes("approve, reject and roll back"));
    await accessible(page);
    await picture(page, "account-" + name);

    const other = await page.context().newPage();
    await other.goto(facts.other);
    await other.click("a");
    await other.waitForURL(facts.address + "/boards/");
    await other.waitForSelector("text=ada, approver");
    await other.close();

    await Promise.all([page.waitForNavigation(), page.click("text=Log out")]);
    assert.strictEqual(at(page), "/login");
    await page.goto(facts.address + "/");
    assert.strictEqual(at(page), "/login", "she is out");
    await close(page);
  }
  const plain = await open(browser, facts.address + "/", { javaScriptEnabled: false, ignoreHTTPSErrors: true });
  await logIn(plain, facts.password);
  assert.strictEqual(at(plain), "/", "without scripts, too");
  await plain.context().close();
});
