// The charts of one edge: residual of each capture, how far the answer moves without it, sigma of each direction.
import { colorOf, draw } from "./theme.js";
import { digits } from "./digits.js";

const AXES = ["x", "y", "z", "rx", "ry", "rz"];
const MM = 1000, DEG = 180 / Math.PI;

function figure(parent, title, hint, height) {
  const box = document.createElement("figure");
  box.className = "plot";
  const caption = document.createElement("figcaption");
  const strong = document.createElement("strong");
  strong.textContent = title;
  caption.append(strong, " ", hint);
  const chart = document.createElement("div");
  chart.className = height > 200 ? "chart tall" : "chart";
  chart.setAttribute("role", "img");
  chart.setAttribute("aria-label", title);
  box.append(caption, chart);
  parent.append(box);
  return chart;
}

const grid = { left: 8, right: 12, top: 26, bottom: 6, containLabel: true };
const unitOf = (edge) => (edge.unit === "m" ? { scale: MM, unit: "mm" } : { scale: 1, unit: "px" });

// Over all captures that were used, in the unit shown; null where there is none.
export function rmsOf(edge) {
  const used = edge.captures.filter((capture) => !capture.unused).map((capture) => capture.rms * unitOf(edge).scale);
  return used.length ? Math.sqrt(used.reduce((sum, value) => sum + value * value, 0) / used.length) : null;
}

// What was not used has no bar but a cross.
const CROSS = { show: true, formatter: "\u00d7", position: "top", distance: 0, fontSize: 13, fontWeight: 700 };

// The line stands at the value itself: by default ECharts rounds it to two decimals.
function residualOption(edge) {
  const { scale, unit } = unitOf(edge), rms = rmsOf(edge);
  return {
    grid,
    tooltip: {
      trigger: "axis",
      formatter: ([point]) => {
        const capture = edge.captures[point.dataIndex];
        return !capture.unused ? `${capture.capture}: ${digits(capture.rms * scale)} ${unit}` : `${capture.capture}: not used\n${capture.note}`;
      },
    },
    xAxis: { type: "category", data: edge.captures.map((capture) => capture.capture) },
    yAxis: { type: "value", name: unit, min: 0, nameTextStyle: { align: "left" } },
    series: [{
      type: "bar", barMaxWidth: 26,
      data: edge.captures.map((capture) => (!capture.unused ? { value: capture.rms * scale } : { value: 0, label: { ...CROSS, color: colorOf("fail-strong") } })),
      itemStyle: { color: colorOf("link"), borderRadius: [2, 2, 0, 0] },
      markLine: {
        silent: true, symbol: "none", label: { show: false }, precision: 12,
        lineStyle: { color: colorOf("text"), type: "dashed", width: 1.4 }, data: rms === null ? [] : [{ yAxis: rms }],
      },
    }],
  };
}

// Each axis has the colour of its bars.
const axesOf = (left, right) => [
  { type: "value", name: left, min: 0, nameTextStyle: { color: colorOf("link"), fontWeight: 700, align: "left" } },
  { type: "value", name: right, min: 0, splitLine: { show: false }, nameTextStyle: { color: colorOf("second"), fontWeight: 700, align: "right" } },
];

const shift = (d, first, scale) => Math.hypot(d[first], d[first + 1], d[first + 2]) * scale;

function influenceOption(edge) {
  const bar = (name, first, scale, unit, axis, color) => ({
    name, type: "bar", yAxisIndex: axis, barMaxWidth: 14, itemStyle: { color, borderRadius: [2, 2, 0, 0] },
    data: edge.blocks.map((block) => shift(block.d, first, scale)), unit,
  });
  return {
    grid: { ...grid, top: 44 },
    legend: { top: 0, right: 0, textStyle: { color: colorOf("text") } },
    tooltip: {
      trigger: "axis",
      formatter: (points) => `without ${edge.blocks[points[0].dataIndex].id}:\n` +
        points.map((point) => `${point.seriesName} moves ${digits(point.value)} ${point.seriesIndex === 0 ? "mm" : "deg"}`).join("\n"),
    },
    xAxis: { type: "category", data: edge.blocks.map((block) => block.id) },
    yAxis: axesOf("mm", "deg"),
    series: [bar("position", 0, MM, "mm", 0, colorOf("link")), bar("rotation", 3, DEG, "deg", 1, colorOf("second"))],
  };
}

function directionOption(edge) {
  const value = (axis) => (edge.sigma[axis] === null ? null : edge.sigma[axis] * (axis < 3 ? MM : DEG));
  const bars = (from, axis, color) => ({
    type: "bar", yAxisIndex: axis, barMaxWidth: 26, barGap: "-100%", itemStyle: { color, borderRadius: [2, 2, 0, 0] },
    data: AXES.map((_, index) => (index >= from && index < from + 3 ? value(index) : null)),
    label: { show: true, position: "top", color: colorOf("soft"), fontSize: 10, formatter: (point) => (point.value == null ? "" : digits(point.value, 2)) },
  });
  return {
    grid,
    tooltip: {
      trigger: "axis",
      formatter: (points) => {
        const axis = points[0].dataIndex;
        return `${AXES[axis]}: ` + (value(axis) === null ? "free: the data say nothing" : `\u03c3 ${digits(value(axis))} ${axis < 3 ? "mm" : "deg"}`);
      },
    },
    xAxis: { type: "category", data: AXES.map((name, axis) => (edge.sigma[axis] === null ? name + "\nfree" : name)) },
    yAxis: axesOf("\u03c3, mm", "\u03c3, deg"),
    series: [bars(0, 0, colorOf("link")), bars(3, 1, colorOf("second"))],
  };
}

// `place` holds what the server drew; that is hidden where a chart takes its place.
export function drawEdge(place, edge) {
  if (edge.captures.some((capture) => !capture.unused)) {
    for (const fallback of place.querySelectorAll("[data-fallback]")) fallback.hidden = true;
    const unused = edge.captures.some((capture) => capture.unused) ? "; \u00d7: not used" : "";
    draw(figure(place, "Residual of each capture", `dashed: rms of all, ${digits(rmsOf(edge))} ${unitOf(edge).unit}${unused}`, 190), () => residualOption(edge));
  }
  if (edge.blocks.length)
    draw(figure(place, "Which capture moves the answer", "how far the pose moves when one capture, or group of captures, is left out", 200), () => influenceOption(edge));
  if (edge.state === "good")
    draw(figure(place, "How well each direction is known", "one \u03c3 along and about the axes of " + edge.b, 190), () => directionOption(edge));
}
