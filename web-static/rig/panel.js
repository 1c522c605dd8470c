// Buttons, switches and the list of numbers beside a view. Everything is made by the DOM, so names stay text.
const MM = 1000, DEG = 180 / Math.PI;

export function number(value, digits = 3) {
  return Number.isFinite(value) ? String(Number(value.toPrecision(digits))) : "free";
}

export function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

export function button(text, action) {
  const made = element("button", { type: "button", textContent: text });
  made.addEventListener("click", action);
  return made;
}

export function toggle(text, checked, action) {
  const box = element("input", { type: "checkbox", checked });
  box.addEventListener("change", () => action(box.checked));
  return element("label", { className: "toggle" }, box, " " + text);
}

export function slider(text, { min, max, value, step }, action) {
  const field = element("input", { type: "range", min, max, step, value });
  const shown = element("output");
  const label = element("label", { className: "slider" }, element("span", { textContent: text }), field, shown);
  const update = () => {
    shown.textContent = action(Number(field.value));
    field.setAttribute("aria-valuetext", shown.textContent);
  };
  field.addEventListener("input", update);
  update();
  return label;
}

export function choice(text, options, action) {
  const field = element("select");
  for (const [value, name] of options) field.append(element("option", { value, textContent: name }));
  field.addEventListener("change", () => action(field.value));
  const label = element("label", { className: "choice" }, element("span", { textContent: text }), field);
  label.field = field;
  return label;
}

function row(list, name, value) {
  list.append(element("dt", { textContent: name }), element("dd", { textContent: value }));
}


// Roll, pitch, yaw of a unit quaternion, R = Rz(yaw) Ry(pitch) Rx(roll).
export function rollPitchYaw([x, y, z, w]) {
  const pitch = Math.asin(Math.max(-1, Math.min(1, 2 * (w * y - z * x))));
  return [Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), pitch, Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))];
}

function distance(a, b) {
  return Math.hypot(a.p[0] - b.p[0], a.p[1] - b.p[1], a.p[2] - b.p[2]) * MM;
}

export function angleBetween(a, b) {
  const dot = Math.abs(a.q.reduce((sum, value, index) => sum + value * b.q[index], 0));
  return 2 * Math.acos(Math.min(1, dot)) * DEG;
}

function cells(tag, texts) {
  return texts.map((textContent, index) => (index > 0 && tag === "td" ? element("td", { textContent })
    : element("th", { textContent, scope: tag === "th" ? "col" : "row" })));
}

// One line for each axis: where along it, turned how much about it, and how sure both is.
function poseTable(sensor) {
  const turns = rollPitchYaw(sensor.q);
  const sigma = (index, scale) => (sensor.sigma ? number(sensor.sigma[index] * scale, 2) : "");
  const lines = ["x, roll", "y, pitch", "z, yaw"].map((name, axis) => element("tr", {}, ...cells("td", [
    name, (sensor.p[axis] * MM).toFixed(2), sigma(axis, MM), (turns[axis] * DEG).toFixed(3), sigma(axis + 3, DEG)])));
  const head = element("tr", {}, ...cells("th", ["axis", "mm", "\u03c3, mm", "deg", "\u03c3, deg"]));
  return element("table", { className: "pose" }, element("thead", {}, head), element("tbody", {}, ...lines));
}

const SOURCES = { joint: "all that the sensors saw, as one estimate", jackknife: "leaving out captures", analytic: "the edges' own \u03c3" };

export function showSensor(panel, sensor) {
  const list = element("dl", { className: "pairs" });
  if (sensor.kind) row(list, "kind", sensor.kind.replace(/_/g, " "));
  if (sensor.reference) row(list, "\u03c3", "none: the reference is fixed");
  if (sensor.sigma) row(list, "\u03c3 from", SOURCES[sensor.sigma_source] ?? sensor.sigma_source);
  for (const [name, pose] of [["from its nominal pose", sensor.nominal], ["since the last revision", sensor.previous]])
    if (pose && !sensor.reference) row(list, name, `${number(distance(sensor, pose))} mm, ${number(angleBetween(sensor, pose))} deg`);
  panel.replaceChildren(element("h3", { textContent: sensor.id }), poseTable(sensor), list);
}
