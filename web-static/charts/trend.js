// The history of the sensors over the revisions, and over the visits: position and rotation against the first, with a band of
// one sigma, and a mark where a sensor stepped by 3 sigma or more, or was remounted.
import { colorOf, draw } from "./theme.js";
import { digits } from "./digits.js";
import { farthest, isOff, nameOf, sigmas } from "./trend_text.js";
import { sigmasClass } from "../sigmas.js";

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

function steps(rows) {
  return {
    silent: true, symbol: "none", lineStyle: { color: colorOf("fit3"), type: "dashed", width: 1.5 },
    label: { formatter: (mark) => mark.name, color: colorOf("fit3"), fontSize: 11, position: "end" },
    data: rows.flatMap((row, index) => (isOff(row) || row.remounted ? [{ xAxis: index, name: row.remounted ? "remounted" : sigmas(row) }] : [])),
  };
}

const tickOf = (row) => (row.revision ? row.revision + (row.date ? "\n" + row.date : "") : row.date);
const AXIS_OF = { revision: "revision, and when its newest session was captured", visit: "visit, when it was captured" };

function option(rows, group) {
  const colors = [colorOf("axis-x"), colorOf("axis-y"), colorOf("axis-z")];
  const lines = group.names.map((name, index) => ({
    name, type: "line", symbolSize: 7, color: colors[index], data: rows.map((row) => row.d[group.first + index] * group.scale),
  }));
  if (lines.length) lines[0].markLine = steps(rows);
  return {
    grid: { left: 8, right: 26, top: 56, bottom: 26, containLabel: true },
    legend: { data: group.names, top: 0, right: 0, textStyle: { color: colorOf("text") } },
    tooltip: {
      trigger: "axis",
      formatter: (points) => `${nameOf(rows[points[0].dataIndex])}${isOff(rows[points[0].dataIndex]) ? ", a step of " + sigmas(rows[points[0].dataIndex]) : ""}\n` + points.filter((point) => group.names.includes(point.seriesName)).map((point) => {
        const axis = group.first + group.names.indexOf(point.seriesName);
        return `${point.seriesName} ${digits(point.value)} \u00b1 ${digits(rows[point.dataIndex].sigma[axis] * group.scale, 2)} ${group.unit}`;
      }).join("\n"),
    },
    xAxis: { type: "category", data: rows.map(tickOf), name: AXIS_OF[rows[0].revision ? "revision" : "visit"], nameLocation: "middle", nameGap: 40, axisLabel: { lineHeight: 15 } },
    yAxis: { type: "value", name: group.unit, scale: true },
    series: [...group.names.flatMap((_, index) => band(rows, group.first + index, group.scale, colors[index])), ...lines],
  };
}

export function heading({ sensor, rows, visits = [] }) {
  const title = document.createElement("h3");
  const name = document.createElement("bdi");
  name.textContent = sensor;
  title.append(name, " ");
  const worst = farthest([...rows, ...visits]), badge = document.createElement("span");
  if (worst.in_sigmas === undefined) return title;
  badge.className = "badge " + sigmasClass(worst.in_sigmas);
  badge.textContent = sigmas(worst);
  const text = document.createElement("span");
  text.className = "soft";
  text.textContent = ` farthest step: ${digits(worst.moved_m * 1000, 2)} mm and ${digits(worst.turned_rad * 180 / Math.PI, 2)} deg, at ${nameOf(worst)}`;
  title.append(badge, text);
  return title;
}

// `rows`: [{revision, date, d: [6] against the first known pose, sigma: [6], and of the step since the row before moved_m,
// turned_rad, in_sigmas, or remounted}] of one sensor; `visits`: likewise, without a revision.
export function drawTrend(place, { sensor, rows, visits = [] }) {
  drawSeries(place, sensor, rows);
  if (visits.length > 1) drawSeries(place, sensor, visits);
}

function drawSeries(place, sensor, rows) {
  for (const group of GROUPS) {
    const box = document.createElement("figure");
    box.className = "plot";
    const caption = document.createElement("figcaption");
    const strong = document.createElement("strong");
    strong.textContent = `${group.title} of ${sensor}`;
    caption.append(strong, ` ${rows[0].revision ? "" : "by each visit alone, "}against ${nameOf(rows[0])}, ${group.unit}; band: one \u03c3`);
    const chart = document.createElement("div");
    chart.className = "chart tall";
    chart.setAttribute("role", "img");
    chart.setAttribute("aria-label", `${group.title} of ${sensor} over the ${rows[0].revision ? "revisions" : "visits"}`);
    box.append(caption, chart);
    place.append(box);
    draw(chart, () => option(rows, group));
  }
}
