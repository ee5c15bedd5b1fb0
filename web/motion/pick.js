// Picking: components in the picture and all others on the page.

import { Vector2 } from "three";

// What the pointer is on is lit; a click keeps it.
export function createPicking(canvas, parts, camera, lights) {
  const at = new Vector2();
  let down = null;
  const pick = (event) => {
    const box = canvas.getBoundingClientRect();
    at.set((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height);
    return parts.pick(at, camera);
  };
  const names = (event) => {
    const name = pick(event);
    return name === undefined ? [] : [name];
  };
  canvas.addEventListener("pointermove", (event) => {
    if (event.buttons === 0) lights.hover(names(event));
  });
  canvas.addEventListener("pointerleave", () => lights.hover([]));
  canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
  canvas.addEventListener("pointerup", (event) => {
    if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4) lights.light(names(event));
    down = null;
  });
}
