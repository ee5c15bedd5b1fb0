// Colours: of bodies as `cotree draw` gives them, all others from the variables of the page, in light and in dark.

import { Color } from "three";

// Okabe and Ito (2008), without the yellow and the black
const palette = ["#0072b2", "#d55e00", "#009e73", "#aa4499", "#56b4e9", "#c07800"];

export const colorOfBody = (i) => (i === 0 ? "#808080" : palette[(i - 1) % palette.length]);

// Variables as colours of three.js, which keep their identity when the page turns dark. apply: called after each change.
export function createColors(element, apply) {
  const names = ["edge", "line", "lit-line", "load", "reaction", "symbol", "support"];
  const colors = Object.fromEntries(names.map((name) => [name, new Color()]));
  const probe = document.createElement("span");
  probe.hidden = true;
  element.append(probe);

  function read() {
    for (const name of names) {
      probe.style.color = `var(--${name})`;
      colors[name].setStyle(getComputedStyle(probe).color);
    }
    apply(colors);
  }

  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", read);
  return { colors, read };
}
