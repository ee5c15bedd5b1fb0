// Numbers as the program packs them (src/report/packed.c).
//
// {count, columns, low: [...], step: [...], data}: `data` is base64 of a raw deflate stream of count * columns * 4 bytes: byte 0 of
// all numbers, then byte 1, 2, 3; numbers column by column. A number is 0 for even and odd second differences z >> 1 and
// ~(z >> 1) of integers k; k = 0xffffff stands for NaN, all others for low + step * k of their column.

const ABSENT = 0xffffff;

function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Text that was deflated, as base64.
export async function unpackText(base64) {
  return new TextDecoder().decode(await inflate(bytesOf(base64)));
}

// Columns as Float64Array of `count` numbers each.
export async function unpack(packed) {
  const { count, columns, low, step } = packed;
  const bytes = await inflate(bytesOf(packed.data));
  const size = count * columns;
  const result = [];
  for (let c = 0; c < columns; c++) {
    const column = new Float64Array(count);
    let value = 0;
    let slope = 0;
    for (let i = 0, at = c * count; i < count; i++, at++) {
      const z = bytes[at] | (bytes[at + size] << 8) | (bytes[at + 2 * size] << 16) | (bytes[at + 3 * size] << 24);
      slope = (slope + ((z >>> 1) ^ -(z & 1))) | 0;
      value = (value + slope) | 0;
      column[i] = value === ABSENT ? NaN : low[c] + step[c] * value;
    }
    result.push(column);
  }
  return result;
}

// The index of the last sample at or before t, and how far t is to the next one: 0 <= part < 1.
export function locate(times, t) {
  let a = 0;
  let b = times.length - 1;
  if (!(t > times[0])) return { index: 0, part: 0 };
  if (t >= times[b]) return { index: b, part: 0 };
  while (b - a > 1) {
    const middle = (a + b) >> 1;
    if (times[middle] <= t) a = middle;
    else b = middle;
  }
  return { index: a, part: (t - times[a]) / (times[b] - times[a]) };
}

// A column at a place of `locate`, linearly between samples.
export function valueAt(column, { index, part }) {
  return part === 0 ? column[index] : column[index] + part * (column[index + 1] - column[index]);
}
