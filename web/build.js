// node web/build.js OUT.c DEPFILE: bundles the page's scripts and its style, and writes their bytes as C. Needs no network.
import { build } from "esbuild";
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join, relative, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const [out, depfile] = process.argv.slice(2);
const web = dirname(fileURLToPath(import.meta.url));

async function bundle(entry) {
  const result = await build({
    entryPoints: [join(web, entry)],
    absWorkingDir: web,
    bundle: true,
    minify: true,
    write: false,
    metafile: true,
    format: "iife",
    target: "es2020",
    charset: "ascii",
    legalComments: "none",
  });
  const text = result.outputFiles[0].text;
  // either would end the element that the text stands in
  if (/<\/(script|style)|<!--/i.test(text)) throw new Error(`${entry}: the bundle contains the end of an element`);
  return { text, inputs: Object.keys(result.metafile.inputs) };
}

function asC(name, text) {
  const bytes = Buffer.from(text, "utf8");
  const lines = [];
  for (let i = 0; i < bytes.length; i += 32) lines.push([...bytes.subarray(i, i + 32)].join(","));
  return `const unsigned char ct_web_${name}[] = {\n${lines.join(",\n")}};\nconst size_t ct_web_${name}_size = ${bytes.length};\n`;
}

// Their authors want the licences to go with the code.
const licences = ["three", "uplot"].map((name) => {
  const folder = join(web, "node_modules", name);
  const { version } = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
  return `/* ${name} ${version}\n${readFileSync(join(folder, "LICENSE"), "utf8").trim()} */\n`;
});

const script = await bundle("main.js");
script.text += licences.join("");
const style = await bundle("page.css");
writeFileSync(
  out,
  `// Written by web/build.js.\n#include "html/web.h"\n\n${asC("script", script.text)}\n${asC("style", style.text)}`,
);
if (depfile) {
  const files = [...script.inputs, ...style.inputs].map((file) => resolve(web, file));
  const quote = (file) => relative(process.cwd(), file).replaceAll("\\", "/").replaceAll(" ", "\\ ");
  writeFileSync(depfile, `${out}: ${files.map(quote).join(" ")} ${quote(join(web, "package-lock.json"))}\n`);
}
