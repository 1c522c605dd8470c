// Keeps a page up to date: asks a small document now and then, and takes the page's live part anew when it changed. On the
// fleet's page it also searches while one types.
const PERIOD_MS = 3000;
const live = document.getElementById("live");
const form = document.querySelector('form[role="search"]');
let seen = null, turn = 0;

async function refresh(address) {
  const mine = ++turn;
  const reply = await fetch(address, { headers: { Accept: "text/html" } });
  if (!reply.ok || mine !== turn) return;
  const page = new DOMParser().parseFromString(await reply.text(), "text/html");
  const next = page.getElementById("live");
  if (next && mine === turn) live.replaceChildren(...next.childNodes);
  document.dispatchEvent(new Event("rigcal:refreshed"));
}

// The server answers 304 while nothing changed: the browser then gives the same text.
async function poll() {
  if (document.hidden) return;
  try {
    const reply = await fetch(live.dataset.live, { cache: "no-cache" });
    if (!reply.ok) return;
    const text = await reply.text();
    if (seen !== null && text !== seen) await refresh(location.href);
    seen = text;
  } catch {
    // The server is away for a moment: the page stays as it is, and the next round asks again.
  }
}

function addressOf() {
  return "./?" + new URLSearchParams(new FormData(form));
}

if (live && location.protocol !== "file:") {
  poll();
  setInterval(poll, PERIOD_MS);
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
