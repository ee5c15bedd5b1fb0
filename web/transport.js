// Play, scrub and speed: the controls of the clock.

const SPEEDS = [0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10];
const LONGEST = 10; // [s] to watch a motion, by itself

// The speed at which the whole motion can be watched.
function defaultSpeed(length) {
  const fitting = SPEEDS.filter((speed) => length / speed <= LONGEST);
  return length > 0 && length < 0.5 ? (SPEEDS.findLast?.((s) => length / s >= 2) ?? SPEEDS[0]) : (fitting[0] >= 1 ? fitting[0] : 1);
}

export function createTransport(element, clock) {
  if (!element || !(clock.end > clock.start)) return;
  element.hidden = false;
  const [play, slider, time, speed] = ["button", "input", "output", "select"].map((name) => element.querySelector(name));
  const length = clock.end - clock.start;
  const digits = Math.max(0, Math.min(6, 3 - Math.floor(Math.log10(length))));
  for (const value of SPEEDS) speed.add(new Option(`${value}×`, value));
  clock.speed = defaultSpeed(length);
  speed.value = clock.speed;
  slider.min = clock.start;
  slider.max = clock.end;
  slider.step = length / 1000;

  play.addEventListener("click", () => (clock.playing ? clock.pause() : clock.play()));
  slider.addEventListener("input", () => clock.seek(slider.valueAsNumber));
  speed.addEventListener("change", () => (clock.speed = Number(speed.value)));
  document.addEventListener("keydown", (event) => {
    const isFree = !event.target.closest?.("input, select, button, textarea, summary, [tabindex]") && !event.ctrlKey && !event.metaKey && !event.altKey;
    if (!isFree) return;
    if (event.key === " ") {
      event.preventDefault();
      if (clock.playing) clock.pause();
      else clock.play();
    }
    if (event.key === "ArrowLeft" || event.key === "ArrowRight")
      clock.seek(clock.time + ((event.key === "ArrowRight" ? 1 : -1) * length) / 100);
  });
  const elsewhere = [...document.querySelectorAll(".clock")];
  clock.subscribe((t) => {
    slider.value = t;
    slider.setAttribute("aria-valuetext", `${t.toFixed(digits)} s`);
    for (const element of [time, ...elsewhere]) element.textContent = `t = ${t.toFixed(digits)} s`;
    play.textContent = clock.playing ? "Pause" : "Play";
    play.setAttribute("aria-pressed", clock.playing);
  });
}
