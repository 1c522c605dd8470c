// A page that is made once knows no now. What it says from a moment on waits in <template data-from="...">, and takes its place
// when that moment has passed: the calibration is overdue then. `now_ms` is the server's where there is one, for clocks of browsers
// may be wrong.
export function tellOverdue(now_ms) {
  for (const words of document.querySelectorAll("template[data-from]")) {
    if (!(now_ms > Date.parse(words.dataset.from))) continue;
    const place = words.closest(".banner, tr");
    place?.classList.add("overdue");
    if (place?.matches(".banner")) document.title = "Overdue: " + document.title;
    words.replaceWith(words.content);
  }
}

// A page may stay open for days. `ahead_ms`: by how much the clock to go by is ahead of the browser's.
export function watchOverdue(ahead_ms) {
  const PERIOD_MS = 60_000;
  const look = () => tellOverdue(Date.now() + ahead_ms);
  look();
  setInterval(look, PERIOD_MS);
}
