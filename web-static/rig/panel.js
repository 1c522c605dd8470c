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

const fixed = (values, scale, decimals) => values.map((value) => (value * scale).toFixed(decimals)).join(", ");
const triple = (values, scale, digits) => values.map((value) => number(value * scale, digits)).join(", ");

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

export function showSensor(panel, sensor) {
  const list = element("dl", { className: "pairs" });
  row(list, "kind", sensor.kind || "not known");
  row(list, "x, y, z", fixed(sensor.p, MM, 2) + " mm");
  row(list, "roll, pitch, yaw", fixed(rollPitchYaw(sensor.q), DEG, 3) + " deg");
  if (sensor.reference) row(list, "\u03c3", "reference: fixed");
  if (sensor.sigma) {
    row(list, "\u03c3 x, y, z", triple(sensor.sigma.slice(0, 3), MM, 2) + " mm");
    row(list, "\u03c3 rx, ry, rz", triple(sensor.sigma.slice(3), DEG, 2) + " deg");
    row(list, "\u03c3 from", sensor.sigma_source);
  }
  for (const [name, pose] of [["from nominal", sensor.nominal], ["since the last revision", sensor.previous]])
    if (pose && !sensor.reference) row(list, name, `${number(distance(sensor, pose))} mm, ${number(angleBetween(sensor, pose))} deg`);
  panel.replaceChildren(element("h3", { textContent: sensor.id }), list);
}
