// The coloured cloud, to be turned by hand. Its points are fetched when asked for; a page from disk may not fetch, there the
// file is chosen by hand.
import { BufferGeometry, GLSL3, IntType, InterleavedBuffer, InterleavedBufferAttribute, Points, RawShaderMaterial, Vector3 } from "three";
import { Box3, View, hasWebGl } from "./scene.js";
import { button, choice, element, number, slider } from "./panel.js";
import { compareOverlays } from "./overlay.js";

const HEADER_BYTES = 28, RECORD_BYTES = 12;
export const MODES = [["color", "Cameras' colours"], ["camera", "Which camera"], ["depth", "Distance"], ["intensity", "Intensity"], ["uncovered", "Seen by no camera"]];

// {count, origin, step, shorts, bytes} of a points.bin; throws a sentence for anything else.
export function readPoints(buffer) {
  const view = new DataView(buffer);
  if (buffer.byteLength < HEADER_BYTES || view.getUint32(0) !== 0x52434c44 || view.getUint32(4, true) !== 1)
    throw new Error("This is no cloud that this page can show.");
  const count = view.getUint32(8, true);
  if (buffer.byteLength !== HEADER_BYTES + count * RECORD_BYTES) throw new Error("The file of points is not complete.");
  const float = (at) => view.getFloat32(at, true);
  return {
    count, origin: [float(12), float(16), float(20)], step: float(24),
    shorts: new Int16Array(buffer, HEADER_BYTES, count * 6), bytes: new Uint8Array(buffer, HEADER_BYTES, count * RECORD_BYTES),
  };
}

// A record as the graphics memory likes it: four whole shorts (x, y, z, and red with green), four whole bytes (blue, camera,
// intensity, nothing). Other groupings would be converted on the processor first.
const VERTEX = `
precision highp float;
uniform mat4 modelMatrix, viewMatrix, projectionMatrix;
uniform float size, far;
uniform int mode;
uniform vec3 sensor;
in ivec4 position;
in vec4 tail;
out vec3 shown;
vec3 ramp(float t) { return clamp(vec3(1.5 - abs(4.0 * t - 3.0), 1.5 - abs(4.0 * t - 2.0), 1.5 - abs(4.0 * t - 1.0)), 0.0, 1.0); }
vec3 wheel(float k) { return 0.55 + 0.45 * cos(6.2831853 * (k * 0.381966 + vec3(0.0, 0.33, 0.67))); }
void main() {
  float camera = tail.y * 255.0;
  bool covered = camera < 254.5;
  vec3 meters = (modelMatrix * vec4(vec3(position.xyz), 1.0)).xyz;
  if (mode == 0) shown = vec3(float(position.w & 255) / 255.0, float((position.w >> 8) & 255) / 255.0, tail.x);
  else if (mode == 1) shown = covered ? wheel(camera) : vec3(0.45);
  else if (mode == 2) shown = ramp(1.0 - clamp(length(meters - sensor) / far, 0.0, 1.0));
  else if (mode == 3) shown = vec3(0.1 + 0.9 * tail.z);
  else shown = covered ? vec3(0.42) : vec3(1.0, 0.35, 0.2);
  gl_Position = projectionMatrix * viewMatrix * vec4(meters, 1.0);
  gl_PointSize = size;
}`;
const FRAGMENT = "precision mediump float;\nin vec3 shown;\nout vec4 color;\nvoid main() { color = vec4(shown, 1.0); }";

// Where nearly all points are: a few far ones must not make the rest small.
function boxOf({ count, shorts, origin, step }) {
  const jump = Math.max(1, Math.floor(count / 20000));
  const box = new Box3();
  const sorted = [0, 1, 2].map((axis) => {
    const values = [];
    for (let index = 0; index < count; index += jump) values.push(origin[axis] + step * shorts[index * 6 + axis]);
    return values.sort((a, b) => a - b);
  });
  const part = (ratio) => new Vector3(...sorted.map((values) => values[Math.floor((values.length - 1) * ratio)]));
  return box.set(part(0.05), part(0.95));
}

function pointsOf(cloud, box) {
  const geometry = new BufferGeometry();
  const shorts = new InterleavedBuffer(cloud.shorts, 6), bytes = new InterleavedBuffer(cloud.bytes, RECORD_BYTES);
  const places = new InterleavedBufferAttribute(shorts, 4, 0, false);
  places.gpuType = IntType;
  geometry.setAttribute("position", places);
  geometry.setAttribute("tail", new InterleavedBufferAttribute(bytes, 4, 8, true));
  const far = Math.max(box.min.length(), box.max.length());
  const material = new RawShaderMaterial({
    glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT,
    uniforms: { size: { value: 2 }, mode: { value: 0 }, far: { value: far }, sensor: { value: new Vector3() } },
  });
  const points = new Points(geometry, material);
  points.frustumCulled = false;
  points.scale.setScalar(cloud.step);
  points.position.set(...cloud.origin);
  return points;
}

function show(place, name, buffer) {
  const cloud = readPoints(buffer);
  if (!cloud.count) throw new Error("The cloud holds no point.");
  const frame = element("div", { className: "view" }), bar = element("div", { className: "bar" });
  place.replaceChildren(frame, bar);
  const box = boxOf(cloud), points = pointsOf(cloud, box), view = new View(frame, "z", false);
  view.canvas.setAttribute("aria-label", `Coloured cloud of ${name}: ${cloud.count} points. Arrow keys turn it, plus and minus zoom.`);
  view.scene.add(points);
  for (const [key, text] of [["oblique", "All"], ["front", "Front"], ["top", "Top"], ["side", "Side"]]) bar.append(button(text, () => view.look(key)));
  bar.append(choice("Colour", MODES, (mode) => {
    points.material.uniforms.mode.value = MODES.findIndex(([key]) => key === mode);
    view.request();
  }));
  bar.append(slider("Point size", { min: 1, max: 8, step: 0.5, value: 2 }, (size) => {
    points.material.uniforms.size.value = size * view.renderer.getPixelRatio();
    view.request();
    return `${size} px`;
  }));
  bar.append(element("span", { className: "soft", textContent: `${number(cloud.count / 1e6, 3)} million points` }));
  view.resize();
  view.fit(box);
}

function chooseFile(place, name, address) {
  const field = element("input", { type: "file", accept: ".bin" });
  const label = element("label", { className: "filter" }, `A page from disk may not read files by itself. Choose ${address} to turn the cloud: `, field);
  field.addEventListener("change", async () => attempt(place, async () => show(place, name, await field.files[0].arrayBuffer())));
  place.append(label);
}

async function attempt(place, work) {
  try {
    await work();
  } catch (error) {
    place.replaceChildren(element("p", { className: "hint", textContent: error.message }));
  }
}

async function load(place, name, address) {
  place.replaceChildren(element("p", { className: "hint", textContent: "Loading the points \u2026" }));
  const reply = await fetch(address);
  if (!reply.ok) throw new Error("The points of this cloud are not stored.");
  show(place, name, await reply.arrayBuffer());
}

export function showClouds() {
  for (const link of document.querySelectorAll('a[href^="cloud/"][href$="/cloud.ply"]')) {
    const folder = link.getAttribute("href").replace(/cloud\.ply$/, "");
    const name = decodeURIComponent(folder.split("/")[1]), address = folder + "points.bin";
    const place = element("div", { className: "cloud" });
    link.closest("p").before(place);
    if (!hasWebGl()) continue;
    if (location.protocol === "file:") chooseFile(place, name, address);
    else place.append(button(`Turn the cloud of ${name}`, () => attempt(place, () => load(place, name, address))));
  }
  compareOverlays();
}
