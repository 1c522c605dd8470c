// Draws charts where the page has room for them, when that place comes into view.
import { drawEdge } from "./charts/edge_charts.js";
import { showHistory } from "./charts/history.js";
import { whenSeen } from "./charts/when_seen.js";
import { readGraph } from "./charts/graph_readout.js";

const edges = new Map((window.rigcal?.edges ?? []).map((edge) => [edge.anchor, edge]));
whenSeen(document.querySelectorAll("[data-edge-charts]"), (place) => {
  const edge = edges.get(place.dataset.edgeCharts);
  if (edge) drawEdge(place, edge);
});
showHistory();
readGraph(document.querySelector("svg.graph"));
