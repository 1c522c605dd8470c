// A canvas with a camera to turn around a thing. Draws only when something changed.
import { Box3, GridHelper, PerspectiveCamera, Scene, Sphere, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { pageColor } from "./colors.js";

export function hasWebGl() {
  try {
    return Boolean(document.createElement("canvas").getContext("webgl2"));
  } catch {
    return false;
  }
}

const DIRECTIONS = { oblique: [0.55, -0.6, -0.75], front: [0, 0, -1], top: [0, -1, -0.001], side: [1, 0, 0] };
const Z_UP = { oblique: [-0.75, -0.75, 0.55], front: [-1, 0, 0], top: [-0.001, 0, 1], side: [0, -1, 0] };

export class View {
  // `up`: "-y" where the reference is a camera (y down), else "z". Millions of points need no antialiasing.
  constructor(place, up, antialias = true) {
    this.place = place;
    this.up = up;
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(38, 1, 0.001, 1000);
    this.camera.up.set(...(up === "z" ? [0, 0, 1] : [0, -1, 0]));
    this.renderer = new WebGLRenderer({ antialias, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    place.append(canvas);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.request());
    canvas.addEventListener("keydown", (event) => this.onKey(event));
    new ResizeObserver(() => this.resize()).observe(place);
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.recolor());
    this.recolor();
  }

  get canvas() {
    return this.renderer.domElement;
  }

  recolor() {
    this.renderer.setClearColor(pageColor("view", "#eef2f6"));
    this.request();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.request();
  }

  request() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  draw() {
    this.renderer.render(this.scene, this.camera);
    this.place.dataset.frames = String(Number(this.place.dataset.frames ?? 0) + 1);
  }

  // Sets the distances for things in `box` and looks at all of it.
  fit(box) {
    const sphere = box.getBoundingSphere(new Sphere());
    this.center = sphere.center;
    this.radius = Math.max(sphere.radius, 1e-6);
    this.camera.near = this.radius / 200;
    this.camera.far = this.radius * 200;
    this.look("oblique");
  }

  look(name) {
    const direction = new Vector3(...(this.up === "z" ? Z_UP : DIRECTIONS)[name]).normalize();
    const halfHeight_rad = (this.camera.fov * Math.PI) / 360;
    const halfWidth_rad = Math.atan(Math.tan(halfHeight_rad) * this.camera.aspect);
    const distance = (this.radius / Math.sin(Math.min(halfHeight_rad, halfWidth_rad))) * 0.92;
    this.controls.target.copy(this.center);
    this.camera.position.copy(this.center).addScaledVector(direction, distance);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.request();
  }

  addGrid(size, height) {
    const step = 10 ** Math.round(Math.log10(Math.max(size, 1e-3) / 4));
    const lines = Math.max(4, 2 * Math.ceil(size / step));
    const grid = new GridHelper(lines * step, lines, pageColor("soft"), pageColor("line"));
    grid.material.transparent = true;
    grid.material.opacity = 0.5;
    if (this.up === "z") grid.rotateX(Math.PI / 2);
    grid.position.set(...height);
    this.scene.add(grid);
    return step;
  }

  onKey(event) {
    const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const zooms = { "+": 0.85, "=": 0.85, "-": 1 / 0.85 };
    const turn = turns[event.key], zoom = zooms[event.key];
    if (!turn && !zoom) return;
    event.preventDefault();
    const offset = this.camera.position.clone().sub(this.controls.target);
    if (turn) {
      offset.applyAxisAngle(this.camera.up, turn[0] * 0.1);
      const side = this.camera.up.clone().cross(offset).normalize();
      const tilted = offset.clone().applyAxisAngle(side, turn[1] * 0.1);
      if (Math.abs(tilted.clone().normalize().dot(this.camera.up)) < 0.995) offset.copy(tilted);
    } else {
      offset.multiplyScalar(zoom);
    }
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.request();
  }
}

export { Box3, Vector3 };
