// Columns over time, a panel for each figure of a section; the cursor is the clock.
import uPlot from "uplot";
import { csvOf, saveText } from "./csv.js";
import { formatNumber } from "./numbers.js";
import { locate, valueAt } from "./packed.js";

const HEIGHT = 190; // [px]
const NCOLOUR = 6; // --curve-1 ... of page.css
const DASHES = [[], [8, 4], [2, 3], [10, 3, 2, 3]]; // they tell apart what has the same colour

const variable = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const colourOf = (i) => `--curve-${(i % NCOLOUR) + 1}`;
const dashOf = (i) => DASHES[Math.floor(i / NCOLOUR) % DASHES.length];

// The panels stand in the document: <figure data-columns="0 3">, each with a list of its columns.
export function createPlots(section, run, clock, lights) {
  const { times, samples } = run;
  const values = [...section.querySelectorAll("[data-column]")].map((element) => ({
    column: samples[Number(element.dataset.column)],
    text: element.querySelector(".value"),
  }));
  const plots = [];
  let range = null; // of time that all panels show; null: all of it

  function setRange(min, max) {
    range = min === null ? null : [min, max];
    for (const plot of plots) {
      plot.setScale("x", { min: min ?? times[0], max: max ?? times[times.length - 1] });
    }
    if (reset) reset.disabled = range === null;
  }

  function createPanel(figure) {
    const columns = figure.dataset.columns.split(" ").map(Number);
    const place = figure.querySelector(".chart");
    const axis = { stroke: () => variable("--quiet"), grid: { stroke: () => variable("--line"), width: 1 }, ticks: { stroke: () => variable("--line"), width: 1 }, font: "12px system-ui, sans-serif" };
    const plot = new uPlot(
      {
        width: Math.max(place.clientWidth, 240),
        height: HEIGHT,
        legend: { show: false },
        cursor: { show: true, x: true, y: false, points: { show: false }, drag: { x: true, y: false, setScale: false } },
        scales: { x: { time: false }, y: { range: (u, low, high) => rangeOf(low, high) } },
        axes: [
          { ...axis, values: (u, ticks) => ticks.map((t) => `${tickText(t, ticks)}${t === ticks[ticks.length - 1] ? " s" : ""}`), size: 32 },
          { ...axis, values: (u, ticks) => ticks.map((t) => tickText(t, ticks)), size: 64 },
        ],
        series: [{}, ...columns.map((c, i) => ({ stroke: () => variable(colourOf(i)), dash: dashOf(i), width: 1.6, points: { show: times.length === 1 } }))],
        hooks: {
          draw: [(u) => drawClock(u, clock.time)],
          setSelect: [
            (u) => {
              if (u.select.width > 4) setRange(u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x"));
              u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
            },
          ],
        },
      },
      [times, ...columns.map((c) => samples[c])],
      place,
    );
    let from = null;
    plot.over.addEventListener("pointerdown", (event) => (from = event.offsetX));
    plot.over.addEventListener("pointerup", (event) => {
      if (from !== null && Math.abs(event.offsetX - from) <= 4) clock.seek(plot.posToVal(event.offsetX, "x"));
      from = null;
    });
    plot.over.addEventListener("dblclick", () => setRange(null, null));
    plots.push(plot);
    new ResizeObserver(() => {
      const width = Math.max(place.clientWidth, 240);
      if (width !== plot.width) plot.setSize({ width, height: HEIGHT });
    }).observe(place);
  }

  const tools = section.querySelector(".tools");
  const [reset, save] = tools?.querySelectorAll("button") ?? [];
  if (tools) tools.hidden = false;
  reset?.addEventListener("click", () => setRange(null, null));
  save?.addEventListener("click", () => {
    const [from, to] = range ?? [times[0], times[times.length - 1]];
    saveText(`${run.file}.csv`, csvOf(run.columns.map((column) => column.name), times, samples, from, to));
  });
  const figures = [...section.querySelectorAll("figure[data-columns]")];
  for (const figure of figures) {
    figure.querySelectorAll("[data-column] .swatch").forEach((swatch, i) => {
      const dash = dashOf(i);
      swatch.style.borderTopColor = `var(${colourOf(i)})`;
      swatch.style.borderTopStyle = dash.length ? (dash[0] > 4 ? "dashed" : "dotted") : "solid";
    });
    createPanel(figure);
  }
  clock.subscribe((t) => {
    const place = locate(times, t);
    for (const { column, text } of values) text.textContent = formatNumber(valueAt(column, place));
    for (const plot of plots) plot.redraw(false);
  });
  for (const query of ["(prefers-color-scheme: dark)", "print"]) {
    matchMedia(query).addEventListener("change", () => plots.forEach((plot) => plot.redraw()));
  }
}

// A constant stands in the middle; round-off about it is not shown as a motion.
function rangeOf(low, high) {
  if (!Number.isFinite(low) || !Number.isFinite(high)) return [-1, 1];
  const most = Math.max(Math.abs(low), Math.abs(high));
  if (high - low <= 1e-6 * most || most === 0) {
    const margin = most > 0 ? most / 2 : 1;
    return [low - margin, high + margin];
  }
  const margin = 0.06 * (high - low);
  return [low - margin, high + margin];
}

function tickText(value, ticks) {
  const step = ticks.length > 1 ? Math.abs(ticks[1] - ticks[0]) : Math.abs(value) || 1;
  const most = Math.max(...ticks.map(Math.abs));
  if (most >= 1e5 || most < 1e-3) return value === 0 ? "0" : value.toExponential(Math.max(0, Math.round(Math.log10(most / step)))).replaceAll("-", "−");
  return value.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9))).replace("-", "−");
}

function drawClock(plot, t) {
  const x = Math.round(plot.valToPos(t, "x", true));
  const { left, top, width, height } = plot.bbox;
  if (x < left || x > left + width) return;
  const { ctx } = plot;
  ctx.save();
  ctx.strokeStyle = variable("--accent");
  ctx.lineWidth = Math.max(1.5, devicePixelRatio);
  ctx.beginPath();
  ctx.moveTo(x, top);
  ctx.lineTo(x, top + height);
  ctx.stroke();
  ctx.restore();
}
