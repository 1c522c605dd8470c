// The coloured cloud, to be turned by hand; those of all lidars in one scene show how well they lie on each other. Its points are fetched when asked for; a page from disk may not fetch, there the
// file is chosen by hand.
import { BufferGeometry, GLSL3, Group, IntType, InterleavedBuffer, InterleavedBufferAttribute, Matrix4, Points, Quaternion, RawShaderMaterial, Vector3 } from "three";
import { Box3, View, hasWebGl } from "./scene.js";
import { button, choice, element, number, slider } from "./panel.js";
import { RAMP_GLSL, fillLegend, wheel } from "./cloud_legend.js";
import { compareOverlays } from "./overlay.js";

const HEADER_BYTES = 28, RECORD_BYTES = 12;
export const MODES = [["color", "Cameras' colours"], ["camera", "Which camera"], ["depth", "Distance"], ["intensity", "Intensity"], ["uncovered", "Seen by no camera"], ["lidar", "Which lidar"]];
const OF_ONE = MODES.filter(([key]) => key !== "lidar"), OF_ALL = MODES.filter(([key]) => key !== "camera");  // each lidar numbers cameras of its own
const HERE = { p: [0, 0, 0], q: [0, 0, 0, 1] };

// {count, origin, step, shorts} of a points.bin; throws a sentence for anything else.
export function readPoints(buffer) {
  const view = new DataView(buffer);
  if (buffer.byteLength < HEADER_BYTES || view.getUint32(0) !== 0x52434c44 || view.getUint32(4, true) !== 1)
    throw new Error("This is no cloud that this page can show.");
  const count = view.getUint32(8, true);
  if (buffer.byteLength !== HEADER_BYTES + count * RECORD_BYTES) throw new Error("The file of points is not complete.");
  const float = (at) => view.getFloat32(at, true);
  return {
    count, origin: [float(12), float(16), float(20)], step: float(24),
    shorts: new Int16Array(buffer, HEADER_BYTES, count * 6),
  };
}

// A record as the graphics memory likes it, all of it in one buffer: four whole shorts (x, y, z, and red with green), two more
// (blue with camera, intensity). Other groupings would be converted on the processor first.
const VERTEX = `
precision highp float;
uniform mat4 modelMatrix, viewMatrix, projectionMatrix;
uniform float size, far;
uniform int mode;
uniform vec3 sensor, own;
in ivec4 position;
in ivec2 tail;
out vec3 shown;
vec3 ramp(float t) {
  vec3 colors[4] = ${RAMP_GLSL};
  float at = clamp(t, 0.0, 1.0) * 3.0;
  int first = min(int(at), 2);
  return mix(colors[first], colors[first + 1], at - float(first));
}
vec3 wheel(float k) { return 0.55 + 0.45 * cos(6.2831853 * (k * 0.381966 + vec3(0.0, 0.33, 0.67))); }
void main() {
  int camera = (tail.x >> 8) & 255;
  bool covered = camera != 255;
  vec3 meters = (modelMatrix * vec4(vec3(position.xyz), 1.0)).xyz;
  if (mode == 0) shown = vec3(float(position.w & 255) / 255.0, float((position.w >> 8) & 255) / 255.0, float(tail.x & 255) / 255.0);
  else if (mode == 1) shown = covered ? wheel(float(camera)) : vec3(0.45);
  else if (mode == 2) shown = ramp(length(meters - sensor) / far);
  else if (mode == 3) shown = vec3(0.1 + 0.9 * float(tail.y & 255) / 255.0);
  else if (mode == 4) shown = covered ? vec3(0.42) : vec3(1.0, 0.35, 0.2);
  else shown = own;
  gl_Position = projectionMatrix * viewMatrix * vec4(meters, 1.0);
  gl_PointSize = size;
}`;
const FRAGMENT = "precision mediump float;\nin vec3 shown;\nout vec4 color;\nvoid main() { color = vec4(shown, 1.0); }";

// Where nearly all points are: a few far ones must not make the rest small.
function boxOf({ count, shorts, origin, step }, transform) {
  const jump = Math.max(1, Math.floor(count / 20000));
  const box = new Box3(), point = new Vector3();
  const sorted = [[], [], []];
  for (let index = 0; index < count; index += jump) {
    point.set(...[0, 1, 2].map((axis) => origin[axis] + step * shorts[index * 6 + axis])).applyMatrix4(transform);
    point.toArray().forEach((value, axis) => sorted[axis].push(value));
  }
  for (const values of sorted) values.sort((a, b) => a - b);
  const part = (ratio) => new Vector3(...sorted.map((values) => values[Math.floor((values.length - 1) * ratio)]));
  return box.set(part(0.03), part(0.97));
}

function pointsOf(cloud, own) {
  const geometry = new BufferGeometry();
  const records = new InterleavedBuffer(cloud.shorts, 6);
  for (const [name, size, offset] of [["position", 4, 0], ["tail", 2, 4]]) {
    const attribute = new InterleavedBufferAttribute(records, size, offset, false);
    attribute.gpuType = IntType;
    geometry.setAttribute(name, attribute);
  }
  const material = new RawShaderMaterial({
    glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT,
    uniforms: { size: { value: 2 }, mode: { value: 0 }, far: { value: 1 }, sensor: { value: new Vector3() }, own: { value: new Vector3(...own) } },
  });
  const points = new Points(geometry, material);
  points.frustumCulled = false;
  points.scale.setScalar(cloud.step);
  points.position.set(...cloud.origin);
  return points;
}

// One alone stands in its own frame, several where their lidars are. A lidar may be mounted askew: what is up for the cameras
// is up here, too.
function placed(members) {
  const [{ up, pose }] = members, turned = new Group(), box = new Box3();
  turned.quaternion.setFromUnitVectors(new Vector3(...up).applyQuaternion(new Quaternion(...pose.q)), new Vector3(0, 0, 1));
  const points = members.map(({ cloud, pose: { p, q } }, index) => {
    const group = new Group(), one = pointsOf(cloud, wheel(index));
    group.position.set(...p);
    group.quaternion.set(...q);
    group.add(one);
    turned.add(group);
    turned.updateMatrixWorld(true);
    one.material.uniforms.sensor.value.setFromMatrixPosition(group.matrixWorld);
    box.union(boxOf(cloud, new Matrix4().copy(group.matrixWorld)));
    return one;
  });
  const far = Math.max(box.min.length(), box.max.length());
  for (const one of points) one.material.uniforms.far.value = far;
  return { turned, points, box, far };
}

const countText = (count) => (count < 1e6 ? `${count.toLocaleString("en")} points` : `${number(count / 1e6, 3)} million points`);

// `members`: [{name, cloud, up, cameras, pose}].
function show(place, members) {
  const count = members.reduce((sum, { cloud }) => sum + cloud.count, 0);
  if (!count) throw new Error("The cloud holds no point.");
  const frame = element("div", { className: "view" }), bar = element("div", { className: "bar" }), legend = element("p", { className: "legend" });
  place.replaceChildren(frame, bar, legend);
  const view = new View(frame, "z", false, "cloud"), { turned, points, box, far } = placed(members), lidars = members.map(({ name }) => name);
  const uniform = (key, value) => {
    for (const one of points) one.material.uniforms[key].value = value;
    view.request();
  };
  view.canvas.setAttribute("aria-label", `Coloured cloud of ${lidars.join(" and ")}: ${count} points. Arrow keys turn it, plus and minus zoom.`);
  view.scene.add(turned);
  for (const [key, text] of [["oblique", "All"], ["front", "Front"], ["top", "Top"], ["side", "Side"]]) bar.append(button(text, () => view.look(key)));
  bar.append(choice("Colour", members.length > 1 ? OF_ALL : OF_ONE, (mode) => {
    uniform("mode", MODES.findIndex(([key]) => key === mode));
    fillLegend(legend, mode, { cameras: members[0].cameras, far, lidars });
  }));
  fillLegend(legend, "color", {});
  bar.append(slider("Point size", { min: 1, max: 8, step: 0.5, value: 2 }, (size) => {
    uniform("size", size * view.renderer.getPixelRatio());
    return `${size} px`;
  }));
  bar.append(element("span", { className: "soft", textContent: countText(count) }));
  view.resize();
  view.fit(box);
  view.canvas.focus({ preventScroll: true });
}

function memberOf(name, buffer, pose = HERE) {
  const { up = [0, 0, 1], cameras = [] } = (window.rigcal?.clouds ?? []).find((one) => one.lidar === name) ?? {};
  return { name, cloud: readPoints(buffer), up, cameras, pose };
}

function chooseFile(place, name, address) {
  const field = element("input", { type: "file", accept: ".bin" });
  const label = element("label", { className: "filter" }, `To see ${name} in 3D choose the file ${address} (a page from disk may not read it by itself): `, field);
  const showChosen = async ([file]) => show(place, [memberOf(name, await file.arrayBuffer())]);
  field.addEventListener("change", () => field.files.length && attempt(place, () => showChosen(field.files)));
  place.append(label);
}

// After an error all is as before, for another attempt, with the error below it.
async function attempt(place, work) {
  const before = [...place.children].filter((child) => !child.matches("[role=alert]"));
  try {
    await work();
  } catch (error) {
    const told = element("p", { className: "hint", textContent: error.message });
    told.setAttribute("role", "alert");
    place.replaceChildren(...before, told);
  }
}

async function pointsFrom(address) {
  const reply = await fetch(address);
  if (!reply.ok) throw new Error("The points of this cloud are not stored.");
  return reply.arrayBuffer();
}

async function load(place, lidars) {
  place.replaceChildren(element("p", { className: "hint", textContent: "Loading the points \u2026" }));
  show(place, await Promise.all(lidars.map(async ({ name, address, pose }) => memberOf(name, await pointsFrom(address), pose))));
}

// Those whose poses are known.
function showAll(heading, lidars) {
  const sensors = new Map((window.rigcal?.sensors ?? []).map((sensor) => [sensor.id, sensor]));
  const known = lidars.flatMap((lidar) => (sensors.get(lidar.name)?.p ? [{ ...lidar, pose: sensors.get(lidar.name) }] : []));
  if (known.length < 2) return;
  const place = element("div", { className: "cloud" });
  place.append(button(`Open all ${known.length} lidars in one scene`, () => attempt(place, () => load(place, known))));
  heading.after(place);
}

export function showClouds() {
  const links = [...document.querySelectorAll('a[href^="cloud/"][href$="/cloud.ply"]')], lidars = [];
  for (const link of links) {
    const folder = link.getAttribute("href").replace(/cloud\.ply$/, "");
    const name = decodeURIComponent(folder.split("/")[1]), address = folder + "points.bin";
    const place = element("div", { className: "cloud" });
    lidars.push({ name, address });
    link.closest("p").before(place);
    if (!hasWebGl()) continue;
    if (location.protocol === "file:") chooseFile(place, name, address);
    else place.append(button(`Open ${name} in 3D`, () => attempt(place, () => load(place, [{ name, address }]))));
  }
  if (links.length > 1 && hasWebGl() && location.protocol !== "file:") showAll(links[0].closest(".card").querySelector("h2"), lidars);
  compareOverlays();
}
