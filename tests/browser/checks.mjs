// What holds for the page of any model.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { basename } from "node:path";
import { folder, open } from "./browser.mjs";

const SECTIONS = ["summary", "motion", "model", "graph", "trees", "derivation", "equations", "loops", "plots", "accuracy", "left-out", "manifest"];
const MB = 2 ** 20;

export function checkFile(file, most) {
  const text = readFileSync(file, "utf8");
  assert.ok(text.length <= most * MB, `${basename(file)} has ${text.length} bytes`);
  assert.match(text, /default-src 'none'; script-src 'sha256-[^']+'; style-src 'sha256-[^']+'/);
  for (const [, json] of text.matchAll(/<script type="application\/json"[^>]*>(.*?)<\/script>/gs)) {
    assert.ok(!json.includes("<"));
    JSON.parse(json);
  }
}

// All sections in order, ready in time: 2 s of the browser's own work.
export async function checkSections(page) {
  assert.deepEqual(await page.$$eval("main > section", (all) => all.map((section) => section.id)), SECTIONS);
  assert.ok(await page.$$eval("main > section", (all) => all.every((section) => section.querySelector("h2") && section.textContent.trim().length > 20)));
  const session = await page.context().newCDPSession(page);
  await session.send("Performance.enable");
  const { metrics } = await session.send("Performance.getMetrics");
  const work = metrics.find((metric) => metric.name === "ScriptDuration").value + metrics.find((metric) => metric.name === "LayoutDuration").value;
  assert.ok(work < 2, `${work} s`);
}

const valuesOf = (page) => page.$$eval("#plots [data-column] .value", (all) => all.map((e) => Number(e.textContent)));
const orderOf = (page) => page.$$eval("#plots [data-column]", (all) => all.map((e) => Number(e.dataset.column)));

// Values beside the names are those of simulate, between samples on the straight line.
export async function checkClock(page, { t, columns: all }) {
  const columns = (await orderOf(page)).map((i) => all[i]);
  const range = columns.map((column) => Math.max(...column) - Math.min(...column) || Math.abs(column[0]) || 1);
  const last = t.length - 1;
  const near = async (time, want) => {
    await page.evaluate((time) => window.cotree.seek(time), time);
    (await valuesOf(page)).forEach((value, k) => assert.ok(Math.abs(value - want(columns[k])) <= 1e-4 * Math.max(Math.abs(value), 1e-3 * range[k]), `t = ${time}: ${value}, not ${want(columns[k])}`));
  };
  const i = Math.floor(last / 3);
  await near(t[i], (column) => column[i]);
  await near((t[i] + t[i + 1]) / 2, (column) => (column[i] + column[i + 1]) / 2);
  await near(t[last] + 10, (column) => column[last]);
  assert.equal(await page.evaluate(() => window.cotree.time), t[last]);
  await near(-5, (column) => column[0]);
  assert.equal(await page.evaluate(() => window.cotree.time), 0);
}

// Of each equation the values of its terms add up to the same on both sides.
export async function checkEquations(page, t) {
  await page.evaluate((t) => window.cotree.seek(t), t);
  const off = await page.$$eval("#equations math[data-equation]", (all) =>
    all.map((equation) => {
      const isRight = (value) => Boolean(value.closest(".right"));
      const values = [...equation.querySelectorAll(".value")].map((value) => [Number(value.textContent), isRight(value)]);
      const sum = values.reduce((total, [value, right]) => total + (right ? -value : value), 0);
      return [equation.dataset.equation, sum, Math.max(0, ...values.map(([value]) => Math.abs(value))), values.length];
    }),
  );
  for (const [name, sum, most, n] of off) assert.ok(Math.abs(sum) <= 3e-4 * most * Math.max(1, n) + 1e-9, `${name}: ${sum} of ${most}`);
  return off.length;
}

// The values of an equation end in one column; nothing of a term is outside its place.
export async function checkLayout(page) {
  const wrong = await page.evaluate(() => {
    const isOutside = (term) => {
      const place = term.getBoundingClientRect();
      const range = document.createRange();
      range.selectNodeContents(term);
      return [...range.getClientRects()].some((r) => r.width && (r.right > place.right + 1 || r.bottom > place.bottom + 1 || r.right > innerWidth));
    };
    return [...document.querySelectorAll("#equations math[data-equation]")]
      .filter((equation) => {
        const ends = [...equation.querySelectorAll(".value")].map((value) => value.getBoundingClientRect().right);
        return Math.max(...ends) - Math.min(...ends) > 1 || [...equation.querySelectorAll(".term > mtext")].some(isOutside);
      })
      .map((equation) => equation.dataset.equation);
  });
  assert.deepEqual(wrong, []);
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth - innerWidth)) <= 0, "wider than the window");
}

// Names of the graph can be read on a phone.
export async function checkGraphText(page) {
  const height = await page.evaluate(() => document.querySelector("#graph svg text").getBoundingClientRect().height);
  assert.ok(height >= 8, `names of ${height} px`);
}

// On paper: dark on white whatever the screen is, charts no wider than the rest.
export async function checkPrint(page) {
  await page.emulateMedia({ media: "print", colorScheme: "dark" });
  await page.setViewportSize({ width: 700, height: 900 });
  const { ink, paper, wide } = await page.evaluate(() => {
    const style = getComputedStyle(document.documentElement);
    const right = document.querySelector("main").getBoundingClientRect().right;
    const canvas = [...document.querySelectorAll("#plots canvas, #loops canvas")];
    return { ink: style.color, paper: style.backgroundColor, wide: canvas.filter((c) => c.getBoundingClientRect().right > right + 1).length };
  });
  assert.deepEqual({ ink, paper, wide }, { ink: "rgb(28, 36, 48)", paper: "rgb(255, 255, 255)", wide: 0 });
  assert.ok(await page.locator("#motion-panel > svg").isVisible());
  assert.ok(await page.locator("#motion .start").isVisible(), "what the drawing shows is not said");
}

const litState = (page) =>
  page.evaluate(() => {
    const lit = new Set(document.body.dataset.lit.split(" ").filter(Boolean));
    const shares = (e) => e.dataset.component.split(/\s+/).some((name) => lit.has(name));
    const all = [...document.querySelectorAll("[data-component]")];
    return {
      lit: [...lit],
      wrong: all.filter((e) => shares(e) !== e.classList.contains("lit")).length + document.querySelectorAll(".lit:not([data-component])").length,
      sections: [...new Set(all.filter((e) => e.classList.contains("lit")).map((e) => e.closest("section")?.id))],
    };
  });

// What a part of the page belongs to stands in the model, except what the model does not mention.
export async function checkOrigins(page) {
  const missing = await page.evaluate(() => {
    const namesIn = (root) => [...root.querySelectorAll("[data-component]")].flatMap((e) => e.dataset.component.split(" "));
    const written = new Set(namesIn(document.getElementById("model")));
    return [...new Set(namesIn(document))].filter((name) => !written.has(name) && name !== "gravity");
  });
  assert.deepEqual(missing, []);
}

// A component lights up in these sections, from any of them.
export async function checkLights(page, name, sections) {
  await page.evaluate((name) => window.cotree.light(name), name);
  const state = await litState(page);
  assert.deepEqual(state.lit, [name]);
  assert.equal(state.wrong, 0);
  for (const id of sections) assert.ok(state.sections.includes(id), `${name} is not lit in ${id}`);
  for (const id of sections) {
    const element = page.locator(`#${id} [data-component~="${name}"]`).first();
    await page.evaluate(() => window.cotree.light(""));
    assert.deepEqual((await litState(page)).lit, []);
    await element.dispatchEvent("pointerover", { bubbles: true });
    const hovered = await litState(page);
    assert.ok(hovered.lit.includes(name), `${id}: ${hovered.lit}`);
    assert.equal(hovered.wrong, 0);
    for (const other of sections) assert.ok(hovered.sections.includes(other), `from ${id}: ${name} is not lit in ${other}`);
  }
  await page.keyboard.press("Escape");
  await page.evaluate(() => window.cotree.light(""));
}

// Every edge shows its own equations alone, with its number; one tree shows one line.
export async function checkGraph(page, graph) {
  const shown = () => page.$$eval("#graph .equation[data-edge]", (all) => all.filter((e) => e.checkVisibility()).map((e) => [e.dataset.edge, e.dataset.tree]));
  assert.deepEqual(await shown(), []);
  const few = graph.edges.slice(0, 12);
  const seen = await page.evaluate(
    (names) =>
      names.map((name) => {
        window.cotree.select(name);
        const lines = [...document.querySelectorAll("#graph .equation[data-edge]")].filter((e) => e.checkVisibility());
        return { lines: lines.map((e) => e.dataset.edge), number: document.querySelector("#graph .edge.selected text").textContent };
      }),
    few.map((edge) => edge.name),
  );
  seen.forEach(({ lines, number }, i) => {
    assert.deepEqual(lines, [few[i].name, few[i].name]);
    assert.ok(number.startsWith(String(few[i].id)), `${few[i].name}: ${number}`);
  });
  for (const tree of ["translation", "rotation"]) {
    await page.check(`#graph input[value=${tree}]`);
    const edge = graph.edges.findLast((edge) => edge.kind !== "arm" && edge.kind !== "particle");
    await page.evaluate((name) => window.cotree.select(name), edge.name);
    assert.deepEqual(await shown(), [[edge.name, tree]]);
    const rows = graph[tree][edge[`branch_${tree}`] ? "cutsets" : "circuits"];
    const members = rows.find((row) => (row.branch ?? row.chord) === edge.id);
    const marked = await page.$$eval("#graph .edge.member", (all) => all.map((e) => Number(e.querySelector("text").textContent.split(" ")[0])));
    assert.deepEqual(marked.sort((a, b) => a - b), members.edges);
  }
  await page.check("#graph input[value=both]");
  await page.evaluate(() => window.cotree.select(null));
  assert.deepEqual(await shown(), []);
}

// The command on the page makes the same bytes again, and the digest is that of the model.
export async function checkManifest(page, file, model) {
  const digest = createHash("sha256").update(readFileSync(model)).digest("hex");
  assert.ok((await page.textContent("#manifest")).includes(digest));
  const command = await page.textContent("#command");
  assert.match(command, /^cotree report /);
  assert.ok(/^[\w.]+$/.test(basename(file)) ? command.endsWith(` -o ${basename(file)}`) : command.includes(" -o "), command);
  const before = readFileSync(file);
  execFileSync("sh", ["-c", `cotree() { "$COTREE" "$@"; }\n${command}`], { cwd: folder, stdio: "ignore" });
  assert.ok(before.equals(readFileSync(file)), "other bytes");
}

// Names from a model are text and nothing else.
export async function checkNoScripts(browser, file) {
  const { page, close } = await open(browser, file, { scripts: false });
  assert.ok(await page.locator("#motion svg").count());
  assert.ok(await page.locator("#graph svg .edge").count());
  assert.ok(await page.locator("#graph .equation[data-edge]").first().isVisible());
  assert.ok(await page.locator("#equations").isVisible());
  await close();
}
