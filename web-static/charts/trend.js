// The history of the sensors over the revisions: position and rotation against the first, with a band of one sigma, and a
// mark where a sensor stepped by 3 sigma or more.
import { colorOf, draw } from "./theme.js";
import { digits } from "./edge_charts.js";
import { OFF_SIGMAS, sigmasClass, sigmasText } from "../sigmas.js";

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

const isOff = (row) => (row.in_sigmas ?? 0) >= OFF_SIGMAS;
const farthest = (rows) => rows.reduce((most, row) => ((row.in_sigmas ?? 0) > (most.in_sigmas ?? 0) ? row : most), rows[0]);
const sigmas = (row) => `${sigmasText(row.in_sigmas ?? 0)} \u03c3`;

function steps(rows) {
  return {
    silent: true, symbol: "none", lineStyle: { color: colorOf("fit3"), type: "dashed", width: 1.5 },
    label: { formatter: (mark) => mark.name, color: colorOf("fit3"), fontSize: 11, position: "end" },
    data: rows.flatMap((row, index) => (isOff(row) ? [{ xAxis: index, name: sigmas(row) }] : [])),
  };
}

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
      formatter: (points) => `revision ${rows[points[0].dataIndex].revision}${isOff(rows[points[0].dataIndex]) ? ", a step of " + sigmas(rows[points[0].dataIndex]) : ""}\n` + points.filter((point) => group.names.includes(point.seriesName)).map((point) => {
        const axis = group.first + group.names.indexOf(point.seriesName);
        return `${point.seriesName} ${digits(point.value)} \u00b1 ${digits(rows[point.dataIndex].sigma[axis] * group.scale, 2)} ${group.unit}`;
      }).join("\n"),
    },
    xAxis: { type: "category", data: rows.map((row) => row.revision + (row.date ? "\n" + row.date : "")), name: "revision, and when its newest session was captured", nameLocation: "middle", nameGap: 40, axisLabel: { lineHeight: 15 } },
    yAxis: { type: "value", name: group.unit, scale: true },
    series: [...group.names.flatMap((_, index) => band(rows, group.first + index, group.scale, colors[index])), ...lines],
  };
}

// The solution is a mean of old and new measurements: what moved once keeps stepping while new ones come.
function whenMoved(rows) {
  const off = rows.filter(isOff), last = off.at(-1);
  if (off.length === 1) return `revision ${last.revision} (${sigmas(last)})`;
  return `revision ${off[0].revision} (${sigmas(off[0])}), ` + (off.length > 2 ? `${off.length - 1} times more until` : "again at") + ` revision ${last.revision}`;
}

// Of a long history only the newest revisions are drawn.
function sinceWhen(trends) {
  const first = Math.min(...trends.map(({ rows }) => rows[0].revision));
  return first > 1 ? `Since revision ${first}: ` : "";
}

// "front_right moved at revision 3 (67.7 sigma) ...": what the charts show, in one sentence.
export function historyText(trends) {
  const known = byFarthestStep(trends).filter((trend) => trend.rows.length > 1);
  if (known.length === 0) return "No sensor is known in two revisions with one reference.";
  const moved = known.filter((trend) => trend.rows.some(isOff));
  const since = sinceWhen(known), told = (text) => (since ? since + text[0].toLowerCase() + text.slice(1) : text);
  if (moved.length === 0) return told("No sensor stepped by 3 \u03c3 or more from one revision to the next.");
  const said = moved.slice(0, 3).map(({ sensor, rows }) => `${sensor} at ${whenMoved(rows)}`);
  const more = moved.length > 3 ? `, and ${moved.length - 3} more sensors` : "";
  const rest = known.length - moved.length;
  return told(`Moved: ${said.join("; ")}${more}.` + (rest > 0 ? ` The other ${rest === 1 ? "one" : rest} stepped by less than 3 \u03c3.` : ""));
}

export function byFarthestStep(trends) {
  const most = (trend) => farthest(trend.rows).in_sigmas ?? 0;
  return [...trends].sort((a, b) => most(b) - most(a) || a.sensor.localeCompare(b.sensor));
}

export function heading(sensor, rows) {
  const title = document.createElement("h3");
  const name = document.createElement("bdi");
  name.textContent = sensor;
  title.append(name, " ");
  const worst = farthest(rows), badge = document.createElement("span");
  if (worst.in_sigmas === undefined) return title;
  badge.className = "badge " + sigmasClass(worst.in_sigmas);
  badge.textContent = sigmas(worst);
  const text = document.createElement("span");
  text.className = "soft";
  text.textContent = ` farthest step: ${digits(worst.moved_m * 1000, 2)} mm and ${digits(worst.turned_rad * 180 / Math.PI, 2)} deg, at revision ${worst.revision}`;
  title.append(badge, text);
  return title;
}

// `rows`: [{revision, date, d: [6] against the first known pose, sigma: [6], and of the step since the row before moved_m,
// turned_rad, in_sigmas}] of one sensor.
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
