// What is heavy, and what the page can be read without, comes after its first content: fetching and compiling it would keep the
// words waiting. `data-scripts` names the scripts in the order in which they run.
const names = document.currentScript.dataset.scripts.split(" ");
let begun = false;

function added(name) {
  const script = document.createElement("script");
  script.src = name;
  script.async = false;
  document.body.append(script);
  return script;
}

function begin() {
  if (begun) return;
  begun = true;
  document.documentElement.dataset.shown = "yes";  // what waited for it, too, is laid out (report.css)
  const scripts = names.map(added);
  scripts.at(-1).addEventListener("load", () => { document.documentElement.dataset.whole = "yes"; });
}

// A page that nobody sees paints nothing.
const paints = !document.hidden && PerformanceObserver.supportedEntryTypes?.includes("paint");
if (paints) new PerformanceObserver((list) => list.getEntriesByName("first-contentful-paint").length > 0 && begin()).observe({ type: "paint", buffered: true });
else begin();
document.addEventListener("visibilitychange", () => document.hidden && begin());
