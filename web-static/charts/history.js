// The history of a robot's sensors: a sentence, and charts. When a revision came meanwhile it is drawn anew.
import { drawTrend, heading } from "./trend.js";
import { byFarthestStep, historyText } from "./trend_text.js";
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
  for (const trend of byFarthestStep(trends)) {
    const place = places.get(trend.sensor);
    if (!place) continue;
    place.append(heading(trend));
    section.append(place);
  }
}

let trendOf = new Map();

function drawPlace(place) {
  const trend = trendOf.get(place.dataset.trend);
  if (trend?.rows.length) drawTrend(place, trend);
}

function take(section, trends) {
  trendOf = new Map(trends.map((trend) => [trend.sensor, trend]));
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
