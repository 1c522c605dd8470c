// Draws charts where the page has room for them, when that place comes into view.
import { drawEdge } from "./charts/edge_charts.js";
import { drawTrend } from "./charts/trend.js";

const data = window.rigcal ?? {};

function whenSeen(places, action) {
  const observer = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (!entry.isIntersecting) continue;
      observer.unobserve(entry.target);
      action(entry.target);
    }
  }, { rootMargin: "300px" });
  for (const place of places) observer.observe(place);
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
