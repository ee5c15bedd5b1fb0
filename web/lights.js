// Which components are lit: the same ones in all sections of the page.
//
// An element says by `data-component` which components it belongs to, names separated by blanks. What the pointer is on
// or what has the focus lights its components; a click keeps them lit until the next click elsewhere, or Escape.
// What always holds: document.body.dataset.lit has the names that are lit, separated by blanks; exactly those elements that
// share one of them have the class `lit`.

const namesOf = (element) => (element.dataset.component ?? "").split(/\s+/).filter(Boolean);

export function createLights(document) {
  const elements = new Map(); // name -> elements
  const listeners = new Set();
  let kept = []; // by a click
  let lit = new Set();
  let shining = [];

  function index(root) {
    for (const element of root.querySelectorAll("[data-component]")) {
      for (const name of namesOf(element)) {
        if (!elements.has(name)) elements.set(name, new Set());
        elements.get(name).add(element);
      }
    }
  }

  function show(names) {
    const next = new Set(names);
    if (next.size === lit.size && [...next].every((name) => lit.has(name))) return;
    lit = next;
    for (const element of shining) element.classList.remove("lit");
    shining = [];
    for (const name of lit) {
      for (const element of elements.get(name) ?? []) {
        element.classList.add("lit");
        shining.push(element);
      }
    }
    document.body.dataset.lit = [...lit].join(" ");
    for (const listener of listeners) listener(lit);
  }

  const toNames = (names) =>
    (Array.isArray(names) ? names : String(names ?? "").split(/\s+/)).filter(Boolean);

  // Lights these names alone, until another light or Escape; none: all go out. A list, or text with blanks.
  function light(names) {
    kept = toNames(names);
    show(kept);
  }

  // Lights them as long as the pointer is there; none: back to what is kept.
  function hover(names) {
    const list = toNames(names);
    show(list.length ? list : kept);
  }

  const under = (event) => event.target.closest?.("[data-component]");
  document.addEventListener("pointerover", (event) => {
    const element = under(event);
    hover(element ? namesOf(element) : []);
  });
  document.addEventListener("focusin", (event) => {
    const element = under(event);
    if (element) light(namesOf(element));
  });
  document.addEventListener("click", (event) => {
    const element = under(event);
    if (element) light(namesOf(element));
    else if (!event.target.closest?.("a, button, input, select, summary, canvas, .controls")) light([]);
  });
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape") light([]);
  });
  document.body.dataset.lit = "";
  index(document);

  return {
    light,
    hover,
    // Elements that were made later: root and all in it.
    add(root) {
      index(root.parentNode ?? root);
      for (const name of lit) for (const element of elements.get(name) ?? []) element.classList.add("lit");
    },
    get lit() {
      return lit;
    },
    // listener(names), a Set, is called at once and at each change; the result takes it off again.
    subscribe(listener) {
      listeners.add(listener);
      listener(lit);
      return () => listeners.delete(listener);
    },
  };
}
