// One sensor as shapes: axes, camera frustum, name, uncertainty ellipsoid, and ghosts of other poses of it.
import {
  BufferGeometry, DoubleSide, Float32BufferAttribute, Group, LineBasicMaterial, LineDashedMaterial,
  LineSegments, Matrix4, Mesh, MeshBasicMaterial, Quaternion, SphereGeometry, Vector3,
} from "three";
import { pageColor } from "./colors.js";

const AXIS_NAMES = ["axis-x", "axis-y", "axis-z"];

export function poseMatrix(pose) {
  return new Matrix4().compose(new Vector3(...pose.p), new Quaternion(...pose.q), new Vector3(1, 1, 1));
}

// A colour of the page by its name: the view takes it anew when the page's colours change.
export function paint(material, name) {
  material.userData.pageColor = name;
  material.color.copy(pageColor(name));
  return material;
}

function segments(points, material) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(points.flat(), 3));
  return new LineSegments(geometry, material);
}

function axes(size, ghost) {
  const group = new Group();
  AXIS_NAMES.forEach((name, axis) => {
    const end = [0, 0, 0];
    end[axis] = size;
    const material = paint(new LineBasicMaterial({ transparent: true, opacity: ghost ? 0.35 : 1 }), name);
    group.add(segments([[0, 0, 0], end], material));
  });
  return group;
}

// The picture's edges at `depth`, by half its width and height over the focal length: z looks ahead, y down.
function frustum(half, depth, material) {
  const [w, h] = [half[0] * depth, half[1] * depth];
  const corners = [[-w, -h, depth], [w, -h, depth], [w, h, depth], [-w, h, depth]];
  const points = [];
  corners.forEach((corner, index) => points.push([0, 0, 0], corner, corner, corners[(index + 1) % 4]));
  return segments(points, material);
}

// A lidar looks around: a ring, and its mast.
function ring(size, material) {
  const points = [];
  for (let index = 0; index < 24; ++index) {
    for (const turn of [index, index + 1]) points.push([Math.cos((turn * Math.PI) / 12) * size, Math.sin((turn * Math.PI) / 12) * size, 0]);
  }
  return segments([...points, [0, 0, -size / 2], [0, 0, size / 2]], material);
}

function body(sensor, size, material) {
  if (sensor.half) return frustum(sensor.half, size * 1.6, material);
  return sensor.kind === "lidar" ? ring(size * 0.8, material) : ring(size * 0.3, material);
}

// Lower Cholesky factor of a 3 x 3 covariance [xx xy xz yy yz zz]: it takes the unit sphere to the one-sigma ellipsoid.
export function cholesky([xx, xy, xz, yy, yz, zz]) {
  const a = Math.sqrt(Math.max(xx, 0));
  if (!(a > 0)) return null;
  const b = xy / a, c = xz / a;
  const d = Math.sqrt(Math.max(yy - b * b, 1e-6 * yy));
  if (!(d > 0)) return null;
  const e = (yz - b * c) / d;
  const f = Math.sqrt(Math.max(zz - c * c - e * e, 1e-6 * zz));
  return f > 0 ? { a, b, c, d, e, f } : null;
}

function ellipsoid(sensor) {
  const factor = sensor.cov && cholesky(sensor.cov);
  if (!factor) return null;
  const { a, b, c, d, e, f } = factor;
  const material = paint(new MeshBasicMaterial({ transparent: true, opacity: 0.34, side: DoubleSide, depthWrite: false }), "accent");
  const mesh = new Mesh(new SphereGeometry(1, 28, 18), material);
  mesh.userData.shape = new Matrix4().set(a, 0, 0, 0, b, d, 0, 0, c, e, f, 0, 0, 0, 0, 1);
  mesh.matrixAutoUpdate = false;
  return mesh;
}

// Ellipsoids are drawn `scale` times as large as one sigma.
export function scaleEllipsoid(mesh, scale) {
  mesh.matrix.copy(mesh.userData.shape).multiplyScalar(scale).elements[15] = 1;
  mesh.matrixWorldNeedsUpdate = true;
}

// The outermost points of a sensor's shape.
export function reachOf(sensor, size) {
  const [w, h] = sensor.half ?? [0.7, 0.7], depth = size * 1.6;
  const local = sensor.half ? [[0, 0, 0], ...[[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) => [x * w * depth, y * h * depth, depth])]
    : [[size, 0, 0], [-size, 0, 0], [0, size, 0], [0, -size, 0], [0, 0, size], [0, 0, -size]];
  const pose = poseMatrix(sensor);
  return local.map((point) => new Vector3(...point).applyMatrix4(pose));
}

export function makeSensor(sensor, size) {
  const group = new Group();
  group.applyMatrix4(poseMatrix(sensor));
  const outline = paint(new LineBasicMaterial(), sensor.reference ? "accent" : "text");
  group.add(axes(size, false), body(sensor, size, outline));
  const target = new Mesh(new SphereGeometry(size * 0.55, 8, 6), new MeshBasicMaterial({ visible: false }));
  target.userData.sensor = sensor.id;
  const blob = ellipsoid(sensor);
  if (blob) group.add(blob);
  group.add(target);
  return { group, target, blob, outline };
}

// Where else the sensor was, or was meant to be: pale, joined to where it is by a dashed line.
export function makeGhost(sensor, pose, size, colorName) {
  const group = new Group();
  const shape = new Group();
  shape.applyMatrix4(poseMatrix(pose));
  shape.add(axes(size, true), body(sensor, size, paint(new LineBasicMaterial({ transparent: true, opacity: 0.75 }), colorName)));
  const join = segments([sensor.p, pose.p], paint(new LineDashedMaterial({ dashSize: size / 6, gapSize: size / 9 }), colorName));
  join.computeLineDistances();
  group.add(shape, join);
  return group;
}
