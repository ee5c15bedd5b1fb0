// The clock of the page: one time that all panels show.
//
// What always holds: start <= time <= end; listeners are called in the order they came, each time the time changes and
// when the clock starts or stops; playing goes back to the start once the end is reached.

// start, end: [s]. speed: seconds of the motion in a second of the reader.
export function createClock(start, end) {
  const listeners = new Set();
  let time = start;
  let speed = 1;
  let frame = 0; // of the animation; 0: the clock stands
  let last = 0; // [ms]

  function tell() {
    for (const listener of listeners) listener(time);
  }

  function set(t) {
    time = Math.min(end, Math.max(start, t));
  }

  function tick(now) {
    const passed = Math.max(0, now - last) / 1000;
    last = now;
    frame = requestAnimationFrame(tick);
    set(time >= end ? start : time + speed * passed);
    tell();
  }

  return {
    start,
    end,
    get time() {
      return time;
    },
    get playing() {
      return frame !== 0;
    },
    get speed() {
      return speed;
    },
    set speed(value) {
      speed = value;
      tell();
    },
    // To time t [s]; beyond the ends it stops there.
    seek(t) {
      if (Number.isNaN(Number(t))) return;
      set(Number(t));
      tell();
    },
    play() {
      if (frame || !(end > start)) return;
      last = performance.now();
      frame = requestAnimationFrame(tick);
      tell();
    },
    pause() {
      if (!frame) return;
      cancelAnimationFrame(frame);
      frame = 0;
      tell();
    },
    // listener(time) is called at once and at each change; the result takes it off again.
    subscribe(listener) {
      listeners.add(listener);
      listener(time);
      return () => listeners.delete(listener);
    },
  };
}
