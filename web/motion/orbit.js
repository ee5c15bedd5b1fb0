// The reader's hands on the camera: mouse, touch and keyboard.
//
// Drag: turn; right button, Shift or two fingers: move; wheel (where the picture has the focus, or with Ctrl) or two fingers: zoom.

const rate = 0.008; // [rad/px]
const step = 0.12; // [rad] by a key

export function createOrbit(canvas, camera, keys) {
  const fingers = new Map(); // pointer -> [x, y]
  let gap = 0;

  const middle = () => {
    const all = [...fingers.values()];
    return [0, 1].map((k) => all.reduce((sum, at) => sum + at[k], 0) / all.length);
  };
  const spread = () => {
    const [a, b] = fingers.values();
    return b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
  };

  function move(event) {
    if (!fingers.has(event.pointerId)) return;
    const before = middle();
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    const [x, y] = middle().map((v, k) => v - before[k]);
    const tall = canvas.clientHeight;
    if (fingers.size > 1 || event.buttons & 6 || event.shiftKey) camera.pan(-x / tall, y / tall);
    else camera.turn(-rate * x, -rate * y);
    if (fingers.size > 1 && gap > 0) camera.zoom(spread() / gap);
    gap = spread();
  }

  function release(event) {
    fingers.delete(event.pointerId);
    gap = spread();
  }

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    gap = spread();
  });
  canvas.addEventListener("pointermove", move);
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener(
    "wheel",
    (event) => {
      if (!event.ctrlKey && document.activeElement !== canvas) return;
      event.preventDefault();
      const box = canvas.getBoundingClientRect();
      const x = (event.clientX - box.left - box.width / 2) / box.height;
      const y = (box.top + box.height / 2 - event.clientY) / box.height;
      camera.zoom(Math.exp(-0.0015 * event.deltaY * (event.deltaMode === 1 ? 30 : 1)), x, y);
    },
    { passive: false },
  );

  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  canvas.addEventListener("keydown", (event) => {
    const arrow = arrows[event.key];
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (arrow && event.shiftKey) camera.pan(0.05 * arrow[0], 0.05 * arrow[1]);
    else if (arrow) camera.turn(step * arrow[0], -step * arrow[1]);
    else if (event.key === "+" || event.key === "=") camera.zoom(1.2);
    else if (event.key === "-") camera.zoom(1 / 1.2);
    else if (keys[event.key]) keys[event.key]();
    else return;
    event.preventDefault();
  });
}
