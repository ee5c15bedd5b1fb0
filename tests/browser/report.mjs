// The page of `cotree report` in a real browser: node report.mjs, with COTREE, CHROMIUM, WEB and SYSTEMS in the environment.
import assert from "node:assert/strict";
import { readFileSync, rmSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { cotree, folder, launch, open, report, simulate } from "./browser.mjs";
import { checkClock, checkEquations, checkFile, checkGraph, checkGraphText, checkLayout, checkLights, checkManifest, checkNoScripts, checkOrigins, checkPrint, checkSections } from "./checks.mjs";

const models = join(dirname(fileURLToPath(import.meta.url)), "models");
const system = (name) => join(process.env.SYSTEMS, name, "model.yaml");

// size: most [MB]; light: a component, and the sections it is lit in
const cases = [
  { name: "slider_crank", size: 1, light: ["rod.com", ["model", "graph"]], more: ["main", ["model", "graph", "equations", "plots"]] },
  { name: "puma560", size: 2, light: ["j1", ["model", "graph", "equations"]] },
  { name: "stewart", size: 2, light: ["platform", ["model", "graph"]] },
  { name: "slider_crank_flexible", size: 2, light: ["rod", ["model", "graph"]] },
  { name: "bricard", size: 2 },
  { name: "chain40", size: 2, equations: 40 },
];

const pixels = (page) => page.locator("#motion-panel").screenshot();

async function checkMotion(page, end) {
  await page.evaluate(() => window.cotree.seek(0));
  await page.waitForTimeout(100);
  const before = await pixels(page);
  await page.evaluate((t) => window.cotree.seek(t), 0.37 * end);
  await page.waitForTimeout(100);
  assert.ok(!before.equals(await pixels(page)), "the motion stands still");
}

// A panel that the window cuts off shows its upper part.
async function checkCutOff(browser, file) {
  const { page, close } = await open(browser, file, { viewport: { width: 1200, height: 1600 } });
  const { x, y, width, height } = await page.locator("#motion-panel").boundingBox();
  const clip = { x, y, width, height: height / 2 };
  const whole = await page.screenshot({ clip });
  await page.setViewportSize({ width: 1200, height: Math.round(y + 0.7 * height) });
  await page.waitForTimeout(300);
  const cut = await page.screenshot({ clip: { ...clip, height: clip.height - 60 } });
  assert.ok(cut.length > 0.6 * whole.length, "a part of the motion is blank");
  await close();
}

// All that cotree says about a model: begun at once for all models.
function ask(model, name, page = `${name}.html`) {
  const answers = [report(model, page), simulate(model, `${name}.csv`), cotree(["graph", model, "--format", "json"])];
  answers.forEach((answer) => answer.catch(() => {}));
  return async () => {
    const [file, run, graph] = await Promise.all(answers);
    return { file, run, graph: JSON.parse(graph) };
  };
}

// Equations that the page unpacks: one for each speed, each term with what it comes from and its value.
async function checkUnpacked(page, equations) {
  const found = await page.evaluate(() => {
    const all = [...document.querySelectorAll("#equations math[data-equation]")];
    const terms = all.flatMap((equation) => [...equation.querySelectorAll(".term")]);
    document.querySelector("#equations details.labelled").open = true;
    return [new Set(all.map((equation) => equation.dataset.equation)).size, terms.length > all.length, terms.every((term) => term.dataset.component)];
  });
  assert.deepEqual(found, [equations, true, true]);
}

async function checkModel({ size, light, more, equations, answers }, browser) {
  const { file, run, graph } = await answers();
  checkFile(file, size);
  const { page, close } = await open(browser, file);
  await checkSections(page);
  await checkClock(page, run);
  await checkGraph(page, graph);
  await checkEquations(page, run.t[Math.floor(run.t.length / 2)]);
  await checkOrigins(page);
  if (equations) await checkUnpacked(page, equations);
  await checkLayout(page);
  await checkMotion(page, run.t.at(-1));
  if (light) await checkLights(page, ...light);
  if (more) await checkLights(page, ...more);
  await page.setViewportSize({ width: 390, height: 600 });
  await checkLayout(page);
  await checkGraphText(page);
  await checkPrint(page);
  await close();
}

// What does not depend on the model.
async function checkControls(browser) {
  const file = join(folder, "slider_crank.html");
  const { header } = await simulate(system("slider_crank"), "controls.csv");
  const { page, close } = await open(browser, file);
  // the table that is saved
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "CSV" }).click()]);
  const saved = readFileSync(await download.path(), "utf8");
  assert.equal(saved.slice(0, saved.indexOf("\n")), header);
  assert.equal(saved.trim().split("\n").length, 2002);
  // outputs that are reactions: their value, and those of their terms
  await page.evaluate(() => window.cotree.seek(0.7));
  const shown = await page.locator('#plots [data-component~="guide"]', { hasText: "side_force" }).locator(".value").textContent();
  assert.deepEqual(await page.locator('#equations math[data-equation="side_force"] .value').allTextContents(), [shown, shown]);
  await page.evaluate(() => window.cotree.seek(0));
  // the entry of an output lights what it depends on
  await page.locator("#model .code", { hasText: "side_force" }).hover();
  assert.equal(await page.evaluate(() => document.body.dataset.lit), "guide");
  // the clock from the keyboard, from its slider and from a plot
  await page.locator("h1").click(); // off the button
  await page.keyboard.press(" ");
  await page.waitForFunction(() => window.cotree.time > 0);
  await page.keyboard.press(" ");
  const stood = await page.evaluate(() => window.cotree.time);
  await page.waitForTimeout(100);
  assert.equal(await page.evaluate(() => window.cotree.time), stood);
  await page.locator("#transport input").fill("1");
  assert.equal(await page.evaluate(() => window.cotree.time), 1);
  const chart = page.locator("#plots .u-over").first();
  await chart.scrollIntoViewIfNeeded();
  const box = await chart.boundingBox();
  await chart.click({ position: { x: box.width / 4, y: 20 } });
  assert.ok(Math.abs((await page.evaluate(() => window.cotree.time)) - 0.5) < 0.02);
  await page.evaluate(() => (window.cotree.seek(0), window.cotree.play()));
  await page.waitForFunction(() => window.cotree.time > 0.01);
  await page.evaluate(() => window.cotree.pause());
  // an edge from the keyboard
  const edge = page.locator('#graph .edge[data-edge="guide"]');
  await edge.focus();
  assert.ok((await page.evaluate(() => document.body.dataset.lit)).split(" ").includes("guide"));
  await page.keyboard.press("Enter");
  assert.equal(await page.locator("#graph .equation[data-edge]:visible").count(), 2);
  await page.keyboard.press("Escape");
  assert.equal(await page.evaluate(() => document.body.dataset.lit), "");
  // zoom, and back
  await chart.scrollIntoViewIfNeeded();
  const over = await chart.boundingBox();
  await page.mouse.move(over.x + 50, over.y + 30);
  await page.mouse.down();
  await page.mouse.move(over.x + 250, over.y + 30, { steps: 4 });
  await page.mouse.up();
  const [part] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "CSV" }).click()]);
  assert.ok(readFileSync(await part.path(), "utf8").trim().split("\n").length < 1000);
  await page.getByRole("button", { name: "Whole time" }).click();
  await checkManifest(page, file, system("slider_crank"));
  await close();
  await checkNoScripts(browser, file);
  await checkCutOff(browser, file);
  // a phone, in the dark: nothing is wider than the screen
  const phone = await open(browser, file, { viewport: { width: 390, height: 844 }, dark: true });
  await checkLayout(phone.page);
  await phone.close();
  await checkTables(browser);
}

// The pages of `cotree equations`: on a phone words wrap in tables, and what is still wider scrolls.
async function checkTables(browser) {
  const name = "equations.html";
  await cotree(["equations", system("slider_crank"), "-q", "--show", "all", "-o", name]);
  const context = await browser.newContext({ viewport: { width: 390, height: 844 } });
  const page = await context.newPage();
  await page.goto(`file://${join(folder, name)}`);
  const places = await page.$$eval(".table, .matrix", (all) => all.map((e) => [e.scrollWidth - e.clientWidth, getComputedStyle(e).overflowX]));
  assert.ok(places[0][0] <= 0, "the terminal equations are cut off");
  assert.ok(places.every(([more, overflow]) => more <= 0 || overflow === "auto"));
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390);
  await context.close();
}

async function checkHostile(browser) {
  const model = join(models, "hostile.yaml");
  const { file, run, graph } = await ask(model, "hostile", "it's; $(touch taken) & \"quoted\".html")();
  checkFile(file, 1);
  const { page, close } = await open(browser, file);
  await checkSections(page);
  await checkClock(page, run);
  await checkGraph(page, graph);
  await checkLights(page, "__proto__", ["model", "graph"]);
  assert.equal(await page.evaluate(() => window.taken), undefined);
  assert.equal(await page.locator("main img, main b b").count(), 0);
  assert.ok((await page.textContent("h1")).startsWith("</script><script>window.taken = true</script> & \"quoted\""));
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "CSV" }).click()]);
  assert.ok(readFileSync(await download.path(), "utf8").startsWith(run.header));
  await checkManifest(page, file, model);
  await close();
}

async function checkStill(browser) {
  const file = await report(join(models, "still.yaml"), "still.html");
  const { page, close } = await open(browser, file);
  await checkSections(page);
  assert.equal(await page.evaluate(() => (window.cotree.seek(3), window.cotree.time)), 0);
  await close();
  const again = await report(join(models, "still.yaml"), "again.html");
  assert.ok(readFileSync(file).equals(readFileSync(again)), "the name of the file changes its bytes");
}

// A run that stops before its end: an error, and a page of what there is.
async function checkStop(browser) {
  await assert.rejects(report(join(models, "stops.yaml"), "stops.html"), (error) => error.code === 1 && /E301/.test(error.stderr));
  const { page, close } = await open(browser, join(folder, "stops.html"));
  await checkSections(page);
  const end = await page.evaluate(() => (window.cotree.seek(1), window.cotree.time));
  assert.ok(end > 0.4 && end < 0.5, `it ends at ${end}`);
  assert.match(await page.textContent("#summary [role=alert]"), /stopped before its end.*steps have become too short/);
  assert.equal(await page.locator("#summary .checks a.good", { hasText: /error|energy/ }).count(), 0, "all is well after a stop");
  await close();
}

const wanted = process.argv.slice(2);
const chosen = cases.filter(({ name }) => !wanted.length || wanted.includes(name));
for (const model of chosen) model.answers = ask(system(model.name), model.name);
const browser = await launch();
const steps = [...chosen.map((model) => [model.name, () => checkModel(model, browser)]), ["controls", () => checkControls(browser)], ["hostile", () => checkHostile(browser)], ["still", () => checkStill(browser)], ["stop", () => checkStop(browser)]];
let failed = 0;
for (const [name, step] of steps) {
  if (wanted.length && !wanted.includes(name)) continue;
  const start = Date.now();
  try {
    await step();
    console.log(`${name}: ${((Date.now() - start) / 1000).toFixed(1)} s`);
  } catch (error) {
    failed++;
    console.log(`${name}: ${error.stack}`);
  }
}
await browser.close();
rmSync(folder, { recursive: true });
process.exit(failed ? 1 : 0);
