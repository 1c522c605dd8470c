// Asks for the document every 300 ms and draws what changed in it. Texts are set as text: names come from people.
(() => {
  "use strict";
  const NS = "http://www.w3.org/2000/svg";
  const byId = (id) => document.getElementById(id);
  const degrees = (rad) => Math.round((rad * 180) / Math.PI);

  function element(name, attributes = {}, ...children) {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...children);
    return made;
  }

  function drawing(width, height, label) {
    const svg = document.createElementNS(NS, "svg");
    svg.setAttribute("viewBox", `-0.5 -0.5 ${width} ${height}`);
    svg.setAttribute("role", "img");
    svg.setAttribute("aria-label", label);
    return svg;
  }

  function shape(svg, name, attributes, text) {
    const made = document.createElementNS(NS, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== undefined) made.textContent = text;
    svg.append(made);
    return made;
  }

  const listed = (points) => points.map((point) => point.join(",")).join(" ");

  // The newest picture with the corners that were found in it.
  function pictureOf(sensor) {
    const picture = sensor.picture;
    if (!picture || !picture.width_px) return element("p", { class: "soft" }, picture ? picture.why_not : "no picture yet");
    const found = picture.corners_px.length > 0;
    const svg = drawing(picture.width_px, picture.height_px, `${sensor.id}, capture ${picture.capture}: board ${found ? "found" : "not found"}`);
    shape(svg, "image", { href: "/pictures/" + picture.path.split("/").map(encodeURIComponent).join("/"), x: -0.5, y: -0.5, width: picture.width_px, height: picture.height_px });
    const size = picture.width_px / 160;
    for (const [u, v] of picture.corners_px) shape(svg, "circle", { class: "corner", cx: u, cy: v, r: size, "stroke-width": size / 2 });
    return svg;
  }

  function coverageOf(sensor) {
    const { columns, corners } = sensor.coverage;
    if (!columns) return element("span");
    const rows = corners.length / columns;
    const svg = drawing(columns, rows, `${Math.round(100 * sensor.coverage.share_ratio)} % of the picture had the board`);
    corners.forEach((count, at) => {
      if (count > 0) shape(svg, "rect", { class: "field", x: (at % columns) - 0.5, y: Math.floor(at / columns) - 0.5, width: 0.95, height: 0.95 });
    });
    return svg;
  }

  // A quarter is filled as far as the board was tilted to that side, up to 45 degrees.
  function tiltsOf(sensor) {
    const tilts = ["left", "right", "up", "down"].map((side) => `${degrees(sensor.tilts[side].largest_rad)} ${side}`).join(", ");
    const svg = drawing(100, 100, "tilted by degrees: " + tilts);
    shape(svg, "circle", { class: "view", cx: 49.5, cy: 49.5, r: 45, "stroke-width": 2 });
    const sides = { left: [-1, 0], right: [1, 0], up: [0, -1], down: [0, 1] };
    for (const [side, [x, y]] of Object.entries(sides)) {
      const reach = 45 * Math.min(1, sensor.tilts[side].largest_rad / (Math.PI / 4));
      const ends = [[49.5 + reach * (x - 0.6 * y), 49.5 + reach * (y - 0.6 * x)], [49.5 + reach * (x + 0.6 * y), 49.5 + reach * (y + 0.6 * x)]];
      shape(svg, "polygon", { class: "field", points: listed([[49.5, 49.5], ...ends]) });
    }
    return svg;
  }

  function sigmaOf(sensor) {
    if (sensor.is_known === false) return "not known yet";
    const mm = 1000 * Math.max(...sensor.sigma_m), deg = (180 / Math.PI) * Math.max(...sensor.sigma_rad);
    return mm === 0 ? "reference" : `${mm.toFixed(1)} mm, ${deg.toFixed(2)} deg`;
  }

  function rowsOf(sensor) {
    const rows = [["files", `${sensor.files}` + (sensor.missing.length ? `, missing ${sensor.missing.slice(-6).join(" ")}` : "")]];
    if (sensor.type === "camera") {
      rows.push(["board found in", `${sensor.board_in.length} of ${sensor.board_in.length + sensor.board_not_in.length}`]);
      const away = sensor.board_widths_away;
      rows.push(["distance", away ? `${away[0].toFixed(1)} to ${away[1].toFixed(1)} board widths` : "-"]);
      rows.push(["sharpness", sensor.edge_px === null ? "-" : `edges ${sensor.edge_px.toFixed(1)} px` + (sensor.blurred.length ? `, blurred ${sensor.blurred.slice(-6).join(" ")}` : "")]);
      rows.push(["sigma so far", sigmaOf(sensor)]);
    }
    const list = element("dl", { class: "rows" });
    for (const [name, text] of rows) list.append(element("dt", {}, name), element("dd", {}, text));
    if (sensor.of_tolerance_ratio <= 1 && sensor.tied_by_captures > 0) list.lastChild.classList.add("within");
    return list;
  }

  function cardOf(sensor) {
    const card = element("article", { class: "card", "data-sensor": sensor.id }, element("h3", {}, sensor.id));
    if (sensor.type === "camera") card.append(pictureOf(sensor), element("div", { class: "small" }, coverageOf(sensor), tiltsOf(sensor)));
    card.append(rowsOf(sensor));
    return card;
  }

  function fromAbove(above, camera) {
    const points = [...above.board_m, ...above.cameras.flatMap((one) => one.view_m)];
    const least = [0, 1].map((axis) => Math.min(...points.map((point) => point[axis])));
    const most = [0, 1].map((axis) => Math.max(...points.map((point) => point[axis])));
    const scale = 300 / Math.max(most[0] - least[0], most[1] - least[1], 0.5);
    // Ahead of the reference camera is up.
    const place = ([x, z]) => [40 + scale * (x - least[0]), 30 + scale * (most[1] - z)];
    const svg = drawing(80 + scale * (most[0] - least[0]), 60 + scale * (most[1] - least[1]), "the rig and the board from above");
    for (const one of above.cameras) {
      const [at, ...ends] = one.view_m.map(place);
      for (const end of ends) shape(svg, "line", { class: "view", x1: at[0], y1: at[1], x2: end[0], y2: end[1], "stroke-width": one.id === camera ? 4 : 1.5 });
    }
    shape(svg, "polygon", { class: "outline", points: listed(above.board_m.map(place)), "stroke-width": 4 });
    return svg;
  }

  function showNext(next) {
    byId("next").hidden = !next;
    if (!next) return;
    const grid = element("div", { class: "grid" });
    for (const look of next.seen_by) {
      const svg = drawing(look.width_px, look.height_px, `where ${look.id} will see the board`);
      shape(svg, "polygon", { class: "outline", points: listed(look.outline_px), "stroke-width": look.width_px / 120 });
      grid.append(element("article", { class: "card", "data-look": look.id }, element("h3", {}, "in the picture of " + look.id), svg));
    }
    grid.append(element("article", { class: "card" }, element("h3", {}, "from above"), fromAbove(next.from_above, next.camera)));
    byId("placement").replaceChildren(grid);
  }

  let captures = null;
  function beep() {
    if (!byId("sound").checked || !window.AudioContext) return;
    const audio = new AudioContext();
    const tone = audio.createOscillator();
    tone.connect(audio.destination);
    tone.start();
    tone.stop(audio.currentTime + 0.12);
    tone.onended = () => audio.close();
  }

  function show(told) {
    byId("robot").textContent = told.robot || "Capture companion";
    byId("count").textContent = `${told.captures.length} ${told.captures.length === 1 ? "capture" : "captures"}` + (told.looking ? ", looking at more" : "");
    byId("headline").textContent = told.headline;
    byId("advice").dataset.state = told.enough ? "enough" : told.looking ? "looking" : "more";
    showNext(told.next);
    const grid = element("div", { class: "grid" });
    grid.append(...told.sensors.map(cardOf));
    byId("sensors").replaceChildren(grid);
    byId("notes").hidden = told.remarks.length === 0;
    byId("remarks").replaceChildren(...told.remarks.map((text) => element("li", {}, text)));
    if (captures !== null && told.captures.length > captures) beep();
    captures = told.captures.length;
  }

  let last = "";
  async function ask() {
    try {
      const reply = await fetch("/api/v1/companion");
      const text = await reply.text();
      byId("lost").hidden = true;
      if (text !== last) show(JSON.parse(text));
      last = text;
    } catch {
      byId("lost").hidden = false;
    }
    setTimeout(ask, 300);
  }
  ask();
})();
