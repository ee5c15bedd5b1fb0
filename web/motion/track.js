// Samples -> where everything is at a time.
//
// A row has the poses (x y z, quaternion w x y z) of pose 1, 2 ..., then other columns; pose 0 is ground. Between samples places are
// cubic in time, so that what joints hold together stays together where few samples are given; rotations are turned at a constant
// rate (slerp).
// What always holds: `seek` makes nothing new.

import { locate } from "../packed.js";

// poses: their number; times: [s]; columns: as `unpack` gives them.
export function createTrack(poses, times, columns) {
  const place = new Float64Array(3 * poses); // [m], ground axes
  const turn = new Float64Array(4 * poses); // w x y z
  const weight = new Float64Array(4); // of the samples around
  const last = times.length - 1;
  let index = 0;
  let part = 0;
  turn[0] = 1;

  // Cubic Hermite polynomials with slopes from the three samples around each end.
  function weigh() {
    weight.fill(0);
    weight[1] = 1;
    if (part === 0) return;
    const h = times[index + 1] - times[index];
    const h0 = index > 0 ? times[index] - times[index - 1] : 0;
    const h2 = index + 2 <= last ? times[index + 2] - times[index + 1] : 0;
    const s = part;
    const value1 = s * s * (3 - 2 * s);
    const slope0 = s * (1 - s) * (1 - s) * h;
    const slope1 = s * s * (s - 1) * h;
    const before = h0 > 0 ? h / (h0 * (h0 + h)) : 0; // slope at the first end: of the differences before and after it
    const after = (h0 > 0 ? h0 / (h0 + h) : 1) / h;
    const inner = (h2 > 0 ? h2 / (h + h2) : 1) / h;
    const beyond = h2 > 0 ? h / (h2 * (h + h2)) : 0;
    weight[0] = -slope0 * before;
    weight[1] = 1 - value1 + slope0 * (before - after) - slope1 * inner;
    weight[2] = value1 + slope0 * after + slope1 * (inner - beyond);
    weight[3] = slope1 * beyond;
  }

  function cubic(c) {
    const v = columns[c];
    let sum = weight[1] * v[index];
    if (weight[0]) sum += weight[0] * v[index - 1];
    if (weight[2]) sum += weight[2] * v[index + 1];
    if (weight[3]) sum += weight[3] * v[index + 2];
    return sum;
  }

  function linear(c) {
    const v = columns[c];
    return part === 0 ? v[index] : v[index] + part * (v[index + 1] - v[index]);
  }

  function turnPose(p, c) {
    const next = part === 0 ? index : index + 1;
    let along = 0;
    for (let i = 0; i < 4; i++) along += columns[c + i][index] * columns[c + i][next];
    const angle = Math.acos(Math.min(1, along));
    const small = angle < 1e-4; // sines would lose digits
    const a = small ? 1 - part : Math.sin((1 - part) * angle) / Math.sin(angle);
    const b = small ? part : Math.sin(part * angle) / Math.sin(angle);
    let size = 0;
    for (let i = 0; i < 4; i++) {
      turn[4 * p + i] = a * columns[c + i][index] + b * columns[c + i][next];
      size += turn[4 * p + i] ** 2;
    }
    for (let i = 0; i < 4; i++) turn[4 * p + i] /= Math.sqrt(size) || 1;
  }

  function seek(t) {
    ({ index, part } = locate(times, t));
    weigh();
    for (let p = 1; p < poses; p++) {
      const c = 7 * (p - 1);
      for (let i = 0; i < 3; i++) place[3 * p + i] = cubic(c + i);
      turnPose(p, c + 3);
    }
  }

  seek(times[0]);
  return {
    times,
    place,
    turn,
    seek,
    cubic, // column -> its value, smooth
    linear, // column -> its value, for what may jump
    // out, an array from `at` on = place of [pose, x, y, z] in ground axes
    locate(point, out, at = 0) {
      const [p, x, y, z] = point;
      const w = turn[4 * p];
      const a = turn[4 * p + 1];
      const b = turn[4 * p + 2];
      const c = turn[4 * p + 3];
      // v + 2 q x (q x v + w v)
      const i = b * z - c * y + w * x;
      const j = c * x - a * z + w * y;
      const k = a * y - b * x + w * z;
      out[at] = place[3 * p] + x + 2 * (b * k - c * j);
      out[at + 1] = place[3 * p + 1] + y + 2 * (c * i - a * k);
      out[at + 2] = place[3 * p + 2] + z + 2 * (a * j - b * i);
    },
    // f(i) with the poses at n times, equally spaced, the start and the end among them
    scan(n, f) {
      for (let i = 0; i < n; i++) {
        seek(n > 1 ? times[0] + ((times[last] - times[0]) * i) / (n - 1) : times[0]);
        f(i);
      }
      seek(times[0]);
    },
  };
}
