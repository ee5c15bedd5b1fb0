// The paths of points over the whole run.

import { BufferGeometry, Float32BufferAttribute, Group, Line, LineBasicMaterial } from "three";

const most = 2001; // places on a path
const still = 0.002; // of the scene's size: a point that moves less leaves no path

// points: [{name, color, locate(out, at)}]. Two of them that stay together leave one path.
export function createTraces(parts, track, points, size) {
  const group = new Group();
  const n = Math.min(most, 8 * track.times.length); // smooth between samples that are far apart
  const paths = points.map(() => new Float32Array(3 * n));
  track.scan(n, (row) => points.forEach((point, i) => point.locate(paths[i], 3 * row)));

  const moves = (path) => path.some((v, i) => Math.abs(v - path[i % 3]) > still * size);
  const same = (a, b) => a.every((v, i) => Math.abs(v - b[i]) < still * size);
  paths.forEach((path, i) => {
    if (!moves(path) || paths.slice(0, i).some((other) => same(path, other))) return;
    const geometry = new BufferGeometry().setAttribute("position", new Float32BufferAttribute(path, 3));
    const material = new LineBasicMaterial({ color: points[i].color, transparent: true, opacity: 0.8 });
    group.add(parts.own(new Line(geometry, material), points[i].name));
  });
  return group;
}
