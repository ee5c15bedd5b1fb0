// Joints by the symbols of the field, and what stands on ground hatched, as `cotree draw` has them.
//
// Sizes follow from s, the radius of a pin [m]. A symbol moves with the body that it belongs to.

import { CylinderGeometry, OctahedronGeometry, SphereGeometry, TorusGeometry, Vector3 } from "three";

const slides = (symbol) => symbol === "slider" || symbol === "cylindrical" || symbol === "screw";

// context: {parts, poses, s, light: surface of symbols, dark: of supports, ofBody(number): of a body, nameOf(number)}
function symbolOf({ parts, s, light, dark }, joint, name) {
  switch (joint.symbol) {
    case "pin":
      return [parts.cylinder(s, 2.6 * s, light, name)];
    case "slider":
      return [parts.box(2 * s, 3.2 * s, 2 * s, light, name)];
    case "cylindrical":
      return [parts.cylinder(s, 4.8 * s, light, name)];
    case "screw": {
      const rings = [-1.5, -0.5, 0.5, 1.5].map((at) => {
        const ring = parts.solid(new TorusGeometry(s, 0.2 * s, 8, 32).rotateX(Math.PI / 2), dark, name, false);
        ring.position.y = at * s;
        return ring;
      });
      return [parts.cylinder(0.9 * s, 4.4 * s, light, name), ...rings];
    }
    case "ball": {
      const socket = parts.solid(new SphereGeometry(1.45 * s, 24, 8, 0, 2 * Math.PI, Math.PI / 2, Math.PI / 2), dark, name, false);
      return [parts.ball(1.15 * s, light, name), socket];
    }
    case "planar":
      return [parts.box(4.5 * s, 0.4 * s, 4.5 * s, light, name)];
    case "weld":
      return [parts.box(1.5 * s, 1.5 * s, 1.5 * s, dark, name)];
    case "other":
      return [parts.solid(new OctahedronGeometry(1.6 * s), light, name)];
    default:
      return [];
  }
}

// Hatched: a plate of a width along x, its face up, lines below. Thickness along z.
export function createHatch({ parts, s, dark }, width, thickness, name) {
  const group = parts.stand([0, 0, 0]);
  const plate = parts.box(width, 0.25 * s, thickness, dark, name);
  plate.position.y = -0.12 * s;
  group.add(plate);
  const n = Math.max(3, Math.min(40, Math.round(width / (0.9 * s))));
  for (let i = 0; i < n; i++) {
    const line = parts.box(1.3 * s, 0.14 * s, 0.6 * thickness, dark, name);
    line.rotation.z = Math.PI / 4;
    line.position.set(((i + 0.5) / n - 0.5) * width - 0.25 * s, -0.65 * s, 0);
    group.add(line);
  }
  return group;
}

// A bearing on hatched ground: its tip is where it stands, ground is below (-y), z its axis.
function createBearing(context, name) {
  const { parts, s, light } = context;
  const group = parts.stand([0, 0, 0]);
  const body = parts.solid(new CylinderGeometry(0.35 * s, 1.7 * s, 2.4 * s, 4, 1).rotateY(Math.PI / 4), light, name);
  body.position.y = -1.2 * s;
  body.scale.z = 0.6;
  const hatch = createHatch(context, 4.4 * s, 1.6 * s, name);
  hatch.position.y = -2.4 * s;
  group.add(body, hatch);
  return group;
}

// Turns an object so that y points along `up` and z as nearly as possible along `axis`.
export function orient(object, up, axis) {
  const y = up.clone().normalize();
  const z = axis.clone().addScaledVector(y, -axis.dot(y));
  if (z.lengthSq() < 1e-6) z.set(y.z, y.x, y.y).addScaledVector(y, -(y.x * y.z + y.y * y.x + y.z * y.y));
  z.normalize();
  object.matrix.makeBasis(y.clone().cross(z), y, z);
  object.quaternion.setFromRotationMatrix(object.matrix);
}

// A joint's objects, each put into the group of the pose that it moves with.
//   up, facing: of the standard view [Vector3]; toBody: unit vector at the start from the joint to the moving body;
//   range: of the displacement of a slider's `to` along its axis [m]; isHeld: another joint is at its `to`
export function createJoint(context, joint, { up, facing, toBody, range, isHeld }) {
  const { parts, poses, s } = context;
  const { name, from, to } = joint;
  const onGround = from.body === 0 || to.body === 0;
  const atFrom = slides(joint.symbol) && to.body === 0; // the block belongs to what moves
  const end = atFrom ? from : to;
  const [pose, ...place] = end.at;
  const axis = joint.axes[0] ? poses.convert(joint.axes[0], from.at[0], pose) : new Vector3(0, 0, 1);

  if (isTelescope(joint, range, isHeld, s)) {
    addTelescope(context, joint, range);
    return;
  }
  if (joint.symbol === "universal") {
    const ends = [from, to];
    joint.axes.forEach((direction, k) => {
      const [p, ...at] = ends[k].at;
      const stand = parts.stand(at, direction);
      stand.add(parts.cylinder(0.5 * s, 3.4 * s, context.light, name));
      poses.groups[p].add(stand);
    });
  } else if (joint.symbol !== "weld" || !onGround) {
    const direction = joint.symbol === "ball" ? poses.convert(toBody, 0, pose) : axis;
    const stand = parts.stand(place, direction.lengthSq() > 0 ? direction : undefined);
    symbolOf(context, joint, name).forEach((object) => stand.add(object));
    poses.groups[pose].add(stand);
  }

  if (joint.symbol === "rod" || joint.symbol === "planar" || joint.symbol === "other") return;
  if (slides(joint.symbol)) addRail(context, joint, { up, facing, range, onGround });
  else if (onGround) addSupport(context, joint, { up, facing, toBody });
}

function addSupport(context, joint, { up, facing, toBody }) {
  const { poses, s } = context;
  const end = joint.from.body === 0 ? joint.from : joint.to;
  const [, ...at] = end.at;
  const isWall = joint.symbol === "weld";
  const support = isWall ? createHatch(context, 8 * s, 5 * s, joint.name) : createBearing(context, joint.name);
  const axis = joint.symbol === "pin" ? new Vector3(...joint.axes[0]) : facing;
  const out = isWall ? (toBody.lengthSq() > 0 ? toBody : up) : toBody.dot(up) < -0.5 ? up.clone().negate() : up;
  const across = Math.abs(out.clone().normalize().dot(axis.clone().normalize())) > 0.9 ? facing : axis;
  orient(support, out, across);
  support.position.set(...at);
  poses.groups[0].add(support);
}

// What a slider slides on: hatched ground beside it, or a bar of the body that guides it.
function addRail(context, joint, { up, facing, range, onGround }) {
  const { parts, poses, s } = context;
  const guide = onGround && joint.to.body === 0 ? joint.to : joint.from;
  const [pose, ...at] = guide.at;
  const axis = poses.convert(joint.axes[0], joint.from.at[0], pose);
  const sign = guide === joint.from ? 1 : -1;
  const ends = [sign * range[0], sign * range[1]].sort((a, b) => a - b);
  const along = (x) => new Vector3(...at).addScaledVector(axis, x);
  if (!onGround) {
    const [a, b] = [Math.min(0, ends[0] - 4 * s), Math.max(0, ends[1] + 4 * s)];
    poses.groups[pose].add(parts.bar(along(a), along(b), 0.5 * s, context.ofBody(guide.body), joint.name));
    return;
  }
  const rail = createHatch(context, ends[1] - ends[0] + 7 * s, 2.4 * s, joint.name);
  const out = up.clone().addScaledVector(axis, -up.dot(axis)); // the side that the hatching does not face
  if (out.lengthSq() < 0.1) out.copy(facing).cross(axis);
  orient(rail, out, out.clone().cross(axis));
  rail.position.copy(along((ends[0] + ends[1]) / 2)).addScaledVector(out.normalize(), -1.05 * s);
  poses.groups[pose].add(rail);
}

// A slider between two bodies that are held at its ends: a bar of each, the one in a sleeve at the end of the other.
function addTelescope(context, joint, range) {
  const { parts, poses, s } = context;
  const sign = range[0] > 0 ? 1 : -1;
  const [least, most] = range.map(Math.abs).sort((a, b) => a - b);
  const length = Math.min(least, 0.5 * most);
  for (const [end, way] of [
    [joint.from, sign],
    [joint.to, -sign],
  ]) {
    const [pose, ...at] = end.at;
    const axis = poses.convert(joint.axes[0], joint.from.at[0], pose).multiplyScalar(way);
    const foot = new Vector3(...at);
    const reach = end === joint.from ? length : Math.min(least, most - length + 2 * s);
    const tip = foot.clone().addScaledVector(axis, reach);
    poses.groups[pose].add(parts.bar(foot, tip, 0.5 * s, context.ofBody(end.body), context.nameOf(end.body)));
    if (end === joint.to) continue;
    const sleeve = parts.stand(tip.toArray(), axis);
    symbolOf(context, joint, joint.name).forEach((object) => sleeve.add(object));
    poses.groups[pose].add(sleeve);
  }
}

// Does a slider reach from one body to another, far enough to be seen?  isHeld: `to` is held by another joint, too
function isTelescope(joint, range, isHeld, s) {
  const isApart = range[0] * range[1] > 0 && Math.min(...range.map(Math.abs)) > 6 * s;
  return slides(joint.symbol) && joint.from.body > 0 && joint.to.body > 0 && isHeld && isApart;
}
