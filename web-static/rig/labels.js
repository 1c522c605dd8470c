// Names beside the sensors, in the page's own letters, of one size whatever the distance: where two would cover each other
// the farther one moves aside, with a line to its sensor, or waits until there is room.
import { Vector3 } from "three";
import { element } from "./panel.js";

const SVG = "http://www.w3.org/2000/svg";
const GAP = 3;
// Offsets of a label from its sensor, in its own heights; the first that is free is taken.
const PLACES = [[0, -1.1], [0, 1.1], [0.7, -0.9], [-0.7, -0.9], [0.7, 0.9], [-0.7, 0.9], [0, -2.2], [0, 2.2], [0.9, 0], [-0.9, 0], [0, -3.3], [0, 3.3]];

const overlap = (a, b) => a.x < b.x + b.w + GAP && b.x < a.x + a.w + GAP && a.y < b.y + b.h && b.y < a.y + a.h;

function boxAt(point, label, [right, down], bounds) {
  const { w, h } = label;
  const box = { x: point.x - w / 2 + right * (w / 2 + 10), y: point.y - h / 2 + down * h, w, h };
  return box.x >= 0 && box.y >= 0 && box.x + w <= bounds.width && box.y + h <= bounds.height ? box : null;
}

export class Labels {
  // `items`: {id, at}; `importance(id)`: higher comes first; below zero it is not shown.
  constructor(place, items, importance) {
    this.importance = importance;
    this.lines = document.createElementNS(SVG, "path");
    const drawing = document.createElementNS(SVG, "svg");
    drawing.append(this.lines);
    this.layer = element("div", { className: "labels" }, drawing);
    this.layer.setAttribute("aria-hidden", "true");
    place.append(this.layer);
    this.items = items.map(({ id, at }) => {
      const text = element("span", { textContent: id.length > 28 ? id.slice(0, 27) + "\u2026" : id });
      this.layer.append(text);
      return { id, at: new Vector3(...at), text };
    });
    this.point = new Vector3();
  }

  select(id) {
    for (const item of this.items) item.text.classList.toggle("chosen", item.id === id);
  }

  layOut(camera, bounds) {
    for (const item of this.items) {
      const { x, y, z } = this.point.copy(item.at).project(camera);
      item.screen = { x: ((x + 1) / 2) * bounds.width, y: ((1 - y) / 2) * bounds.height, z };
      if (!item.w) [item.w, item.h] = [item.text.offsetWidth, item.text.offsetHeight];
    }
    const order = [...this.items].sort((a, b) => this.importance(b.id) - this.importance(a.id) || a.screen.z - b.screen.z);
    const taken = [];
    let lines = "";
    for (const item of order) {
      const inView = this.importance(item.id) >= 0 && Math.abs(item.screen.z) <= 1;
      const boxes = inView ? PLACES.map((offset) => boxAt(item.screen, item, offset, bounds)) : [];
      const index = boxes.findIndex((box) => box && !taken.some((other) => overlap(box, other)));
      item.text.style.visibility = index < 0 ? "hidden" : "visible";
      if (index < 0) continue;
      const box = boxes[index];
      taken.push(box);
      item.text.style.transform = `translate(${box.x}px, ${box.y}px)`;
      if (index > 1) lines += `M${item.screen.x} ${item.screen.y}L${box.x + box.w / 2} ${box.y + box.h / 2}`;
    }
    this.lines.setAttribute("d", lines);
  }
}
