// A report is of one revision. Where the robot has a newer one by now, or will have, the page says so: its verdict is no longer
// the robot's, and the newer one's rule takes its place. Until when it is valid goes by the server's clock; where there is nobody to ask, by the browser's.
import { watchOverdue } from "../overdue.js";

function add(header, text) {
  const line = document.createElement("p");
  line.className = "working";
  line.setAttribute("role", "status");
  line.append(text);
  header.append(line);
}

function linkTo(revision) {
  const link = document.createElement("a");
  link.href = `../${revision}/`;
  link.textContent = `Open revision ${revision}`;
  return link;
}

// The banner says one thing: what holds now. What it said then is told as past, without its colour.
function makePast(banner, revision, rule) {
  const told = document.createElement("p");
  told.className = "drive";
  told.append(`An old report. Revision ${revision} counts: ${rule}. `, linkTo(revision));
  const then = banner.querySelector(".then").textContent;
  banner.querySelectorAll("template, .late, .drive, .do, .keep, .icon").forEach((part) => part.remove());
  banner.querySelector(".then").textContent = "Then: " + then;
  banner.querySelector(".then").before(told);
  banner.className = "banner past";
  document.title = "Old: " + document.title;
}

// What was decided since the report was drawn changes its rule; that it is overdue is told by overdue.js. What
// a person types stands between backticks in a rule.
function sayRule(banner, drive) {
  const told = banner.querySelector(".drive"), rule = drive.rule.replaceAll("`", "") + ".";
  if (!told || drive.kind === "not_verified" || told.textContent === rule) return;
  told.textContent = rule;
  told.classList.toggle("until", drive.until !== null);
}

export async function tellOfNewer() {
  const here = location.pathname.match(/\/robots\/([^/]+)\/revisions\/(\d+)\/((index|certificate)\.html)?$/);
  const header = document.querySelector("main > header");
  if (!here || !header) return watchOverdue(0);
  let ahead_ms = 0;
  try {
    const { now, robots } = await (await fetch("../../../../api/v1/status?robot=" + here[1])).json();
    const [{ revision, calculating, given_up: givenUp, drive }] = robots;
    ahead_ms = Date.parse(now) - Date.now();
    const banner = document.querySelector(".banner");
    if (revision > Number(here[2])) {
      makePast(banner, revision, drive.rule);
    } else {
      sayRule(banner, drive);
      if (givenUp) add(header, givenUp);
      else if (calculating) add(header, "A newer revision is being calculated.");
    }
  } catch {
    // Nobody to ask: the report stands by itself.
  }
  watchOverdue(ahead_ms);
}
