// What the reader may choose about the picture: the view, what is shown, how much beams bend.

function make(tag, attributes, parent, text = "") {
  const element = document.createElement(tag);
  Object.assign(element, attributes);
  element.textContent = text;
  parent.append(element);
  return element;
}

// views: {x, y, z, iso}; look(name), fit(); shown: [{text, on, set(bool)}]; bend: set(factor) or undefined
export function createControls(element, { views, look, fit, shown, bend }) {
  const bar = make("div", { className: "tools controls" }, element);

  const group = make("div", { className: "views" }, bar);
  group.setAttribute("role", "group");
  group.setAttribute("aria-label", "view");
  for (const name of Object.keys(views)) {
    const button = make("button", { type: "button", title: `look along ${name}`.replace("along iso", "from a corner") }, group, name);
    button.addEventListener("click", () => look(name));
  }
  make("button", { type: "button", title: "all in sight (0)" }, group, "fit").addEventListener("click", fit);

  for (const { text, on, set } of shown) {
    const label = make("label", {}, bar);
    const box = make("input", { type: "checkbox", checked: on }, label);
    label.append(text);
    box.addEventListener("change", () => set(box.checked));
  }

  if (bend) {
    const label = make("label", { className: "bend", title: "how much larger than computed beams bend in the picture" }, bar);
    label.append("deflection");
    const slider = make("input", { type: "range", min: 0, max: 2, step: 0.01, value: 0 }, label); // log10 of the factor
    const factor = make("output", {}, label, "× 1");
    slider.setAttribute("aria-label", "factor of deflections");
    slider.addEventListener("input", () => {
      const value = Number((10 ** Number(slider.value)).toPrecision(2));
      factor.textContent = `× ${value}`;
      slider.setAttribute("aria-valuetext", `${value} times`);
      bend(value);
    });
  }
  return bar;
}
