// The history of a robot's sensors: a sentence, and charts. When a revision came meanwhile it is drawn anew.
import { byFarthestStep, drawTrend, heading, historyText } from "./trend.js";
import { erase } from "./theme.js";
import { whenSeen } from "./when_seen.js";

const newest = () => document.querySelector("#live a[href^='revisions/']")?.getAttribute("href");

// The sensor that stepped farthest comes first, and the sentence says which did.
function tell(section, trends) {
  const told = document.createElement("p");
  told.className = "what";
  told.textContent = historyText(trends);
  section.querySelector("h2").after(told);
  const places = new Map([...section.querySelectorAll("[data-trend]")].map((place) => [place.dataset.trend, place]));
  for (const { sensor, rows } of byFarthestStep(trends)) {
    const place = places.get(sensor);
    if (!place) continue;
    place.append(heading(sensor, rows));
    section.append(place);
  }
}

let rowsOf = new Map();

function drawPlace(place) {
  const rows = rowsOf.get(place.dataset.trend);
  if (rows?.length) drawTrend(place, place.dataset.trend, rows);
}

function take(section, trends) {
  rowsOf = new Map(trends.map(({ sensor, rows }) => [sensor, rows]));
  tell(section, trends);
}

// What was drawn already is drawn again; the rest follows when it comes into view.
function takeAnew(section, trends) {
  const places = [...section.querySelectorAll("[data-trend]")], drawn = places.filter((place) => place.querySelector("canvas"));
  section.querySelector(".what").remove();
  for (const place of places) {
    erase(place);
    place.replaceChildren();
  }
  take(section, trends);
  drawn.forEach(drawPlace);
}

// As on the page itself the numbers come as a script.
function readAnew(section) {
  const old = document.querySelector('script[src="trend.js"]'), script = document.createElement("script");
  script.src = "trend.js";
  script.addEventListener("load", () => takeAnew(section, window.rigcal.trends));
  old.replaceWith(script);
}

export function showHistory() {
  const section = document.getElementById("history"), trends = window.rigcal?.trends;
  if (!section || !trends) return;
  take(section, trends);
  whenSeen(section.querySelectorAll("[data-trend]"), drawPlace);
  let shown = newest();
  document.addEventListener("rigcal:refreshed", () => {
    if (newest() === shown) return;
    shown = newest();
    readAnew(section);
  });
}
