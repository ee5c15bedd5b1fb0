// The page of `cotree modes --report`: a mode is chosen in the table, and the system swings in it.

import { createClock } from "../clock.js";
import { readData } from "../data.js";
import { createLights } from "../lights.js";
import { unpack } from "../packed.js";
import { createMotion } from "./motion.js";
import { createPoseTable } from "./track.js";

const period = 2; // [s] to watch a period of any mode
const usual = 0.08; // largest motion at amplitude 1, in sizes of the system
const steep = 0.4; // largest rotation at amplitude 1 [rad]

// Row 0: the configuration; rows 1 + 2 i and 2 + 2 i: its derivatives by the real and the imaginary part of mode i. At the time t,
// counted in periods, places are row 0 + amplitude (real part cos - imaginary part sin).
function createModeTrack(poses, columns) {
  const table = createPoseTable(poses);
  const { place, turn } = table;
  let mode = 0;
  let amplitude = 0;
  let c = 1;
  let s = 0;

  const value = (column) => {
    const v = columns[column];
    return v[0] + amplitude * (c * v[1 + 2 * mode] - s * v[2 + 2 * mode]);
  };
  const largest = (from, to, every, wanted) => {
    let most = 0;
    for (let k = from; k < to; k++)
      if (wanted(k % every)) most = Math.max(most, Math.hypot(columns[k][1 + 2 * mode], columns[k][2 + 2 * mode]));
    return most;
  };

  function seek(t) {
    c = Math.cos(2 * Math.PI * t);
    s = Math.sin(2 * Math.PI * t);
    for (let p = 1; p < poses; p++) {
      const k = 7 * (p - 1);
      let size = 0;
      for (let i = 0; i < 3; i++) place[3 * p + i] = value(k + i);
      for (let i = 0; i < 4; i++) {
        turn[4 * p + i] = value(k + 3 + i);
        size += turn[4 * p + i] ** 2;
      }
      for (let i = 0; i < 4; i++) turn[4 * p + i] /= Math.sqrt(size);
    }
  }

  seek(0);
  return {
    ...table,
    times: [0, 1],
    seek,
    cubic: value,
    linear: value,
    // as it is with the amplitude 0
    scan(n, f) {
      seek(0);
      for (let i = 0; i < n; i++) f(i);
    },
    // factor: of the usual amplitude; size: of the system [m]
    choose(i, factor, size) {
      const poseColumns = 7 * (poses - 1);
      mode = i;
      const moved = Math.max(largest(0, poseColumns, 7, (k) => k < 3), largest(poseColumns, columns.length, 1, () => true));
      const turned = 2 * largest(0, poseColumns, 7, (k) => k > 2);
      amplitude = factor * Math.min(usual * size / (moved || 1e-300), steep / (turned || 1e-300));
      if (!Number.isFinite(amplitude)) amplitude = 0;
    },
  };
}

function addPlayButton(bar, clock) {
  const button = document.createElement("button");
  button.type = "button";
  button.addEventListener("click", () => (clock.playing ? clock.pause() : clock.play()));
  bar.prepend(button);
  clock.subscribe(() => {
    button.textContent = clock.playing ? "Pause" : "Play";
  });
}

// Starts the page; returns window.cotree.
export function startModes() {
  const data = readData("data-modes");
  const clock = createClock(0, 1);
  const lights = createLights(document);
  const choices = [...document.querySelectorAll("input[name=mode]")];
  clock.speed = 1 / period;

  async function start() {
    const track = createModeTrack(data.poses, await unpack(data.rows));
    let mode = 0;
    let amplitude = 1;
    const motion = await createMotion(document.getElementById("motion-panel"), { ...data, traces: [], forces: data.forces.filter((f) => f.from) }, clock, lights, {
      track,
      factors: [{ text: "amplitude", title: "how far the system swings", least: 0.1, most: 10, set: (factor) => choose(mode, factor) }],
    });
    if (!motion) return;
    addPlayButton(motion.bar, clock);
    function choose(i, factor) {
      mode = i;
      amplitude = factor;
      track.choose(i, factor, motion.size);
      motion.update();
    }
    for (const choice of choices) {
      choice.addEventListener("change", () => {
        choose(Number(choice.value), amplitude);
        clock.play();
      });
    }
    choose(0, 1);
  }

  return {
    ready: start(),
    get time() {
      return clock.time;
    },
    seek: (t) => clock.seek(t),
    play: () => clock.play(),
    pause: () => clock.pause(),
    light: (name) => lights.light(name),
  };
}
