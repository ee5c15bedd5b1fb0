// Section `motion` and the page of modes in a real browser: node motion.mjs, with COTREE, CHROMIUM, WEB and SYSTEMS in the environment.
import assert from "node:assert/strict";
import { readFileSync, rmSync } from "node:fs";
import { join } from "node:path";
import { cotree, folder, launch, open, report } from "./browser.mjs";

const system = (name) => join(process.env.SYSTEMS, name, "model.yaml");
const view = (page) => page.locator(".motion-view");
const small = { viewport: { width: 800, height: 500 } }; // pictures are drawn without a graphics card

// Two frames later what was asked for is drawn.
async function pixels(page) {
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  return view(page).screenshot();
}

// Does the picture change by an action?
async function changes(page, action) {
  const before = await pixels(page);
  await action();
  return !before.equals(await pixels(page));
}

// Each of these, one after the other, changes the picture. act(name) does what is named.
async function checkEach(page, names, act) {
  let before = await pixels(page);
  for (const name of names) {
    await act(name);
    const after = await pixels(page);
    assert.ok(!before.equals(after), `nothing by ${name}`);
    before = after;
  }
}

async function checkSeek(page, end) {
  const seek = (t) => page.evaluate((t) => window.cotree.seek(t), t);
  await seek(0);
  assert.ok(await changes(page, () => seek(0.4 * end)), "the motion stands still");
  const there = await pixels(page);
  await seek(0.7 * end);
  await seek(0.4 * end);
  assert.ok(there.equals(await pixels(page)), "the same time gives another picture");
  assert.ok(await changes(page, () => seek(0.4003 * end)), "nothing between samples");
}

async function checkKeys(page) {
  const canvas = view(page).locator("canvas");
  await canvas.focus();
  await checkEach(page, ["ArrowLeft", "ArrowUp", "+", "y", "z", "i", "Shift+ArrowLeft", "0"], (key) => page.keyboard.press(key));
  await page.keyboard.press(" ");
  await page.waitForFunction((t) => window.cotree.time !== t, await page.evaluate(() => window.cotree.time));
  await page.keyboard.press(" ");
}

async function checkMouse(page) {
  await view(page).scrollIntoViewIfNeeded();
  const box = await view(page).boundingBox();
  const drag = async () => {
    await page.mouse.move(box.x + 30, box.y + 40);
    await page.mouse.down();
    await page.mouse.move(box.x + 120, box.y + 90, { steps: 3 });
    await page.mouse.up();
  };
  assert.ok(await changes(page, drag), "nothing by dragging");
  await view(page).locator("canvas").focus();
  assert.ok(await changes(page, () => page.mouse.wheel(0, -300)), "nothing by the wheel");
}

// The pointer on a body lights it everywhere; a click keeps it.
async function checkPicking(page) {
  await page.evaluate(() => window.cotree.seek(0));
  await page.getByRole("button", { name: "z", exact: true }).click();
  await pixels(page);
  const label = await page.locator('.names [data-component="rod"]').boundingBox();
  const lit = () => page.evaluate(() => document.body.dataset.lit);
  const [x, y] = [label.x - 8, label.y + label.height + 4]; // beside what it names, see labels.js
  await page.mouse.move(x, y);
  assert.equal(await lit(), "rod");
  assert.ok(await page.locator('#model .lit[data-component~="rod"]').count());
  await page.mouse.click(x, y);
  await page.mouse.move(5, 5);
  assert.equal(await lit(), "rod");
  assert.ok(await changes(page, () => page.evaluate(() => window.cotree.light(""))), "what is lit looks as ever");
}

async function checkStandsStill(page) {
  await pixels(page);
  const frames = await page.evaluate(async () => {
    let n = 0;
    const request = window.requestAnimationFrame;
    window.requestAnimationFrame = (f) => (n++, request(f));
    await new Promise((resolve) => setTimeout(resolve, 300));
    window.requestAnimationFrame = request;
    return n;
  });
  assert.equal(frames, 0, "frames while nothing changes");
}

async function checkPanel(browser) {
  const { page, close } = await open(browser, await report(system("slider_crank"), "motion.html"), small);
  await checkSeek(page, 2);
  await checkStandsStill(page);
  await checkPicking(page);
  await checkEach(page, ["paths", "reactions", "names", "grid"], (name) => page.locator(".controls label", { hasText: name }).locator("input").click());
  await checkKeys(page);
  await checkMouse(page);
  await page.getByRole("button", { name: "fit" }).click();
  await page.setViewportSize({ width: 500, height: 700 });
  await pixels(page);
  const [width, wanted] = await view(page).evaluate((view) => [view.querySelector("canvas").width, view.clientWidth]);
  assert.ok(wanted < 500);
  assert.equal(width, wanted);
  await close();
}

// In a window that becomes narrower, all that was in sight stays so.
async function checkNarrow(browser) {
  const { page, close } = await open(browser, join(folder, "motion.html"));
  await page.setViewportSize({ width: 390, height: 844 });
  await page.waitForTimeout(300);
  await view(page).locator("canvas").focus();
  assert.ok(!(await changes(page, () => page.keyboard.press("0"))), "the motion is cut off");
  await close();
}

async function checkBeams(browser) {
  const file = await report(system("slider_crank_flexible"), "beams.html");
  const { page, close } = await open(browser, file, { ...small, dark: true });
  await checkSeek(page, 1);
  const slider = page.locator(".factor", { hasText: "deflection" }).locator("input");
  assert.ok(await changes(page, () => slider.fill("2")), "beams do not bend more");
  assert.equal(await page.locator(".factor", { hasText: "deflection" }).locator("output").textContent(), "× 100");
  await close();
}

// Red, green and blue of a picture at places in it.
async function colorsAt(browser, png, places) {
  const page = await browser.newPage();
  const colors = await page.evaluate(
    async ([data, places]) => {
      const image = new Image();
      image.src = `data:image/png;base64,${data}`;
      await image.decode();
      const context = Object.assign(document.createElement("canvas"), { width: image.width, height: image.height }).getContext("2d");
      context.drawImage(image, 0, 0);
      return places.map(([x, y]) => [...context.getImageData(x, y, 1, 1).data.slice(0, 3)]);
    },
    [png.toString("base64"), places],
  );
  await page.close();
  return colors;
}

// A shape has the colour that the model says, by its hue, as light falls on it.
async function checkColors(browser) {
  const { page, close } = await open(browser, await report(join(import.meta.dirname, "models", "shapes.yaml"), "shapes.html"), small);
  const picture = await pixels(page);
  const { width, height } = await view(page).boundingBox();
  const places = Array.from({ length: 12 }, (_, i) => [Math.round((i * width) / 24), Math.round(height / 2 + 20)]);
  const seen = await colorsAt(browser, picture, places);
  const red = seen.filter(([r, g, b]) => r > 120 && g < 60 && b < 60);
  assert.ok(red.length > 0, `no red in ${seen.join("; ")}`);
  await close();
}

// Without WebGL the drawing of the start stays.
async function checkFallback(browser) {
  const context = await browser.newContext();
  const page = await context.newPage();
  const wrong = [];
  page.on("pageerror", (error) => wrong.push(error.message));
  await page.addInitScript(() => {
    const getContext = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
      return kind.startsWith("webgl") ? null : getContext.call(this, kind, ...more);
    };
  });
  await page.goto(`file://${join(folder, "motion.html")}`);
  await page.evaluate(() => window.cotree.ready);
  assert.ok(await page.locator("#motion svg .joint").first().isVisible());
  assert.equal(await page.locator(".motion-view").count(), 0);
  assert.deepEqual(wrong, []);
  await context.close();
}

async function checkModes(browser) {
  const make = (name) => cotree(["modes", system("cantilever"), "-q", "--count", "4", "-o", `${name}.csv`, "--report", name]);
  await Promise.all([make("modes.html"), make("again.html")]);
  const file = join(folder, "modes.html");
  assert.ok(readFileSync(file).equals(readFileSync(join(folder, "again.html"))), "other bytes");
  const { page, close } = await open(browser, file, small);
  assert.equal(await page.locator("input[name=mode]").count(), 4);
  await page.evaluate(() => window.cotree.seek(0));
  assert.ok(await changes(page, () => page.evaluate(() => window.cotree.seek(0.5))), "the mode stands still");
  await page.evaluate(() => window.cotree.seek(0));
  const choose = async () => {
    await page.locator("input[name=mode]").nth(2).check();
    await page.evaluate(() => (window.cotree.pause(), window.cotree.seek(0)));
  };
  assert.ok(await changes(page, choose), "another mode looks the same");
  assert.ok(await changes(page, () => page.locator(".factor input").fill("0.5")), "nothing by the amplitude");
  await page.getByRole("button", { name: "Play" }).click();
  await page.waitForFunction(() => window.cotree.time > 0);
  await page.getByRole("button", { name: "Pause" }).click();
  await close();
}

const browser = await launch();
const steps = { panel: checkPanel, narrow: checkNarrow, beams: checkBeams, colors: checkColors, fallback: checkFallback, modes: checkModes };
let failed = 0;
for (const [name, step] of Object.entries(steps)) {
  const start = Date.now();
  try {
    await step(browser);
    console.log(`${name}: ${((Date.now() - start) / 1000).toFixed(1)} s`);
  } catch (error) {
    failed++;
    console.log(`${name}: ${error.stack}`);
  }
}
await browser.close();
rmSync(folder, { recursive: true });
process.exit(failed ? 1 : 0);
