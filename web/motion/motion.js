// Section `motion`: the system in three dimensions, moved by the clock of the page.
//
//     track.js     samples -> poses at a time          links.js, solids.js   bodies
//     stage.js     WebGL, frames on demand             symbols.js, springs.js, beams.js
//     camera.js    views, orbit.js the reader's hands  traces.js, arrows.js, grid.js
//     parts.js     surfaces, picking, light            compass.js, labels.js, controls.js   around the picture

import { Vector2, Vector3 } from "three";
import { unpack } from "../packed.js";
import { createArrows, usualSize } from "./arrows.js";
import { createBeam } from "./beams.js";
import { createCamera } from "./camera.js";
import { colorOfBody, createColors } from "./colors.js";
import { createCompass } from "./compass.js";
import { createControls } from "./controls.js";
import { createGrid } from "./grid.js";
import { createLabels } from "./labels.js";
import { createLink } from "./links.js";
import { createOrbit } from "./orbit.js";
import { createParts } from "./parts.js";
import { createSolid } from "./solids.js";
import { createStretched } from "./springs.js";
import { createPoses, createStage } from "./stage.js";
import { createJoint } from "./symbols.js";
import { createTraces } from "./traces.js";
import { createTrack } from "./track.js";

const hasWebGL = () => Boolean(document.createElement("canvas").getContext("webgl2"));
const isSliding = (symbol) => symbol === "slider" || symbol === "cylindrical" || symbol === "screw";

// The vertical: the axis of ground that is up in the isometric view.
function verticalOf(views) {
  const up = views.iso.up.map(Math.abs);
  const k = up.indexOf(Math.max(...up));
  return [0, 1, 2].map((i) => (i === k ? 1 : 0));
}

// Corners of what a body's shapes fill, as [pose, x, y, z].
function cornersOf(group, pose) {
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
function placesOverRun(track, points, beams) {
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

function sizeOf(places) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  places.forEach((v, i) => {
    low[i % 3] = Math.min(low[i % 3], v);
    high[i % 3] = Math.max(high[i % 3], v);
  });
  return Math.max(...high.map((v, k) => v - low[k])) || 1;
}

// The radius of a pin: as large as fits between joints at the start.
function symbolSize(track, joints, size) {
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

async function addBodies(context, data, size) {
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

function addJoints(context, data, camera) {
  const { track } = context;
  const stretched = [];
  const up = new Vector3(...data.views[data.view].up);
  const facing = new Vector3(...data.views[data.view].right).cross(up);
  const vertical = new Vector3(...verticalOf(data.views));
  if (data.view === "iso") {
    up.copy(vertical);
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
    if (kinds.length) stretched.push(createStretched(context, [force.from.at, force.to.at], kinds, force.name));
  }
  return stretched;
}

// Points that leave paths: those of the model, and the ends of beams.
function tracedPoints(data, track) {
  const points = data.traces.map(({ body, at }) => ({ body, locate: (out, i) => track.locate(at, out, i) }));
  for (const { number, beam } of data.bodies.filter((body) => body.beam))
    for (const end of [0, beam.points - 1]) {
      const at = new Float64Array(4);
      at[0] = number;
      points.push({
        body: number,
        locate(out, i) {
          for (let k = 0; k < 3; k++) at[k + 1] = track.cubic(beam.column + 3 * end + k);
          track.locate(at, out, i);
        },
      });
    }
  return points.map(({ body, locate }) => ({ name: data.bodies[body].name, color: colorOfBody(body), locate }));
}

function labelledPlaces(data) {
  const middle = ({ held, number, beam }) => {
    if (beam) return [number, beam.length / 2, 0, 0];
    const own = held.filter(([pose]) => pose === number);
    if (!own.length) return [number, 0, 0, 0];
    const sum = own.reduce((s, at) => s.map((v, k) => v + at[k + 1] / own.length), [0, 0, 0]);
    return [number, ...sum];
  };
  const bodies = data.bodies.slice(1).map((body) => ({ name: body.name, at: middle(body), kind: "body", color: colorOfBody(body.number) }));
  const joints = data.joints.map(({ name, from, to }) => ({ name, at: to.body === 0 ? from.at : to.at, kind: "joint" }));
  return [...bodies, ...joints];
}

// element: <div id="motion-panel">, which holds a drawing of the start, for print and where there is no WebGL.
export async function createMotion(element, data, clock, lights) {
  if (!hasWebGL()) return;
  const [times] = await unpack(data.times);
  const columns = await unpack(data.samples);
  const track = createTrack(data.poses, times, columns);
  data.bodies.forEach((body, i) => (body.number = i));

  const view = document.createElement("div");
  const canvas = document.createElement("canvas");
  view.className = "motion-view";
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", "the mechanism; arrow keys turn it, + and - zoom, 0 shows all of it, x y z i are views");
  view.append(canvas);

  const vertical = verticalOf(data.views);
  const camera = createCamera(data.views, vertical, () => stage.invalidate());
  const stage = createStage(canvas, camera.camera);
  const { scene } = stage;
  element.prepend(view);
  element.classList.add("has-motion");
  const { colors, read } = createColors(view, () => stage.invalidate());
  const parts = createParts(colors);
  const poses = createPoses(scene, track, data.poses);
  poses.update();

  const held = data.bodies.flatMap((body) => [...body.held, ...(body.number ? [[body.number, ...(body.com ?? [0, 0, 0])]] : [])]);
  const bent = data.bodies.filter((body) => body.beam).map(({ number, beam }) => ({ pose: number, ...beam }));
  let places = placesOverRun(track, held, bent);
  let size = sizeOf(places);
  const s = symbolSize(track, data.joints, size);
  const context = { parts, poses, track, scene, s, light: parts.surface(colors.symbol), dark: parts.surface(colors.support),
    ofBody: (i) => parts.surface(colorOfBody(i)),
    nameOf: (i) => data.bodies[i].name,
  };

  const beams = await addBodies(context, data, size);
  const shaped = data.bodies.filter((body) => body.solids.length);
  if (shaped.length) {
    places = placesOverRun(track, [...held, ...shaped.flatMap(({ number }) => cornersOf(poses.groups[number], number))], bent);
    size = sizeOf(places);
  }
  const stretched = addJoints(context, data, camera);

  const traces = createTraces(parts, track, tracedPoints(data, track), size);
  const loads = data.forces.filter((f) => f.load !== undefined).map((f) => ({ name: f.name, at: f.to.at, column: f.load, torque: f.load + 3 }));
  const reactions = data.joints.map((j) => ({ name: j.name, at: j.to.at, column: j.reaction }));
  const most = usualSize(track, [...loads, ...reactions].map((f) => f.column));
  const loadArrows = createArrows(context, loads, parts.surface(colors.load), 0.22 * size, most);
  const reactionArrows = createArrows(context, reactions, parts.surface(colors.reaction), 0.22 * size, most);
  const grid = createGrid(places, data.normal ?? vertical, size, 4 * s, colors.line);
  scene.add(traces, loadArrows.group, reactionArrows.group, grid);

  const labels = createLabels(view, labelledPlaces(data), track, camera.camera);
  const compass = createCompass(view, camera, data.gravity);
  let bend = 1;

  function update() {
    track.seek(clock.time);
    poses.update();
    for (const move of beams) move(bend);
    for (const move of stretched) move();
    if (loadArrows.group.visible) loadArrows.update();
    if (reactionArrows.group.visible) reactionArrows.update();
    stage.invalidate();
  }

  const show = (object, on) => {
    object.visible = on;
    update();
  };
  reactionArrows.group.visible = false;
  labels.layer.hidden = data.bodies.length + data.joints.length > 24;
  const shown = [
    { text: "paths", on: true, set: (on) => show(traces, on) },
    loads.length && { text: "forces", on: true, set: (on) => show(loadArrows.group, on) },
    reactions.length && { text: "reactions", on: false, set: (on) => show(reactionArrows.group, on) },
    {
      text: "names",
      on: !labels.layer.hidden,
      set(on) {
        labels.layer.hidden = !on;
        stage.invalidate();
      },
    },
    { text: "grid", on: true, set: (on) => show(grid, on) },
  ].filter(Boolean);
  const fit = () => camera.fit(places, 6 * s);
  const look = (name) => {
    camera.look(name);
    fit();
  };
  createControls(element, {
    views: data.views,
    look,
    fit,
    shown,
    bend:
      beams.length &&
      ((factor) => {
        bend = factor;
        update();
      }),
  });
  createOrbit(canvas, camera, { 0: fit, Home: fit, x: () => look("x"), y: () => look("y"), z: () => look("z"), i: () => look("iso") });
  createPicking(canvas, parts, camera.camera, lights);
  lights.add(view);
  lights.subscribe((names) => {
    parts.light(names);
    stage.invalidate();
  });

  read();
  camera.look(data.view);
  stage.afterDrawing(() => {
    labels.draw(view.clientWidth, view.clientHeight);
    compass(view.clientWidth, view.clientHeight);
  });
  let isFirst = true;
  const resize = () => {
    const { clientWidth: width, clientHeight: height } = view;
    if (!width || !height) return;
    camera.resize(width, height);
    if (isFirst) fit();
    isFirst = false;
    stage.resize(width, height);
  };
  update();
  resize();
  new ResizeObserver(resize).observe(view);
  clock.subscribe(update);
}

// What the pointer is on is lit; a click keeps it.
function createPicking(canvas, parts, camera, lights) {
  const at = new Vector2();
  let down = null;
  const pick = (event) => {
    const box = canvas.getBoundingClientRect();
    at.set((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height);
    return parts.pick(at, camera);
  };
  const names = (event) => {
    const name = pick(event);
    return name === undefined ? [] : [name];
  };
  canvas.addEventListener("pointermove", (event) => {
    if (event.buttons === 0) lights.hover(names(event));
  });
  canvas.addEventListener("pointerleave", () => lights.hover([]));
  canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
  canvas.addEventListener("pointerup", (event) => {
    if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4) lights.light(names(event));
    down = null;
  });
}
