// A report is of one revision. Where the robot has a newer one by now, or will have, the page says so: its verdict is no longer
// the robot's. Until when it is valid goes by the server's clock; where there is nobody to ask, by the browser's.
import { watchOverdue } from "../overdue.js";

function add(header, text, link) {
  const line = document.createElement("p");
  line.className = "working";
  line.setAttribute("role", "status");
  line.append(text, ...(link ? [link] : []));
  header.append(line);
}

function linkTo(revision) {
  const link = document.createElement("a");
  link.href = `../${revision}/`;
  link.textContent = `Open revision ${revision}`;
  return link;
}

export async function tellOfNewer() {
  const here = location.pathname.match(/\/robots\/([^/]+)\/revisions\/(\d+)\/((index|certificate)\.html)?$/);
  const header = document.querySelector("main > header");
  if (!here || !header) return watchOverdue(0);
  let ahead_ms = 0;
  try {
    const { now, robots } = await (await fetch("../../../../api/v1/status?robot=" + here[1])).json();
    const [{ revision, calculating, given_up: givenUp }] = robots;
    ahead_ms = Date.parse(now) - Date.now();
    if (revision > Number(here[2])) add(header, `This is an old report: the robot has revision ${revision} by now. `, linkTo(revision));
    else if (givenUp) add(header, givenUp);
    else if (calculating) add(header, "A newer revision is being calculated.");
  } catch {
    // Nobody to ask: the report stands by itself.
  }
  watchOverdue(ahead_ms);
}
