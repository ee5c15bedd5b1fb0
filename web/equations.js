// Section `equations` of large systems: typeset equations that the page carries deflated take the place of their plain text.
import { readData } from "./data.js";
import { unpackText } from "./packed.js";

export async function showEquations(document, lights) {
  const packed = readData("data-equations");
  if (!packed) return;
  const place = document.getElementById("equations-text");
  const typeset = new DOMParser().parseFromString(await unpackText(packed.data), "text/html");
  place.replaceChildren(...typeset.body.childNodes);
  lights.add(place);
}
