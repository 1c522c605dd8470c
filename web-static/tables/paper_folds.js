// Nobody opens a fold on paper: those that say what is wrong are open while a page is printed, and as they were afterwards. Before
// all others that prepare for paper, for charts are drawn where it is open.
const THAT_MATTER = "details.edge.failed, details.group, .causes details, details.edge:has(> summary .badge.warn), details.camera:has(> summary .badge.warn)";
const MANY = 12;  // of more, only their titles are printed; what failed is open in any case
let opened = [];

function toOpen() {
  const closed = [...document.querySelectorAll(THAT_MATTER)].filter((one) => !one.open);
  if (closed.length <= MANY) return closed;
  return closed.filter((one) => one.matches(".failed, .group, .causes details"));
}

export function openForPaper() {
  window.addEventListener("beforeprint", () => {
    opened = toOpen();
    opened.forEach((one) => { one.open = true; });
  }, { capture: true });
  window.addEventListener("afterprint", () => {
    opened.forEach((one) => { one.open = false; });
    opened = [];
  });
}
