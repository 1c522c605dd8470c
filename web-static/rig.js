// The rig in 3D: sensors where they are, how sure that is, where they were meant to be and where they were before.
import { Group, Raycaster, Vector2 } from "three";
import { Box3, Vector3, View, hasWebGl } from "./rig/scene.js";
import { makeGhost, makeSensor, paint, poseMatrix, reachOf, scaleEllipsoid } from "./rig/sensor_shapes.js";
import { button, choice, element, number, showSensor, slider, toggle } from "./rig/panel.js";
import { Labels } from "./rig/labels.js";
import { showClouds } from "./rig/cloud_view.js";

const GHOSTS = [["nominal", "Nominal poses", "ghost"], ["previous", "Last revision", "second"]];

function boxOf(sensors) {
  const box = new Box3();
  for (const sensor of sensors) box.expandByPoint(new Vector3(...sensor.p));
  const size = Math.max(box.getSize(new Vector3()).length(), 0.05);
  return { box: box.expandByScalar(size * 0.1), size };
}

// A round number of times, such that the largest ellipsoid is a tenth of the rig.
function startScale(sensors, size) {
  const largest = Math.max(...sensors.map((sensor) => (sensor.sigma ? Math.max(...sensor.sigma.slice(0, 3)) : 0)));
  if (!(largest > 0)) return 1;
  const exact = ((sensors.length > 40 ? 0.03 : 0.1) * size) / largest;
  const decade = 10 ** Math.floor(Math.log10(exact));
  return Math.max(1, [5, 2, 1].map((step) => step * decade).find((step) => step <= exact) ?? decade);
}

const NAMED_MAX = 60;  // sensors; of more only the chosen one shows its name

function addGhosts(view, sensors, size, bar) {
  for (const [key, name, color] of GHOSTS) {
    const moved = sensors.filter((sensor) => sensor[key]);
    if (!moved.length) continue;
    const group = new Group();
    for (const sensor of moved) group.add(makeGhost(sensor, sensor[key], size * 0.8, color));
    view.scene.add(group);
    const box = toggle(name, true, (shown) => {
      group.visible = shown;
      view.request();
    });
    box.classList.add("key", color);
    bar.append(box);
  }
}

function addPicking(view, shapes, select) {
  const ray = new Raycaster(), pointer = new Vector2();
  let start = null;
  view.canvas.addEventListener("pointerdown", (event) => { start = [event.clientX, event.clientY]; });
  view.canvas.addEventListener("pointerup", (event) => {
    if (!start || Math.hypot(event.clientX - start[0], event.clientY - start[1]) > 5) return;
    const bounds = view.canvas.getBoundingClientRect();
    pointer.set(((event.clientX - bounds.left) / bounds.width) * 2 - 1, 1 - ((event.clientY - bounds.top) / bounds.height) * 2);
    ray.setFromCamera(pointer, view.camera);
    const hit = ray.intersectObjects(shapes.map((shape) => shape.target))[0];
    if (hit) select(hit.object.userData.sensor);
  });
}

function addScale(view, shapes, sensors, size, bar) {
  const blobs = shapes.map((shape) => shape.blob).filter(Boolean);
  if (!blobs.length) return;
  const update = (exponent) => {
    const scale = 10 ** exponent;
    for (const blob of blobs) scaleEllipsoid(blob, scale);
    view.request();
    return `${number(scale, 2)} \u00d7 \u03c3`;
  };
  bar.append(slider("Uncertainty, drawn", { min: 0, max: 5, step: 0.05, value: Math.log10(startScale(sensors, size)) }, update));
}

function showRig(section, data) {
  const sensors = data.sensors.filter((sensor) => sensor.p);
  const place = section.querySelector(".view"), panel = section.querySelector(".panel"), bar = section.querySelector(".bar");
  const { box, size } = boxOf(sensors);
  const reference = sensors.find((sensor) => sensor.reference), accused = data.culprits ?? [];
  const view = new View(place, reference?.kind === "camera" ? "-y" : "z");
  view.canvas.setAttribute("aria-label", `The rig in 3D: ${sensors.length} sensors. Arrow keys turn it, plus and minus zoom. The table of sensors has the same numbers.`);
  const shapeSize = size * (sensors.length > 40 ? 0.03 : 0.11);
  const shapes = sensors.map((sensor) => makeSensor(sensor, shapeSize));
  for (const shape of shapes) view.scene.add(shape.group);
  const floor = view.up === "z" ? [0, 0, box.min.z] : [0, box.max.y, 0];
  const step = view.addGrid(size, floor);
  const list = choice("Sensor", sensors.map((sensor) => [sensor.id, sensor.id]), (id) => select(id));
  let shownId = "";
  const importance = (id) => (id === shownId ? 2 : id === reference?.id ? 1 : sensors.length <= NAMED_MAX ? 0 : -1);
  const labels = new Labels(place, sensors.map((sensor) => ({ id: sensor.id, at: sensor.p })), importance);
  view.afterDraw = () => labels.layOut(view.camera, { width: place.clientWidth, height: place.clientHeight });
  const select = (id) => {
    const chosen = sensors.findIndex((sensor) => sensor.id === id);
    shapes.forEach((shape, index) => paint(shape.outline, index === chosen || accused.includes(sensors[index].id) ? "select" : sensors[index].reference ? "accent" : "text"));
    shownId = id;
    labels.select(id);
    list.field.value = id;
    showSensor(panel, sensors[chosen]);
    view.request();
  };
  for (const [key, name] of [["oblique", "All"], ["front", "Front"], ["top", "Top"], ["side", "Side"]])
    bar.append(button(name, () => view.look(key)));
  bar.append(list);
  addScale(view, shapes, sensors, size, bar);
  addGhosts(view, sensors, shapeSize, bar);
  bar.append(element("span", { className: "soft axes" }, "axes: ", ...["x", "y", "z"].map((axis) => element("span", { className: "key axis-" + axis, textContent: axis }))));
  bar.append(element("span", { className: "soft", textContent: `grid: ${step < 1 ? number(step * 100) + " cm" : number(step) + " m"}` }));
  addPicking(view, shapes, select);
  view.resize();
  view.fit(box, sensors.flatMap((sensor) => reachOf(sensor, shapeSize)));
  const culprits = sensors.filter((sensor) => accused.includes(sensor.id)), others = culprits.length ? culprits : sensors;
  select((others.find((sensor) => !sensor.reference) ?? others[0]).id);
  if (accused.length && !culprits.length)
    panel.prepend(element("p", { className: "hint" }, element("bdi", { textContent: accused[0] }), " is not drawn: not all of its pose is known."));
}

const section = document.getElementById("rig");
if (section && window.rigcal?.sensors.some((sensor) => sensor.p) && hasWebGl()) {
  section.hidden = false;
  showRig(section, window.rigcal);
  document.dispatchEvent(new Event("rigcal:parts"));
}
showClouds();
export { poseMatrix };
