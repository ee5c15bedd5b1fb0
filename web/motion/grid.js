// A grid of round spacing: ground below what is in space, paper behind what is planar.

import { BufferGeometry, Float32BufferAttribute, LineBasicMaterial, LineSegments, Vector3 } from "three";

// 1, 2 or 5 times a power of ten, next below
export function roundBelow(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  return (x >= 5 * power ? 5 : x >= 2 * power ? 2 : 1) * power;
}

// points: x y z of all there is to see; normal: of the grid, which lies `below` [m] under all of it
export function createGrid(points, normal, size, below, color) {
  const n = new Vector3(...normal);
  const u = Math.abs(n.x) > 0.9 ? new Vector3(0, 1, 0) : new Vector3(1, 0, 0);
  u.addScaledVector(n, -u.dot(n)).normalize();
  const v = n.clone().cross(u);
  const axes = [u, v, n];
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  const p = new Vector3();
  for (let i = 0; i < points.length; i += 3) {
    p.fromArray(points, i);
    axes.forEach((axis, k) => {
      low[k] = Math.min(low[k], axis.dot(p));
      high[k] = Math.max(high[k], axis.dot(p));
    });
  }
  const step = roundBelow(size / 6);
  const from = [0, 1].map((k) => Math.floor(low[k] / step - 1));
  const to = [0, 1].map((k) => Math.ceil(high[k] / step + 1));
  const at = (i, k) => n.clone().multiplyScalar(low[2] - below).addScaledVector(u, i * step).addScaledVector(v, k * step);
  const corners = [];
  for (let i = from[0]; i <= to[0]; i++) corners.push(at(i, from[1]), at(i, to[1]));
  for (let k = from[1]; k <= to[1]; k++) corners.push(at(from[0], k), at(to[0], k));
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(corners.flatMap((c) => c.toArray()), 3));
  const material = new LineBasicMaterial({ transparent: true, opacity: 0.9 });
  material.color = color;
  return new LineSegments(geometry, material);
}
