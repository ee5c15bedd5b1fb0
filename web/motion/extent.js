// How large things are: all that is to be in sight over the run, and symbols that fit between joints.

import { Vector3 } from "three";

// Corners of what a body's shapes fill, as [pose, x, y, z].
export function cornersOf(group, pose) {
  const corners = [];
  const p = new Vector3();
  group.updateMatrixWorld(true);
  for (const object of group.children) {
    const place = object.geometry?.getAttribute("position");
    for (let i = 0; place && i < place.count; i += Math.ceil(place.count / 60)) {
      p.fromBufferAttribute(place, i).applyMatrix4(object.matrix);
      corners.push([pose, p.x, p.y, p.z]);
    }
  }
  return corners;
}

// All places that are to be in sight, x y z one after the other, over the run.
export function placesOverRun(track, points, beams) {
  const seen = [];
  const p = new Float64Array(3);
  const add = (point) => {
    track.locate(point, p);
    seen.push(p[0], p[1], p[2]);
  };
  track.scan(60, () => {
    points.forEach(add);
    for (const { pose, column, points: n } of beams)
      for (let i = 0; i < n; i += 5) add([pose, ...[0, 1, 2].map((k) => track.linear(column + 3 * i + k))]);
  });
  return seen;
}

export function sizeOf(places) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  places.forEach((v, i) => {
    low[i % 3] = Math.min(low[i % 3], v);
    high[i % 3] = Math.max(high[i % 3], v);
  });
  return Math.max(...high.map((v, k) => v - low[k])) || 1;
}

// The radius of a pin: as large as fits between joints at the start.
export function symbolSize(track, joints, size) {
  const places = joints.map((joint) => {
    const p = new Float64Array(3);
    track.locate(joint.to.at, p);
    return p;
  });
  let nearest = Infinity;
  for (let i = 0; i < Math.min(places.length, 500); i++)
    for (let k = 0; k < i; k++) {
      const d = Math.hypot(...places[i].map((v, j) => v - places[k][j]));
      if (d > 0.008 * size) nearest = Math.min(nearest, d);
    }
  return Math.max(0.004 * size, Math.min(0.014 * size, 0.3 * nearest));
}
