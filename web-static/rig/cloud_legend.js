// What the colours of the cloud mean, in a line below it. The same colours as the shader of cloud_view.js.
import { element, number } from "./panel.js";

const NEAR_TO_FAR = [[0.94, 0.98, 0.13], [0.97, 0.58, 0.25], [0.80, 0.28, 0.47], [0.56, 0.20, 0.75]];
const css = (rgb) => `rgb(${rgb.map((part) => Math.round(255 * Math.min(1, Math.max(0, part)))).join(" ")})`;

export const RAMP_GLSL = "vec3[4](" + NEAR_TO_FAR.map((rgb) => `vec3(${rgb.map((part) => part.toFixed(2)).join(", ")})`).join(", ") + ")";

// Turns of the golden angle: neighbours in the list look different.
export function wheel(index) {
  return [0, 0.33, 0.67].map((phase) => 0.55 + 0.45 * Math.cos(2 * Math.PI * (index * 0.381966 + phase)));
}

function swatch(rgb, text) {
  const color = element("span", { className: "swatch" });
  color.style.backgroundColor = css(rgb);
  return element("span", { className: "entry" }, color, text);
}

function scale(colors, from, to) {
  const bar = element("span", { className: "scale" });
  bar.style.backgroundImage = `linear-gradient(to right, ${colors.map(css).join(", ")})`;
  return element("span", { className: "entry" }, from, bar, to);
}

const MAKE = {
  color: () => ["Colours of the cameras' pictures.", swatch([0, 0.78, 0.25], "seen by no camera")],
  camera: ({ cameras }) => [...cameras.map((name, index) => swatch(wheel(index), name)), swatch([0.45, 0.45, 0.45], "none")],
  lidar: ({ lidars }) => lidars.map((name, index) => swatch(wheel(index), name)),
  depth: ({ far }) => [scale(NEAR_TO_FAR, "0 m", `${number(far, 2)} m from the lidar`)],
  intensity: () => [scale([[0.1, 0.1, 0.1], [1, 1, 1]], "weak", "strong echo")],
  uncovered: () => [swatch([0.42, 0.42, 0.42], "seen by a camera"), swatch([1, 0.35, 0.2], "seen by none")],
};

export function fillLegend(line, mode, facts) {
  line.replaceChildren(...MAKE[mode](facts));
}
