// The mechanism as objects: bodies, joints, springs and beams, each in the group of the pose that it moves with.

import { Vector3 } from "three";
import { createBeam } from "./beams.js";
import { colorOfBody } from "./colors.js";
import { createLink } from "./links.js";
import { createSolid } from "./solids.js";
import { createStretched } from "./springs.js";
import { createHatch, createJoint, orient } from "./symbols.js";

const isSliding = (symbol) => symbol === "slider" || symbol === "cylindrical" || symbol === "screw";

// Displacements of a slider's `to` along its axis, least and most over the run [m].
function rangeOf(track, joint) {
  const a = new Float64Array(3);
  const b = new Float64Array(3);
  const axis = new Float64Array(3);
  const range = [Infinity, -Infinity];
  const [pose, ...at] = joint.from.at;
  const ahead = [pose, ...at.map((v, k) => v + joint.axes[0][k])];
  track.scan(200, () => {
    track.locate(joint.from.at, a);
    track.locate(joint.to.at, b);
    track.locate(ahead, axis);
    const s = (b[0] - a[0]) * (axis[0] - a[0]) + (b[1] - a[1]) * (axis[1] - a[1]) + (b[2] - a[2]) * (axis[2] - a[2]);
    range[0] = Math.min(range[0], s);
    range[1] = Math.max(range[1], s);
  });
  return range;
}

// Unit vector from a joint to the middle of what is held of a body; zero: it is there.
function directionTo(track, joint, body) {
  const at = new Float64Array(3);
  const p = new Float64Array(3);
  const sum = new Vector3();
  const end = joint.from.body === body.number ? joint.from : joint.to;
  track.locate(end.at, at);
  const points = body.held.length > 1 || !body.com ? body.held : [...body.held, [body.number, ...body.com]];
  for (const held of points) {
    track.locate(held, p);
    sum.add(new Vector3(p[0] - at[0], p[1] - at[1], p[2] - at[2]));
  }
  return sum.lengthSq() > 1e-12 ? sum.normalize() : sum.set(0, 0, 0);
}

// Returns what bends: a function of the factor for each beam.
export async function addBodies(context, data, size) {
  const { parts, poses } = context;
  const beams = [];
  for (const body of data.bodies) {
    const color = colorOfBody(body.number);
    const group = poses.groups[body.number];
    for (const solid of body.solids) group.add(await createSolid(parts, solid, color, body.name));
    const joints = data.joints.filter((j) => j.from.body === body.number || j.to.body === body.number);
    const moved = (j) => (j.to.body === 0 ? j.from.body : j.to.body);
    const onBlock = joints.some((j) => (isSliding(j.symbol) || j.symbol === "planar") && moved(j) === body.number);
    if (body.beam) beams.push(createBeam(context, body, body.number, parts.surface(color)));
    else if (body.number > 0 && !body.solids.length)
      createLink(parts, body, color, context.s, size, onBlock, joints.length).forEach((object) => group.add(object));
  }
  return beams;
}

// The same place of the same body?
const isSamePlace = (a, b, s) => a.body === b.body && a.at[0] === b.at[0] && Math.hypot(...[1, 2, 3].map((k) => a.at[k] - b.at[k])) < 0.1 * s;

// Hatched ground where a spring ends on it.
function addAnchors(context, force, facing) {
  const { track, s } = context;
  for (const [end, other] of [
    [force.from, force.to],
    [force.to, force.from],
  ]) {
    if (end.body !== 0) continue;
    const [at, far] = [new Float64Array(3), new Float64Array(3)];
    track.locate(end.at, at);
    track.locate(other.at, far);
    const out = new Vector3(...far).sub(new Vector3(...at));
    if (out.length() < s) continue;
    const anchor = createHatch(context, 4.4 * s, 3 * s, force.name);
    orient(anchor, out, facing);
    anchor.position.set(...at);
    context.poses.groups[0].add(anchor);
  }
}

// Returns what stretches: a function for each spring, damper and rod. vertical: the axis of ground that is up.
export function addJoints(context, data, vertical) {
  const { track } = context;
  const stretched = [];
  const up = new Vector3(...data.views[data.view].up);
  const facing = new Vector3(...data.views[data.view].right).cross(up);
  if (data.view === "iso") {
    up.set(...vertical);
    facing.addScaledVector(up, -facing.dot(up)).normalize();
  }
  for (const joint of data.joints) {
    const moving = data.bodies[joint.from.body === 0 ? joint.to.body : joint.from.body];
    const range = isSliding(joint.symbol) ? rangeOf(track, joint) : [0, 0];
    const isHeld = data.joints.some((j) => j !== joint && [j.from, j.to].some((end) => isSamePlace(end, joint.to, context.s)));
    createJoint(context, joint, { up, facing, toBody: directionTo(track, joint, moving), range, isHeld });
    const kinds = joint.symbol === "rod" ? ["rod"] : [joint.spring && "spring", joint.damper && !joint.spring && "damper"].filter(Boolean);
    if (kinds.length) stretched.push(createStretched(context, [joint.from.at, joint.to.at], kinds, joint.name));
  }
  for (const force of data.forces.filter((f) => f.from)) {
    const kinds = [force.spring && "spring", force.damper && "damper"].filter(Boolean);
    if (!kinds.length) continue;
    stretched.push(createStretched(context, [force.from.at, force.to.at], kinds, force.name));
    addAnchors(context, force, facing);
  }
  return stretched;
}
