// Paper is light: before it is printed a page takes the light colours, and what scripts drew is drawn again in them.
const root = document.documentElement;
const before = [];

export function beforePaper(action) {
  before.push(action);
}

function set(paper) {
  root.toggleAttribute("data-paper", paper);
  document.dispatchEvent(new CustomEvent("rigcal:colors"));
}

window.addEventListener("beforeprint", () => {
  set(true);
  before.forEach((action) => action());
});
window.addEventListener("afterprint", () => set(false));
