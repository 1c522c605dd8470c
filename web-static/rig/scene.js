// A canvas with a camera to turn around a thing. Draws only when something changed.
import { Box3, GridHelper, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { pageColor } from "./colors.js";

export function hasWebGl() {
  try {
    return Boolean(document.createElement("canvas").getContext("webgl2"));
  } catch {
    return false;
  }
}

// From where the views look: ahead is z where y is down (a camera), else x.
const Y_DOWN = { oblique: [0.55, -0.6, -0.75], front: [0, 0, -1], top: [0, -1, -0.001], side: [1, 0, 0] };
const Z_UP = { oblique: [-0.75, -0.75, 0.55], front: [-1, 0, 0], top: [-0.001, 0, 1], side: [0, -1, 0] };

export class View {
  // `up`: "-y" where the reference is a camera (y down), else "z". Millions of points need no antialiasing.
  constructor(place, up, antialias = true, background = "view") {
    this.place = place;
    this.up = up;
    this.background = background;
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
    // Paper waits for nobody: it is drawn at once.
    document.addEventListener("rigcal:colors", () => {
      this.resize();
      this.recolor();
      this.draw();
      this.keepStill(document.documentElement.hasAttribute("data-paper"));
    });
    this.recolor();
  }

  get canvas() {
    return this.renderer.domElement;
  }

  recolor() {
    this.renderer.setClearColor(pageColor(this.background, "#eef2f6"));
    this.scene.traverse(({ material }) => {
      if (material?.userData.pageColor) material.color.copy(pageColor(material.userData.pageColor));
    });
    this.request();
  }

  // Where nothing changed nothing is drawn again: an observer tells of the first size, too.
  resize() {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (!width || !height || (width === this.width && height === this.height)) return;
    [this.width, this.height] = [width, height];
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
    this.afterDraw?.();
    this.place.dataset.frames = String(Number(this.place.dataset.frames ?? 0) + 1);
  }

  // What is printed of a WebGL canvas may be the frame before: paper gets a copy that is no WebGL.
  keepStill(paper) {
    this.still?.remove();
    this.still = null;
    if (!paper || !this.canvas.width || !this.canvas.height) return;
    this.still = document.createElement("canvas");
    this.still.className = "still";
    [this.still.width, this.still.height] = [this.canvas.width, this.canvas.height];
    this.still.getContext("2d", { willReadFrequently: true }).drawImage(this.canvas, 0, 0);
    this.canvas.after(this.still);
  }

  // Sets the distances for things in `box` and looks at all of it: at its corners, or at `points` in it.
  fit(box, points = null) {
    this.center = box.getCenter(new Vector3());
    const radius = Math.max(box.getSize(new Vector3()).length() / 2, 1e-6);
    this.points = points ?? [0, 1, 2, 3, 4, 5, 6, 7].map((bits) => new Vector3(
      bits & 1 ? box.max.x : box.min.x, bits & 2 ? box.max.y : box.min.y, bits & 4 ? box.max.z : box.min.z));
    this.camera.near = radius / 200;
    this.camera.far = radius * 200;
    this.look("oblique");
  }

  // Where to look at, and from how far, so that all points just fit into the picture, seen against `direction`.
  framing(direction) {
    const halfHeight = Math.tan((this.camera.fov * Math.PI) / 360), halfWidth = halfHeight * this.camera.aspect;
    const right = this.camera.up.clone().cross(direction).normalize(), up = direction.clone().cross(right);
    const target = this.center.clone();
    for (const side of [right, up]) {
      const along = this.points.map((point) => point.clone().sub(target).dot(side));
      target.addScaledVector(side, (Math.max(...along) + Math.min(...along)) / 2);
    }
    const distance = Math.max(...this.points.map((point) => {
      const offset = point.clone().sub(target);
      return offset.dot(direction) + Math.max(Math.abs(offset.dot(right)) / halfWidth, Math.abs(offset.dot(up)) / halfHeight);
    }));
    return { target, distance };
  }

  look(name) {
    const direction = new Vector3(...(this.up === "z" ? Z_UP : Y_DOWN)[name]).normalize();
    const { target, distance } = this.framing(direction);
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(direction, distance * 1.08);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.request();
  }

  addGrid(size, height) {
    const step = 10 ** Math.round(Math.log10(Math.max(size, 1e-3) / 4));
    const lines = Math.max(4, 2 * Math.ceil(size / step));
    const grid = new GridHelper(lines * step, lines, "#808a98", "#808a98");
    grid.material.transparent = true;
    grid.material.opacity = 0.3;
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
