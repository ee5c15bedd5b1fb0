// Names beside what they name, as text over the picture; where two would cover each other, the second one is left out.

import { Vector3 } from "three";
import { colorOfBody } from "./colors.js";

// Bodies at the middle of what is held of them, joints where they are.
export function labelledPlaces(data) {
  const middle = ({ held, number, beam }) => {
    if (beam) return [number, beam.length / 2, 0, 0];
    const own = held.filter(([pose]) => pose === number);
    if (!own.length) return [number, 0, 0, 0];
    const sum = own.reduce((s, at) => s.map((v, k) => v + at[k + 1] / own.length), [0, 0, 0]);
    return [number, ...sum];
  };
  const bodies = data.bodies.slice(1).map((body) => ({ name: body.name, at: middle(body), kind: "body", color: colorOfBody(body.number) }));
  const joints = data.joints.map(({ name, from, to }) => ({ name, at: to.body === 0 ? from.at : to.at, kind: "joint" }));
  return [...bodies, ...joints];
}

// items: [{name, at: [pose, x, y, z], kind: "body" or "joint", color}]
export function createLabels(element, items, track, camera) {
  const layer = document.createElement("div");
  layer.className = "names";
  layer.setAttribute("aria-hidden", "true");
  element.append(layer);
  const place = new Float64Array(3);
  const point = new Vector3();
  const boxes = new Float64Array(4 * items.length); // left, top, width, height
  const shown = new Float64Array(2 * items.length).fill(NaN); // where the text stands
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

  function move(i) {
    const [dx, dy] = [boxes[4 * i] - shown[2 * i], boxes[4 * i + 1] - shown[2 * i + 1]];
    if (Math.abs(dx) < 0.05 && Math.abs(dy) < 0.05) return;
    shown[2 * i] = boxes[4 * i];
    shown[2 * i + 1] = boxes[4 * i + 1];
    spans[i].style.transform = `translate(${shown[2 * i].toFixed(1)}px, ${shown[2 * i + 1].toFixed(1)}px)`;
  }

  return {
    layer,
    draw(width, height) {
      if (layer.hidden) return;
      if (!isMeasured) measure();
      for (let i = 0; i < items.length; i++) {
        track.locate(items[i].at, place);
        point.set(place[0], place[1], place[2]).project(camera);
        boxes[4 * i] = ((point.x + 1) / 2) * width + 9;
        boxes[4 * i + 1] = ((1 - point.y) / 2) * height - boxes[4 * i + 3] - 5;
        spans[i].hidden = !isFree(i);
        if (!spans[i].hidden) move(i);
      }
    },
  };
}
