// The numbers of the edge or sensor that the pointer or the keyboard is at, in a line below the graph. Thin edges get room
// to be hit.
const SVG = "http://www.w3.org/2000/svg";
const MANY = 400;  // edges: more are not given room, they lie side by side anyway

function widen(link) {
  const room = document.createElementNS(SVG, "path");
  room.setAttribute("class", "room");
  room.setAttribute("d", link.getAttribute("d"));
  link.before(room);
}

export function readGraph(graph) {
  if (!graph) return;
  const links = [...graph.querySelectorAll("a > .link")];
  if (links.length <= MANY) links.forEach(widen);
  const line = document.createElement("p");
  line.className = "readout";
  line.setAttribute("role", "status");
  graph.after(line);
  const point = links.length ? "Point at an edge, or step through the edges with Tab," : "Point at an edge";
  const way = matchMedia("(hover: none)").matches ? "Touch an edge" : point;
  const rest = graph.querySelector(".link") ? way + " to read its numbers." : "";
  line.textContent = rest;
  const titleOf = (target) => {
    const shape = target.closest("a") ?? target.closest(".link, .node, .trace");
    return shape?.querySelector("title")?.textContent ?? "";
  };
  const show = (event) => { line.textContent = titleOf(event.target) || rest; };
  for (const name of ["pointerover", "focusin"]) graph.addEventListener(name, show);
  // A finger that is lifted leaves: its numbers stay to be read.
  const end = (event) => { if (event.pointerType !== "touch") line.textContent = rest; };
  for (const name of ["pointerleave", "focusout"]) graph.addEventListener(name, end);
}
