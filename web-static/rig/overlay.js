// A camera's picture and the cloud in it, one above the other, with a slider between them.
import { element } from "./panel.js";

export function compareOverlays() {
  for (const image of document.querySelectorAll('img[src^="overlay/"]')) {
    const figure = image.closest("figure");
    const plain = figure?.querySelector('figcaption a[href$="_picture.jpg"]');
    if (!plain) continue;
    const stack = element("span", { className: "overlay" });
    const picture = element("img", { src: plain.getAttribute("href"), alt: "", loading: "lazy" });
    if (image.getAttribute("width")) [picture.width, picture.height] = [image.getAttribute("width"), image.getAttribute("height")];
    image.before(stack);
    stack.append(picture, image);
    const field = element("input", { type: "range", min: 0, max: 100, value: 70 });
    field.setAttribute("aria-label", "How much of the cloud is shown over the picture: " + image.alt);
    const update = () => {
      image.style.opacity = String(field.value / 100);
      field.setAttribute("aria-valuetext", `${field.value} % cloud`);
    };
    field.addEventListener("input", update);
    update();
    (stack.closest("a") ?? stack).after(element("label", { className: "blend" }, "picture ", field, " cloud"));
  }
}
