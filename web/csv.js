// Tables as `cotree simulate` writes them: a header of names, then rows.
import { writeNumber } from "./numbers.js";

const quoted = (name) => (/[",\r\n]/.test(name) ? `"${name.replaceAll('"', '""')}"` : name);

// The rows from one time to another.
export function csvOf(names, times, samples, from, to) {
  const lines = [["t", ...names].map(quoted).join(",")];
  for (let i = 0; i < times.length; i++) {
    if (times[i] >= from && times[i] <= to) lines.push([times[i], ...samples.map((column) => column[i])].map(writeNumber).join(","));
  }
  return `${lines.join("\n")}\n`;
}

export function saveText(name, text) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  link.download = name;
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
