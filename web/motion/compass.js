// In the corners of the picture: axes of ground, gravity, lengths and forces to scale. SVG, drawn anew when the view turns.

import { Vector3 } from "three";
import { roundBelow } from "./grid.js";

const svg = "http://www.w3.org/2000/svg";
const seen = 0.08; // of a unit vector, across the line of sight

function make(name, attributes, parent) {
  const element = document.createElementNS(svg, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  parent.append(element);
  return element;
}

function createArrow(parent, text, component, length) {
  const group = make("g", component ? { "data-component": component } : {}, parent);
  const line = make("path", {}, group);
  const label = make("text", { "text-anchor": "middle", "dominant-baseline": "central" }, group);
  label.textContent = text;
  // (x, y): where it begins; (dx, dy): across the view, y upwards
  return function point(x, y, dx, dy) {
    const size = Math.hypot(dx, dy);
    group.style.display = size > seen ? "" : "none";
    if (size <= seen) return;
    const [u, v] = [dx / size, -dy / size];
    const [a, b] = [x + length * dx, y - length * dy];
    const h = 6;
    line.setAttribute(
      "d",
      `M${x} ${y}L${a} ${b}M${a - h * u - 0.45 * h * v} ${b - h * v + 0.45 * h * u}L${a} ${b}L${a - h * u + 0.45 * h * v} ${b - h * v - 0.45 * h * u}`,
    );
    label.setAttribute("x", a + 9 * u);
    label.setAttribute("y", b + 9 * v);
  };
}

const units = [
  [1e3, "km"],
  [1, "m"],
  [1e-3, "mm"],
  [1e-6, "µm"],
];

function lengthText(x) {
  const [unit, name] = units.find(([size]) => x >= 0.999 * size) ?? units[3];
  return `${Number((x / unit).toPrecision(3))} ${name}`;
}

// element: holds the picture; gravity [m/s^2]
export function createCompass(element, camera, gravity) {
  const root = make("svg", { class: "compass", "aria-hidden": "true" }, element);
  const axes = ["x", "y", "z"].map((name) => createArrow(root, name, undefined, 30));
  const g = new Vector3(...gravity);
  const hasGravity = g.length() > 0;
  const pull = createArrow(root, "g", "gravity", 34);
  const bar = make("path", {}, root);
  const text = make("text", { "text-anchor": "end" }, root);
  const e = new Vector3();
  g.normalize();

  return function draw(width, height) {
    ["x", "y", "z"].forEach((name, i) => {
      e.set(0, 0, 0).setComponent(i, 1);
      axes[i](46, height - 46, camera.right.dot(e), camera.up.dot(e));
    });
    if (hasGravity) pull(118 - 17 * camera.right.dot(g), height - 46 + 17 * camera.up.dot(g), camera.right.dot(g), camera.up.dot(g));
    else pull(0, 0, 0, 0);
    const perMetre = height / camera.height;
    const length = roundBelow(110 / perMetre);
    const [right, y] = [width - 20, height - 22];
    const left = right - length * perMetre;
    bar.setAttribute("d", `M${left} ${y - 4}V${y + 4}M${left} ${y}H${right}M${right} ${y - 4}V${y + 4}`);
    text.setAttribute("x", right);
    text.setAttribute("y", y - 9);
    text.textContent = lengthText(length);
  };
}
