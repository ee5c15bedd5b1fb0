// Starts the page: its data, one clock, one light, and the panels that share them. The page of modes has a start of its own.
import { createClock } from "./clock.js";
import { readData } from "./data.js";
import { showEquations } from "./equations.js";
import { createGraph } from "./graph.js";
import { createLights } from "./lights.js";
import { startModes } from "./motion/modes.js";
import { createMotion } from "./motion/motion.js";
import { nameOwnFile } from "./manifest.js";
import { unpack } from "./packed.js";
import { createPlots } from "./plots.js";
import { createTransport } from "./transport.js";
import { showValues } from "./values.js";

function startReport() {
  const run = readData("data-run");
  const clock = createClock(run.start, run.end);
  const lights = createLights(document);
  const graph = createGraph(document.getElementById("graph"), readData("data-graph"), lights);
  createTransport(document.getElementById("transport"), clock);
  nameOwnFile(document.getElementById("command"));

  async function start() {
    const [times] = await unpack(run.times);
    const samples = await unpack(run.samples);
    await createMotion(document.getElementById("motion-panel"), readData("data-motion"), clock, lights);
    createPlots(document.getElementById("plots"), { ...run, times, samples }, clock, lights);
    const loops = readData("data-loops");
    if (loops) createPlots(document.getElementById("loops"), { times: (await unpack(loops.times))[0], samples: await unpack(loops.samples) }, clock, lights);
    await showEquations(document, lights);
    const terms = readData("data-terms");
    if (terms) showValues(document, terms, await unpack(terms.times), await unpack(terms.samples), clock);
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
    select: (edge) => graph.select(edge),
  };
}

document.documentElement.classList.add("scripted");
window.cotree = readData("data-modes") ? startModes() : startReport();
