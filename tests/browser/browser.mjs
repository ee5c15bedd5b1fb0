// What the tests of the page share: cotree, a browser, and what must never happen on a page.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";

const { COTREE, CHROMIUM, WEB } = process.env;
const { chromium } = createRequire(join(WEB, "/"))("playwright-core");

export const folder = mkdtempSync(join(tmpdir(), "cotree-report-"));

export const cotree = (args, options = {}) => execFileSync(COTREE, args, { encoding: "utf8", cwd: folder, ...options });

// The page of a model, as a path.
export function report(model, name, ...options) {
  cotree(["report", model, "-q", "-o", name, ...options]);
  return join(folder, name);
}

// Times and columns of simulate, and its header line.
export function simulate(model) {
  cotree(["simulate", model, "-q", "-o", "table.csv"]);
  const text = readFileSync(join(folder, "table.csv"), "utf8");
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
export async function open(browser, file, { viewport = { width: 1200, height: 900 }, scripts = true, dark = false } = {}) {
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
