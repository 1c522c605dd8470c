// The scale of figures in sigmas for scripts: the cases are those of tests/unit/report/sigma_scale_test.cc.
const assert = require("node:assert");
const fs = require("node:fs");
const path = require("node:path");

const cases = [
  [0, "fit0", "0.0"], [0.99, "fit0", "1.0"], [1, "fit1", "1.0"], [1.99, "fit1", "2.0"], [2, "fit2", "2.0"], [2.5, "fit2", "2.5"],
  [2.66, "fit2", "2.7"], [2.99, "fit2", "2.9"], [3, "fit3", "3.0"], [24.9, "fit3", "24.9"], [118.68, "fit3", "118.7"],
];
const root = path.join(__dirname, "..", "..", "web-static");
const textOf = (name) => fs.readFileSync(path.join(root, name), "utf8");

// A module without a package of its own: taken from its text.
const load = (name) => import("data:text/javascript;base64," + Buffer.from(textOf(name)).toString("base64"));

function sources(folder = root) {
  return fs.readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const file = path.join(folder, entry.name);
    return entry.isDirectory() ? sources(file) : file.endsWith(".js") ? [file] : [];
  });
}

// No script makes a class of its own.
function nobodyElseChooses() {
  const others = sources().filter((file) => path.basename(file) !== "sigmas.js" && /["'`]fit["'`]|["'`]fit[012]["'`]/.test(fs.readFileSync(file, "utf8")));
  assert.deepStrictEqual(others, [], "these choose a class by themselves: import sigmasClass() of sigmas.js");
}

load("sigmas.js").then(({ sigmasClass, sigmasText }) => {
  for (const [inSigmas, name, text] of cases) {
    assert.strictEqual(sigmasClass(inSigmas), name, String(inSigmas));
    assert.strictEqual(sigmasText(inSigmas), text, String(inSigmas));
  }
  assert.strictEqual(sigmasClass(NaN), "fit3");
  nobodyElseChooses();
  console.log("sigma scale: good");
}).catch((error) => {
  console.error(error);
  process.exit(1);
});
