// Does something to a place of the page once it comes into view. What is printed is drawn as well, seen or not, as far as its
// section is open.
import { beforePaper } from "./paper.js";

export function whenSeen(places, action) {
  const waiting = new Set(places);
  const act = (place) => {
    if (!waiting.delete(place)) return;
    observer.unobserve(place);
    action(place);
  };
  const observer = new IntersectionObserver((entries) => {
    for (const entry of entries) if (entry.isIntersecting) act(entry.target);
  }, { rootMargin: "300px" });
  for (const place of places) observer.observe(place);
  beforePaper(() => [...waiting].filter((place) => !place.closest("details:not([open])")).forEach(act));
}
