// Draws charts where the page has room for them, when that place comes into view.
import { drawEdge } from "./charts/edge_charts.js";
import { byFarthestStep, drawTrend, heading, historyText } from "./charts/trend.js";

import { beforePaper } from "./charts/paper.js";
import { readGraph } from "./charts/graph_readout.js";

const data = window.rigcal ?? {};

// What is printed is drawn as well, seen or not, as far as its section is open.
function whenSeen(places, action) {
  const waiting = new Set(places);
  const act = (place) => {
    if (!waiting.delete(place)) return;
    observer.unobserve(place);
    action(place);
  };
  const observer = new IntersectionObserver((entries) => {
    for (const entry of entries) if (entry.isIntersecting) act(entry.target);
  }, { rootMargin: "300px" });
  for (const place of places) observer.observe(place);
  beforePaper(() => [...waiting].filter((place) => !place.closest("details:not([open])")).forEach(act));
}

function edgesByAnchor() {
  return new Map((data.edges ?? []).map((edge) => [edge.anchor, edge]));
}

const edges = edgesByAnchor();
whenSeen(document.querySelectorAll("[data-edge-charts]"), (place) => {
  const edge = edges.get(place.dataset.edgeCharts);
  if (edge) drawEdge(place, edge);
});

// The sensor that stepped farthest comes first, and a sentence says which did.
function tellHistory(history, trends) {
  const told = document.createElement("p");
  told.className = "what";
  told.textContent = historyText(trends);
  history.querySelector("h2").after(told);
  const places = new Map([...history.querySelectorAll("[data-trend]")].map((place) => [place.dataset.trend, place]));
  for (const { sensor, rows } of byFarthestStep(trends)) {
    const place = places.get(sensor);
    if (!place) continue;
    place.append(heading(sensor, rows));
    history.append(place);
  }
}

const history = document.getElementById("history");
if (history && data.trends) tellHistory(history, data.trends);
const trends = new Map((data.trends ?? []).map((trend) => [trend.sensor, trend.rows]));
whenSeen(document.querySelectorAll("[data-trend]"), (place) => {
  const rows = trends.get(place.dataset.trend);
  if (rows?.length) drawTrend(place, place.dataset.trend, rows);
});
readGraph(document.querySelector("svg.graph"));
