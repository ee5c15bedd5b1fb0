// Section `motion`: the system in three dimensions, moved by the clock of the page.
//
//     track.js       samples -> poses at a time       links.js, solids.js    bodies
//     stage.js       WebGL, frames on demand          symbols.js, springs.js, beams.js
//     mechanism.js   all that moves                   traces.js, arrows.js, grid.js
//     parts.js       surfaces that can be lit         camera.js, orbit.js    the view, the reader's hands
//     pick.js        the pointer and components       compass.js, labels.js, controls.js   around the picture

import { unpack } from "../packed.js";
import { createForces } from "./arrows.js";
import { createCamera } from "./camera.js";
import { colorOfBody, createColors } from "./colors.js";
import { createCompass } from "./compass.js";
import { createControls } from "./controls.js";
import { cornersOf, placesOverRun, sizeOf, symbolSize } from "./extent.js";
import { createGrid } from "./grid.js";
import { createLabels, labelledPlaces } from "./labels.js";
import { addBodies, addJoints } from "./mechanism.js";
import { createOrbit } from "./orbit.js";
import { createParts } from "./parts.js";
import { createPicking } from "./pick.js";
import { createPoses, createStage } from "./stage.js";
import { createTraces, tracedPoints } from "./traces.js";
import { createTrack } from "./track.js";

// The vertical: the axis of ground that is up in the isometric view.
function verticalOf(views) {
  const up = views.iso.up.map(Math.abs);
  const k = up.indexOf(Math.max(...up));
  return [0, 1, 2].map((i) => (i === k ? 1 : 0));
}

function createView() {
  const view = document.createElement("div");
  const canvas = document.createElement("canvas");
  view.className = "motion-view";
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", "the mechanism; arrow keys turn it, + and - zoom, 0 shows all of it, x y z i are views, space plays");
  view.append(canvas);
  return { view, canvas };
}

// The picture is as large as its place; the first time all is in sight.
function followSize(view, camera, stage, fit) {
  let isFirst = true;
  const resize = () => {
    const { clientWidth: width, clientHeight: height } = view;
    if (!width || !height) return;
    camera.resize(width, height);
    if (isFirst) fit();
    isFirst = false;
    stage.resize(width, height);
  };
  resize();
  new ResizeObserver(resize).observe(view);
}

// element: <div id="motion-panel">, which holds a drawing of the start, for print and where there is no WebGL.
// track, factors: in place of those of samples, see modes.js. Returns {update(), size, bar: the controls}; nothing where there is no WebGL.
export async function createMotion(element, data, clock, lights, { track = undefined, factors = undefined } = {}) {
  const { view, canvas } = createView();
  const vertical = verticalOf(data.views);
  const camera = createCamera(data.views, vertical, () => stage.invalidate());
  const stage = createStage(canvas, camera.camera);
  if (!stage) return undefined;
  const { scene } = stage;
  element.prepend(view);
  element.classList.add("has-motion");
  track ??= createTrack(data.poses, (await unpack(data.times))[0], await unpack(data.samples));
  data.bodies.forEach((body, i) => (body.number = i));

  const { colors, read } = createColors(view, () => stage.invalidate());
  const parts = createParts(colors);
  const poses = createPoses(scene, track, data.poses);
  poses.update();

  const held = data.bodies.flatMap((body) => [...body.held, ...(body.number ? [[body.number, ...(body.com ?? [0, 0, 0])]] : [])]);
  const bent = data.bodies.filter((body) => body.beam).map(({ number, beam }) => ({ pose: number, ...beam }));
  let places = placesOverRun(track, held, bent);
  let size = sizeOf(places);
  const s = symbolSize(track, data.joints, size);
  const context = {
    parts,
    poses,
    track,
    scene,
    s,
    light: parts.surface(colors.symbol),
    dark: parts.surface(colors.support),
    ofBody: (i) => parts.surface(colorOfBody(i)),
    nameOf: (i) => data.bodies[i].name,
  };

  const beams = await addBodies(context, data, size);
  const shaped = data.bodies.filter((body) => body.solids.length);
  if (shaped.length) {
    places = placesOverRun(track, [...held, ...shaped.flatMap(({ number }) => cornersOf(poses.groups[number], number))], bent);
    size = sizeOf(places);
  }
  const stretched = addJoints(context, data, vertical);

  const traces = createTraces(parts, track, tracedPoints(data, track), size);
  const forces = createForces(context, data, colors, size);
  const grid = createGrid(places, data.normal ?? vertical, size, 4 * s, colors.line);
  scene.add(traces, grid);

  const labels = createLabels(view, labelledPlaces(data), track, camera.camera);
  const compass = createCompass(view, camera, data.gravity);
  let bend = 1;

  function update() {
    track.seek(clock.time);
    poses.update();
    for (const move of beams) move(bend);
    for (const move of stretched) move();
    forces.update();
    stage.invalidate();
  }

  const show = (object, on) => {
    object.visible = on;
    update();
  };
  if (forces.reactions) forces.reactions.group.visible = false;
  labels.layer.hidden = data.bodies.length + data.joints.length > 24;
  const shown = [
    traces.children.length && { text: "paths", on: true, set: (on) => show(traces, on) },
    forces.loads && { text: "forces", on: true, set: (on) => show(forces.loads.group, on) },
    forces.reactions && {
      text: data.open_reactions ? "reactions (not unique)" : "reactions",
      title: data.open_reactions ? "constraints are redundant: these are one choice of many" : "forces that joints transmit to the second body",
      on: false,
      set: (on) => show(forces.reactions.group, on),
    },
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
  const fit = () => camera.fit(places, 6 * s + (factors ? 0.06 * size : 0)); // what swings leaves its places
  const look = (name) => {
    camera.look(name);
    fit();
  };
  const bar = createControls(element, {
    views: data.views,
    look,
    fit,
    shown,
    factors: factors ?? [
      beams.length && {
        text: "deflection",
        title: "how much larger than computed beams bend in the picture; a beam held at both ends bends about the line between them",
        most: 100,
        set(factor) {
          bend = factor;
          update();
        },
      },
      (forces.loads || forces.reactions) && {
        text: "arrows",
        title: "how long the arrows of forces are",
        least: 0.1,
        most: 100,
        set(factor) {
          forces.stretch(factor);
          update();
        },
      },
    ].filter(Boolean),
  });
  const toggle = () => (clock.playing ? clock.pause() : clock.play());
  createOrbit(canvas, camera, { " ": toggle, 0: fit, Home: fit, x: () => look("x"), y: () => look("y"), z: () => look("z"), i: () => look("iso") });
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
    compass(view.clientWidth, view.clientHeight, forces.scale);
  });
  update();
  followSize(view, camera, stage, fit);
  clock.subscribe(update);
  return { update, size, bar };
}
