// The history of one sensor over the revisions: position and rotation against the first, with a band of one sigma.
import { colorOf, draw } from "./theme.js";
import { digits } from "./edge_charts.js";

const GROUPS = [
  { title: "Position", unit: "mm", scale: 1000, first: 0, names: ["x", "y", "z"] },
  { title: "Rotation", unit: "deg", scale: 180 / Math.PI, first: 3, names: ["rx", "ry", "rz"] },
];

function band(rows, axis, scale, color) {
  const low = rows.map((row) => (row.d[axis] - row.sigma[axis]) * scale);
  const width = rows.map((row) => 2 * row.sigma[axis] * scale);
  const common = { type: "line", stack: "band" + axis, symbol: "none", lineStyle: { opacity: 0 }, silent: true, stackStrategy: "all", tooltip: { show: false } };
  return [{ ...common, data: low }, { ...common, data: width, areaStyle: { color, opacity: 0.16 } }];
}

function option(rows, group) {
  const colors = [colorOf("axis-x"), colorOf("axis-y"), colorOf("axis-z")];
  const lines = group.names.map((name, index) => ({
    name, type: "line", symbolSize: 7, color: colors[index], data: rows.map((row) => row.d[group.first + index] * group.scale),
  }));
  return {
    grid: { left: 8, right: 14, top: 34, bottom: 6, containLabel: true },
    legend: { data: group.names, top: 0, right: 0, textStyle: { color: colorOf("text") } },
    tooltip: {
      trigger: "axis",
      formatter: (points) => `revision ${rows[points[0].dataIndex].revision}\n` + points.filter((point) => group.names.includes(point.seriesName)).map((point) => {
        const axis = group.first + group.names.indexOf(point.seriesName);
        return `${point.seriesName} ${digits(point.value)} \u00b1 ${digits(rows[point.dataIndex].sigma[axis] * group.scale, 2)} ${group.unit}`;
      }).join("\n"),
    },
    xAxis: { type: "category", data: rows.map((row) => String(row.revision)), name: "revision", nameLocation: "middle", nameGap: 24 },
    yAxis: { type: "value", name: group.unit, scale: true },
    series: [...group.names.flatMap((_, index) => band(rows, group.first + index, group.scale, colors[index])), ...lines],
  };
}

// `rows`: [{revision, d: [6] against the first known pose, sigma: [6]}] of one sensor.
export function drawTrend(place, sensor, rows) {
  for (const group of GROUPS) {
    const box = document.createElement("figure");
    box.className = "plot";
    const caption = document.createElement("figcaption");
    const strong = document.createElement("strong");
    strong.textContent = `${group.title} of ${sensor}`;
    caption.append(strong, ` against revision ${rows[0].revision}, ${group.unit}; band: one \u03c3`);
    const chart = document.createElement("div");
    chart.className = "chart tall";
    chart.setAttribute("role", "img");
    chart.setAttribute("aria-label", `${group.title} of ${sensor} over the revisions`);
    box.append(caption, chart);
    place.append(box);
    draw(chart, () => option(rows, group));
  }
}
