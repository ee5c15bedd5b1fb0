// Beams: tubes about the axis as the element's own interpolation bends it, which may be exaggerated.
//
// Points of the axis are in axes of the body, equally spaced on the straight beam. Deflections are exaggerated about the beam
// as it is without them: where something holds both its ends, about the line between these, so that mechanisms stay together; else about the
// axis of the body. What always holds: at factor 1 the axis is as computed.

import { BufferAttribute, BufferGeometry, Vector3 } from "three";

const sides = 12;

function createTube(n) {
  const index = [];
  for (let i = 0; i + 1 < n; i++)
    for (let k = 0; k < sides; k++) {
      const a = i * sides + k;
      const b = i * sides + ((k + 1) % sides);
      index.push(a, b, a + sides, b, b + sides, a + sides);
    }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(3 * n * sides), 3));
  geometry.setAttribute("normal", new BufferAttribute(new Float32Array(3 * n * sides), 3));
  geometry.setIndex(index);
  return geometry;
}

// Rings across the axis (x y z of n points), turned from one to the next by no more than the axis bends.
function fillTube(geometry, axis, n, r) {
  const place = geometry.getAttribute("position");
  const normal = geometry.getAttribute("normal");
  for (let i = 0; i < n; i++) {
    const before = 3 * Math.max(0, i - 1);
    const after = 3 * Math.min(n - 1, i + 1);
    t.set(axis[after] - axis[before], axis[after + 1] - axis[before + 1], axis[after + 2] - axis[before + 2]).normalize();
    if (i === 0) u.set(Math.abs(t.z) < 0.9 ? 0 : 1, 0, Math.abs(t.z) < 0.9 ? 1 : 0);
    u.addScaledVector(t, -u.dot(t)).normalize();
    v.crossVectors(t, u);
    for (let k = 0; k < sides; k++) {
      const c = cosine[k];
      const d = sine[k];
      const at = i * sides + k;
      const x = c * u.x + d * v.x;
      const y = c * u.y + d * v.y;
      const z = c * u.z + d * v.z;
      normal.setXYZ(at, x, y, z);
      place.setXYZ(at, axis[3 * i] + r * x, axis[3 * i + 1] + r * y, axis[3 * i + 2] + r * z);
    }
  }
  place.needsUpdate = normal.needsUpdate = true;
}

const t = new Vector3();
const u = new Vector3();
const v = new Vector3();
const cosine = Array.from({ length: sides }, (_, k) => Math.cos((2 * Math.PI * k) / sides));
const sine = Array.from({ length: sides }, (_, k) => Math.sin((2 * Math.PI * k) / sides));

// Does something hold the beam at both ends?
function isHeldAtBothEnds(track, body, number) {
  const near = 1e-3 * body.beam.length;
  const ends = [
    [0, 0, 0],
    [body.beam.length, 0, 0],
  ];
  const p = new Float64Array(3);
  const q = new Float64Array(3);
  return ends.every((end, k) =>
    body.held.some((held) => {
      track.locate(held, p);
      if (k === 0) track.locate([number, 0, 0, 0], q);
      else
        track.locate(
          [number, ...[0, 1, 2].map((i) => track.cubic(body.beam.column + 3 * (body.beam.points - 1) + i))],
          q,
        );
      return Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]) < near;
    }),
  );
}

// number: of the body. Returns {update(factor)}; the tube is put into the body's group.
export function createBeam(context, body, number, material) {
  const { parts, poses, track, s } = context;
  const { column, points: n, length } = body.beam;
  const axis = new Float64Array(3 * n);
  const geometry = createTube(n);
  const mesh = parts.solid(geometry, material, body.name, false);
  const isChord = isHeldAtBothEnds(track, body, number);
  const chord = new Vector3();
  mesh.frustumCulled = false; // it moves in its group
  poses.groups[number].add(mesh);

  return function update(factor) {
    for (let i = 0; i < 3 * n; i++) axis[i] = track.cubic(column + i);
    const [x, y, z] = axis;
    if (isChord) chord.set(axis[3 * n - 3] - x, axis[3 * n - 2] - y, axis[3 * n - 1] - z);
    else chord.set(length, 0, 0);
    const x0 = isChord ? x : 0;
    const y0 = isChord ? y : 0;
    const z0 = isChord ? z : 0;
    for (let i = 0; factor !== 1 && i < n; i++) {
      const share = i / (n - 1);
      axis[3 * i] += (factor - 1) * (axis[3 * i] - x0 - share * chord.x);
      axis[3 * i + 1] += (factor - 1) * (axis[3 * i + 1] - y0 - share * chord.y);
      axis[3 * i + 2] += (factor - 1) * (axis[3 * i + 2] - z0 - share * chord.z);
    }
    fillTube(geometry, axis, n, 0.6 * s);
  };
}
