// What the tests of the page share: cotree, a browser, and what must never happen on a page.
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdtempSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { availableParallelism, tmpdir } from "node:os";
import { join } from "node:path";
import { promisify } from "node:util";

const { COTREE, CHROMIUM, WEB } = process.env;
const { chromium } = createRequire(join(WEB, "/"))("playwright-core");

export const folder = mkdtempSync(join(tmpdir(), "cotree-report-"));

// Runs of cotree begin in the order in which they are asked for, one on each processor, while the browser looks at pages
// that are there. What was asked for and is not awaited yet may fail: that is said where it is awaited.
const run = promisify(execFile);
const waiting = [];
let free = availableParallelism();

async function runInTurn(args) {
  if (free > 0) free--;
  else await new Promise((resolve) => waiting.push(resolve));
  try {
    return (await run(COTREE, args, { encoding: "utf8", cwd: folder, maxBuffer: 2 ** 28 })).stdout;
  } finally {
    if (waiting.length) waiting.shift()();
    else free++;
  }
}

export function cotree(args) {
  const result = runInTurn(args);
  result.catch(() => {});
  return result;
}

// The page of a model, as a path.
export async function report(model, name, ...options) {
  await cotree(["report", model, "-q", "-o", name, ...options]);
  return join(folder, name);
}

// Times and columns of simulate, and its header line.
export async function simulate(model, name) {
  await cotree(["simulate", model, "-q", "-o", name]);
  const text = readFileSync(join(folder, name), "utf8");
  const start = text.search(/\n[-0-9]/);
  const header = text.slice(0, start);
  const names = header.match(/"(?:[^"]|"")*"|[^,]+/g).map((name) => (name[0] === '"' ? name.slice(1, -1).replaceAll('""', '"') : name));
  const columns = names.map(() => []); // by position: a column may be called __proto__
  for (const line of text.slice(start).trim().split("\n")) line.split(",").forEach((value, i) => columns[i].push(Number(value)));
  return { header, t: columns[0], columns: columns.slice(1) };
}

export const launch = () =>
  chromium.launch({
    executablePath: CHROMIUM,
    // software WebGL, and nothing that asks the net by itself
    args: ["--no-sandbox", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
  });

// Drivers of graphics say so when a test reads pixels.
const isOfDriver = (text) => /GL Driver Message|software WebGL/.test(text);

// Opens a page; whatever it says, asks for or throws fails the test when it is closed.
export async function open(browser, file, { viewport = { width: 1100, height: 600 }, scripts = true, dark = false } = {}) {
  const context = await browser.newContext({ viewport, javaScriptEnabled: scripts, colorScheme: dark ? "dark" : "light", acceptDownloads: true });
  const page = await context.newPage();
  const wrong = [];
  page.on("console", (message) => isOfDriver(message.text()) || wrong.push(`console: ${message.text()}`));
  page.on("pageerror", (error) => wrong.push(`error: ${error.message}`));
  page.on("dialog", (dialog) => {
    wrong.push("a dialog");
    dialog.dismiss();
  });
  page.on("request", (request) => request.url().startsWith("file:") || request.url().startsWith("blob:") || wrong.push(`request: ${request.url()}`));
  await page.goto(`file://${file}`);
  if (scripts) await page.evaluate(() => window.cotree.ready);
  return {
    page,
    async close() {
      assert.deepEqual(wrong, []);
      await context.close();
    },
  };
}
