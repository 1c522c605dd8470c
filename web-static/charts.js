// Draws charts where the page has room for them, when that place comes into view.
import { drawEdge } from "./charts/edge_charts.js";
import { drawTrend } from "./charts/trend.js";

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
const trends = new Map((data.trends ?? []).map((trend) => [trend.sensor, trend.rows]));
whenSeen(document.querySelectorAll("[data-trend]"), (place) => {
  const rows = trends.get(place.dataset.trend);
  if (rows?.length) drawTrend(place, place.dataset.trend, rows);
});
readGraph(document.querySelector("svg.graph"));
