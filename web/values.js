// The number of each term at the clock: elements of class `value` in section `equations`, in the order of the terms.
import { formatNumber } from "./numbers.js";
import { locate, valueAt } from "./packed.js";

export function showValues(document, terms, [times], samples, clock) {
  const shown = [...document.querySelectorAll("#equations math .value")].map((element, i) => ({
    element,
    column: samples[i],
    text: element.firstChild ?? element.appendChild(document.createTextNode("")),
  }));
  const visible = new Set();
  const byElement = new Map(shown.map((item) => [item.element, item]));

  function show(item, place) {
    if (item.column) item.text.nodeValue = formatNumber(valueAt(item.column, place));
  }
  // only what is on the screen while the clock runs
  const observer = new IntersectionObserver((entries) => {
    const place = locate(times, clock.time);
    for (const { target, isIntersecting } of entries) {
      const item = byElement.get(target);
      if (isIntersecting) {
        visible.add(item);
        show(item, place);
      } else visible.delete(item);
    }
  });
  for (const { element } of shown) observer.observe(element);
  clock.subscribe((t) => {
    const place = locate(times, t);
    for (const item of clock.playing ? visible : shown) show(item, place);
  });
}
