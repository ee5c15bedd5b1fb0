// What the reader may choose about the picture: the view, what is shown, how much larger some of it is.

function make(tag, attributes, parent, text = "") {
  const element = document.createElement(tag);
  Object.assign(element, attributes);
  element.textContent = text;
  parent.append(element);
  return element;
}

// views: {x, y, z, iso}; look(name), fit(); shown: [{text, title, on, set(bool)}]; factors: [{text, title, least, most, set(factor)}]
export function createControls(element, { views, look, fit, shown, factors }) {
  const bar = make("div", { className: "tools controls" }, element);

  const group = make("div", { className: "views" }, bar);
  group.setAttribute("role", "group");
  group.setAttribute("aria-label", "view");
  for (const name of Object.keys(views)) {
    const button = make("button", { type: "button", title: `look along ${name}`.replace("along iso", "from a corner") }, group, name);
    button.addEventListener("click", () => look(name));
  }
  make("button", { type: "button", title: "all in sight (0)" }, group, "fit").addEventListener("click", fit);

  for (const { text, title = "", on, set } of shown) {
    const label = make("label", { title }, bar);
    const box = make("input", { type: "checkbox", checked: on }, label);
    label.append(text);
    box.addEventListener("change", () => set(box.checked));
  }

  for (const { text, title, least = 1, most, set } of factors) {
    const label = make("label", { className: "factor", title }, bar, text);
    const slider = make("input", { type: "range", min: Math.log10(least), max: Math.log10(most), step: 0.01, value: 0 }, label);
    const output = make("output", {}, label, "× 1");
    slider.setAttribute("aria-label", title);
    slider.addEventListener("input", () => {
      const factor = Number((10 ** Number(slider.value)).toPrecision(2));
      output.textContent = `× ${factor}`;
      slider.setAttribute("aria-valuetext", `${factor} times`);
      set(factor);
    });
  }
  return bar;
}
