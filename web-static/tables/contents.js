// The parts of a long page in one line that stays in view, and buttons that open or close all sections of a part.

export function addContents() {
  const parts = [...document.querySelectorAll("[data-part]")].filter((part) => part.id && !part.hidden);
  const header = document.querySelector("main > header");
  if (parts.length < 3 || !header) return;
  document.querySelector("nav.contents")?.remove();
  const bar = document.createElement("nav");
  bar.className = "contents";
  bar.setAttribute("aria-label", "Parts of this page");
  for (const part of parts) {
    const link = document.createElement("a");
    link.href = "#" + part.id;
    link.textContent = part.dataset.part;
    bar.append(link);
  }
  header.after(bar);
}

export function addOpenAll(heading) {
  if (!heading) return;
  const sections = () => [...document.querySelectorAll("details.edge:not(.camera)")];
  const bar = document.createElement("p");
  bar.className = "bar";
  for (const [text, open] of [["Open all", true], ["Close all", false]]) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = text;
    button.addEventListener("click", () => sections().forEach((one) => { one.open = open; }));
    bar.append(button);
  }
  heading.after(bar);
}

// A link to a section opens it, and the fold that it is in: else it would lead to a closed heading.
export function openTarget() {
  const target = location.hash.length > 1 && document.getElementById(location.hash.slice(1));
  let opened = false;
  for (let fold = target && target.closest("details"); fold; fold = fold.parentElement.closest("details")) {
    opened ||= !fold.open;
    fold.open = true;
  }
  if (opened) target.scrollIntoView();
}
