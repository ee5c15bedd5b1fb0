// Arrows of forces and torques that act from outside, and of what joints transmit.
//
// Lengths are proportional to forces up to `peak` times the usual one; torques have a scale of their own.

import { ConeGeometry, CylinderGeometry, Group, TorusGeometry, Vector3 } from "three";

const y = new Vector3(0, 1, 0);
const visible = 5e-3; // of the usual size
const peak = 2; // times it: arrows become no longer
const direction = new Vector3();

// What is usual for the largest of some vectors: nine of ten samples have no larger one. Peaks as at a start do not make all others
// vanish.
export function usualSize(track, columns) {
  const sizes = [];
  track.scan(400, () => {
    let most = 0;
    for (const c of columns) most = Math.max(most, Math.hypot(track.linear(c), track.linear(c + 1), track.linear(c + 2)));
    sizes.push(most);
  });
  sizes.sort((a, b) => a - b);
  return sizes[Math.ceil(0.9 * (sizes.length - 1))] || sizes[sizes.length - 1];
}

// Along y from 0, its length set by `stretch`.
function straight(parts, s, material, name) {
  const group = new Group();
  const shaft = parts.solid(new CylinderGeometry(0.22 * s, 0.22 * s, 1, 12).translate(0, 0.5, 0), material, name, false);
  const head = parts.solid(new ConeGeometry(0.75 * s, 2.2 * s, 20).translate(0, -1.1 * s, 0), material, name, false);
  group.add(shaft, head);
  return {
    group,
    stretch(length) {
      const scale = Math.min(1, length / (3 * s)); // of the head of a short arrow
      head.scale.setScalar(scale);
      head.position.y = length;
      shaft.scale.y = Math.max(1e-6, length - 2 * s * scale);
    },
  };
}

// Three quarters of a turn about y, to the right.
function round(parts, s, material, name) {
  const group = new Group();
  const r = 3.2 * s;
  const arc = parts.solid(new TorusGeometry(r, 0.2 * s, 8, 40, 1.5 * Math.PI).rotateX(Math.PI / 2), material, name, false);
  const head = parts.solid(new ConeGeometry(0.75 * s, 2 * s, 20).rotateZ(-Math.PI / 2), material, name, false);
  arc.scale.z = -1; // now it turns to the right about y
  head.position.set(0, 0, r);
  head.rotation.y = 0;
  group.add(arc, head);
  return { group, stretch: (length) => group.scale.setScalar(0.6 + 0.4 * length) };
}

// Arrows lie before what they act on: a hundredth of the depth of the picture, in units of a depth buffer of 24 bits.
function inFront(material) {
  const copy = material.clone();
  copy.color = material.color;
  copy.polygonOffsetFactor = 0;
  copy.polygonOffsetUnits = -0.02 * 2 ** 24;
  return copy;
}

// forces: [{name, at: [pose, x, y, z], column, torque: column or undefined}]; longest [m]: of the
// force `most` [N].
export function createArrows({ parts, track, s }, forces, base, longest, most) {
  const material = inFront(base);
  const group = new Group();
  const mostTorque = usualSize(track, forces.filter((f) => f.torque !== undefined).map((f) => f.torque));
  const place = new Float64Array(3);
  const items = forces.flatMap((f) => {
    const one = { at: f.at, column: f.column, most, longest, ...straight(parts, s, material, f.name) };
    if (f.torque === undefined) return [one];
    return [one, { at: f.at, column: f.torque, most: mostTorque, longest: 1, ...round(parts, s, material, f.name) }];
  });
  items.forEach((item) => group.add(item.group));

  return {
    group,
    update() {
      for (const item of items) {
        const c = item.column;
        direction.set(track.linear(c), track.linear(c + 1), track.linear(c + 2));
        const size = direction.length();
        item.group.visible = size > visible * item.most;
        if (!item.group.visible) continue;
        track.locate(item.at, place);
        item.group.position.set(place[0], place[1], place[2]);
        item.group.quaternion.setFromUnitVectors(y, direction.divideScalar(size));
        item.stretch(Math.min(peak, size / item.most) * item.longest);
      }
    },
  };
}
