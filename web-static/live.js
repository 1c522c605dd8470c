import { tellOverdue } from "./overdue.js";

// Keeps a page up to date: asks a small document now and then, and takes the page's fresh parts anew when it changed. On the
// fleet's page it also searches while one types.
const PERIOD_MS = 3000;
const live = document.getElementById("live");
const form = document.querySelector('form[role="search"]');
let seen = null, turn = 0;

// Whoever reads along keeps their place: the link in focus, and what was unfolded.
function replace(part, next) {
  const focused = part.contains(document.activeElement) ? document.activeElement.getAttribute("href") : null;
  const open = [...part.querySelectorAll("details")].map((one) => one.open);
  part.replaceChildren(...next.childNodes);
  const details = part.querySelectorAll("details");
  if (details.length === open.length) details.forEach((one, index) => (one.open = open[index]));
  if (focused !== null) [...part.querySelectorAll("a")].find((link) => link.getAttribute("href") === focused)?.focus();
}

// False if the server gave no page: then this one is as old as before. A page that is still empty becomes another page.
async function refresh(address) {
  if (!live.matches("[data-fresh]")) return location.reload();
  const mine = ++turn;
  const reply = await fetch(address, { headers: { Accept: "text/html" } });
  if (!reply.ok) return false;
  const page = new DOMParser().parseFromString(await reply.text(), "text/html");
  if (mine !== turn) return true;
  document.title = page.title;
  for (const part of document.querySelectorAll("[data-fresh]")) {
    const next = page.getElementById(part.id);
    if (next) replace(part, next);
  }
  document.dispatchEvent(new Event("rigcal:refreshed"));
  return true;
}

// The server answers 304 while nothing changed: the browser then gives the same text. A page that nobody sees waits, but it
// asks once: what it shows is of now, not of when somebody looks.
async function poll() {
  if (document.hidden && seen !== null) return;
  try {
    const reply = await fetch(live.dataset.live, { cache: "no-cache" });
    if (!reply.ok) return;
    const text = await reply.text();
    tellOverdue(Date.parse(reply.headers.get("date")));
    if (seen !== null && text !== seen && !(await refresh(location.href))) return;
    seen = text;
  } catch {
    // The server is away for a moment: the page stays as it is, and the next round asks again.
  }
}

function addressOf() {
  return "./?" + new URLSearchParams(new FormData(form));
}

if (live?.dataset.live && location.protocol !== "file:") {
  poll();
  setInterval(poll, PERIOD_MS);
  document.addEventListener("visibilitychange", poll);
}
if (live && form) {
  let waiting = 0;
  const search = () => {
    clearTimeout(waiting);
    waiting = setTimeout(async () => {
      const address = addressOf();
      history.replaceState(null, "", address);
      await refresh(address);
    }, 120);
  };
  form.addEventListener("input", search);
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    search();
  });
  form.querySelector("button").hidden = true;
  form.dataset.ready = "yes";
}
