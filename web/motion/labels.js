// Names beside what they name, as text over the picture; where two would cover each other, the second one is left out.

import { Vector3 } from "three";

// items: [{name, at: [pose, x, y, z], kind: "body" or "joint", color}]
export function createLabels(element, items, track, camera) {
  const layer = document.createElement("div");
  layer.className = "names";
  layer.setAttribute("aria-hidden", "true");
  element.append(layer);
  const place = new Float64Array(3);
  const point = new Vector3();
  const boxes = new Float64Array(4 * items.length); // left, top, width, height
  const spans = items.map(({ name, kind, color }) => {
    const span = document.createElement("span");
    span.className = kind;
    span.dataset.component = name;
    if (color) span.style.color = `color-mix(in srgb, ${color} 75%, var(--ink))`;
    span.textContent = name;
    layer.append(span);
    return span;
  });
  let isMeasured = false;

  function isFree(i) {
    for (let k = 0; k < i; k++) {
      if (spans[k].hidden) continue;
      if (
        boxes[4 * i] < boxes[4 * k] + boxes[4 * k + 2] &&
        boxes[4 * k] < boxes[4 * i] + boxes[4 * i + 2] &&
        boxes[4 * i + 1] < boxes[4 * k + 1] + boxes[4 * k + 3] &&
        boxes[4 * k + 1] < boxes[4 * i + 1] + boxes[4 * i + 3]
      )
        return false;
    }
    return true;
  }

  function measure() {
    spans.forEach((span, i) => {
      span.hidden = false;
      boxes[4 * i + 2] = span.offsetWidth;
      boxes[4 * i + 3] = span.offsetHeight;
    });
    isMeasured = true;
  }

  return {
    layer,
    draw(width, height) {
      if (layer.hidden) return;
      if (!isMeasured) measure();
      items.forEach(({ at }, i) => {
        track.locate(at, place);
        point.set(place[0], place[1], place[2]).project(camera);
        boxes[4 * i] = ((point.x + 1) / 2) * width + 9;
        boxes[4 * i + 1] = ((1 - point.y) / 2) * height - boxes[4 * i + 3] - 5;
        spans[i].hidden = !isFree(i);
        spans[i].style.transform = `translate(${boxes[4 * i]}px, ${boxes[4 * i + 1]}px)`;
      });
    },
  };
}
