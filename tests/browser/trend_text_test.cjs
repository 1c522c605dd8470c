// The sentence above the history of a robot's sensors: what it says is not contradicted by the verdict.
const assert = require("node:assert");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const { pathToFileURL } = require("node:url");

const root = path.join(__dirname, "..", "..", "web-static");

// As modules in a folder of their own: beside the pages' scripts no package says that they are modules.
function copied() {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "rigcal-trend-"));
  fs.mkdirSync(path.join(folder, "charts"));
  for (const name of ["sigmas.js", "charts/digits.js", "charts/trend_text.js"]) fs.copyFileSync(path.join(root, name), path.join(folder, name));
  fs.writeFileSync(path.join(folder, "package.json"), '{"type": "module"}');
  return folder;
}

const row = (what, in_sigmas, moved_m = 0) => ({ ...what, ...(in_sigmas === undefined ? {} : { in_sigmas, moved_m, turned_rad: 0.001 }) });
const revisions = (...sigmas) => sigmas.map((one, index) => row({ revision: index + 1 }, one));
const visit = (date, in_sigmas, moved_m) => row({ date }, in_sigmas, moved_m);

function check({ byFarthestStep, historyText }) {
  const still = { sensor: "left", rows: revisions(undefined, 0.8) };
  const fused = { sensor: "right", rows: revisions(undefined, 1.0), visits: [visit("2026-10-26"), visit("2026-11-23", 15.1, 0.0062)] };
  assert.strictEqual(historyText([still]), "No sensor stepped by 3 \u03c3 or more from one revision to the next.");
  const said = historyText([still, fused]);
  assert.ok(said.startsWith("Visit against visit, moved: right by 6.2 mm and 0.057 deg before the visit of 2026-11-23 (15.1 \u03c3)."), said);
  assert.ok(!said.includes("No sensor stepped"), said);
  assert.deepStrictEqual(byFarthestStep([still, fused]).map(({ sensor }) => sensor), ["right", "left"], "what moved between visits goes first");
  const both = historyText([{ ...fused, rows: revisions(undefined, 9.0) }]);
  assert.ok(both.startsWith("Visit against visit") && both.endsWith("Moved: right at revision 2 (9.0 \u03c3)."), both);
  const remounted = { ...fused, visits: [visit("2026-10-26"), { date: "2026-11-23", remounted: true }] };
  assert.strictEqual(historyText([remounted]), "No sensor stepped by 3 \u03c3 or more from one revision to the next.", "on purpose is no step");
}

const folder = copied();
import(pathToFileURL(path.join(folder, "charts", "trend_text.js")).href).then((text) => {
  check(text);
  console.log("trend text: good");
}).catch((error) => {
  console.error(error);
  process.exitCode = 1;
}).finally(() => fs.rmSync(folder, { recursive: true }));
