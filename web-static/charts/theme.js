// ECharts with the parts that the pages use, in the colours of the style sheet. Tooltips are drawn as rich text on the canvas:
// a name can never become markup, and nothing needs an inline style.
import * as echarts from "echarts/core";
import { BarChart, LineChart } from "echarts/charts";
import { GridComponent, LegendComponent, MarkLineComponent, TooltipComponent } from "echarts/components";
import { CanvasRenderer } from "echarts/renderers";

echarts.use([BarChart, LineChart, GridComponent,
  LegendComponent, MarkLineComponent, TooltipComponent, CanvasRenderer]);

const dark = window.matchMedia("(prefers-color-scheme: dark)");
const drawn = new Map();

export function colorOf(name) {
  return getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
}

function common() {
  const soft = colorOf("soft");
  return {
    animation: false,
    textStyle: { fontFamily: "system-ui, sans-serif", color: colorOf("text") },
    tooltip: {
      renderMode: "richText", confine: true, backgroundColor: colorOf("card"), borderColor: colorOf("line"),
      textStyle: { color: colorOf("text"), fontSize: 12 },
    },
    soft,
    line: colorOf("line"),
  };
}

function axisStyle(base) {
  return {
    axisLine: { lineStyle: { color: base.line } },
    axisTick: { lineStyle: { color: base.line } },
    axisLabel: { color: base.soft, fontSize: 11 },
    nameTextStyle: { color: base.soft, fontSize: 11 },
    splitLine: { lineStyle: { color: base.line } },
  };
}

function withStyle(option) {
  const { soft, line, ...base } = common();
  const style = axisStyle({ soft, line });
  const styled = (axis) => [].concat(axis).map((one) => ({
    ...style, ...one, axisLabel: { ...style.axisLabel, ...one.axisLabel }, nameTextStyle: { ...style.nameTextStyle, ...one.nameTextStyle },
  }));
  return { ...base, ...option, tooltip: { ...base.tooltip, ...option.tooltip }, xAxis: styled(option.xAxis), yAxis: styled(option.yAxis) };
}

// `make` gives the option; it is asked again when the colours of the page change.
export function draw(container, make) {
  const chart = echarts.init(container, null, { renderer: "canvas" });
  const paint = () => chart.setOption(withStyle(make()), true);
  paint();
  const resized = new ResizeObserver(() => chart.resize());
  resized.observe(container);
  const repaint = () => {
    chart.resize();
    paint();
  };
  drawn.set(container, { repaint, end: () => (resized.disconnect(), chart.dispose()) });
}

// The charts below `place` end.
export function erase(place) {
  for (const [container, { end }] of [...drawn]) {
    if (!place.contains(container)) continue;
    drawn.delete(container);
    end();
  }
}

const repaint = () => drawn.forEach((chart) => chart.repaint());
dark.addEventListener("change", repaint);
document.addEventListener("rigcal:colors", repaint);
