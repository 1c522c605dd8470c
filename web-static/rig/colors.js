// Colours of the page, for WebGL.
import { Color } from "three";

export function pageColor(name, fallback = "#5478a8") {
  const text = getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
  return new Color(text || fallback);
}
