// Section `graph`: which tree is shown; the cutset of a branch or the circuit of a chord that is selected, with its equation.

export function createGraph(section, data, lights) {
  const picture = section.querySelector("svg");
  const edges = new Map([...section.querySelectorAll("[data-edge]")].filter((e) => picture?.contains(e)).map((e) => [e.dataset.edge, e]));
  const equations = [...section.querySelectorAll(".equation[data-edge]")];
  const hint = section.querySelector(".hint");
  const entry = new Map(data.edges.map((edge, index) => [edge.name, { ...edge, index }]));
  let selected = null;
  let tree = "both";

  const treesShown = () => (tree === "both" ? ["translation", "rotation"] : [tree]);

  function show() {
    picture.dataset.tree = tree;
    for (const element of edges.values()) element.classList.remove("selected", "member", "member-translation", "member-rotation");
    const edge = entry.get(selected);
    for (const name of edge ? treesShown() : []) {
      for (const number of edge[name]) {
        edges.get(data.edges[Math.abs(number) - 1].name)?.classList.add("member", `member-${name}`);
      }
    }
    if (edge) edges.get(selected)?.classList.add("selected");
    picture.classList.toggle("has-selection", Boolean(edge));
    for (const equation of equations) {
      const isShown = equation.dataset.edge === selected && treesShown().includes(equation.dataset.tree);
      equation.hidden = !isShown;
    }
    for (const [name, element] of edges) element.setAttribute("aria-pressed", String(name === selected));
    if (hint) hint.hidden = Boolean(edge);
  }

  // The edge with this name; none or an unknown one: nothing is selected.
  function select(name) {
    selected = entry.has(name) ? name : null;
    show();
    lights.light(selected ? edges.get(selected)?.dataset.component : []);
  }

  for (const [name, element] of edges) {
    element.addEventListener("click", () => select(name));
    element.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      select(name);
    });
  }
  section.querySelectorAll("[data-select]").forEach((button) => button.addEventListener("click", () => select(button.dataset.select)));
  section.querySelectorAll("input[name=tree]").forEach((input) =>
    input.addEventListener("change", () => {
      tree = input.value;
      show();
    }),
  );
  section.querySelectorAll(".tools").forEach((tools) => (tools.hidden = false));
  if (picture) show();
  return { select };
}
