// Arrows of forces and torques that act from outside, and of what joints transmit.
//
// Lengths are proportional to forces, but none is longer than `most`; torques have a scale of their own.

import { ConeGeometry, CylinderGeometry, Group, TorusGeometry, Vector3 } from "three";

const y = new Vector3(0, 1, 0);
const visible = 0.02; // of a head: shorter arrows are left out
const direction = new Vector3();

// What is usual for the largest of some vectors: nine of ten samples have no larger one. Peaks as at a start do not make all others
// vanish.
function usualSize(track, columns) {
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

// forces: [{name, at: [pose, x, y, z], column, torque: column or undefined}]; most: length that no arrow exceeds [m].
// Returns {group, update(scale [m/N])}.
function createArrows({ parts, track, s }, forces, base, most) {
  const group = new Group();
  const material = inFront(base);
  const usualTorque = usualSize(track, forces.filter((f) => f.torque !== undefined).map((f) => f.torque));
  const place = new Float64Array(3);
  const items = forces.flatMap((f) => {
    const force = { at: f.at, column: f.column, isForce: true, ...straight(parts, s, material, f.name) };
    const torque = f.torque !== undefined && { at: f.at, column: f.torque, isForce: false, ...round(parts, s, material, f.name) };
    return torque ? [force, torque] : [force];
  });
  items.forEach((item) => group.add(item.group));

  return {
    group,
    update(scale) {
      for (const item of items) {
        const c = item.column;
        direction.set(track.linear(c), track.linear(c + 1), track.linear(c + 2));
        const size = direction.length();
        const length = item.isForce ? Math.min(most, scale * size) : Math.min(2, size / usualTorque);
        item.group.visible = size > 0 && length > (item.isForce ? visible * s : visible);
        if (!item.group.visible) continue;
        track.locate(item.at, place);
        item.group.position.set(place[0], place[1], place[2]);
        item.group.quaternion.setFromUnitVectors(y, direction.divideScalar(size));
        item.stretch(length);
      }
    },
  };
}

// The arrows of what acts from outside and of what joints transmit, on one scale.
// Returns {loads, reactions: arrows, or undefined where there are none; scale: [m/N], 0: none is seen; stretch(factor), update()}.
export function createForces(context, data, colors, size) {
  const { parts, track } = context;
  const loads = data.forces.filter((f) => f.load !== undefined).map((f) => ({ name: f.name, at: f.to.at, column: f.load, torque: f.load + 3 }));
  const reactions = data.joints.filter((j) => j.reaction !== undefined).map((j) => ({ name: j.name, at: j.to.at, column: j.reaction }));
  const usual = usualSize(track, [...loads, ...reactions].map((f) => f.column)) || 1;
  const arrows = (forces, color) => (forces.length ? createArrows(context, forces, parts.surface(color), 0.6 * size) : undefined);
  const all = [arrows(loads, colors.load), arrows(reactions, colors.reaction)];
  let scale = (0.2 * size) / usual;
  for (const one of all) if (one) context.scene.add(one.group);
  return {
    loads: all[0],
    reactions: all[1],
    get scale() {
      return all.some((one) => one?.group.visible) ? scale : 0;
    },
    stretch(factor) {
      scale = (0.2 * size * factor) / usual;
    },
    update() {
      for (const one of all) if (one?.group.visible) one.update(scale);
    },
  };
}
