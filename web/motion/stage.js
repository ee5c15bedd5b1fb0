// The picture: WebGL, light, and a frame whenever something has changed, never otherwise.

import { AmbientLight, DirectionalLight, Group, Quaternion, Scene, Vector3, WebGLRenderer } from "three";

// camera: of three.js; the light moves with it. Throws where there is no WebGL.
export function createStage(canvas, camera) {
  const renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
  const scene = new Scene();
  const lamp = new DirectionalLight(0xffffff, 2);
  const listeners = new Set();
  let asked = 0;
  let seen = true;
  let late = false;
  lamp.position.set(-0.3, 0.55, 0.78); // over the left shoulder, as in drawings
  camera.add(lamp);
  scene.add(camera, new AmbientLight(0xffffff, 2));

  function draw() {
    asked = 0;
    renderer.render(scene, camera);
    for (const listener of listeners) listener();
  }

  function invalidate() {
    late = !seen;
    if (seen && !asked) asked = requestAnimationFrame(draw);
  }

  new IntersectionObserver((entries) => {
    seen = entries[entries.length - 1].isIntersecting;
    if (seen && late) invalidate();
  }).observe(canvas);

  return {
    scene,
    invalidate,
    afterDrawing: (listener) => listeners.add(listener),
    resize(width, height) {
      renderer.setPixelRatio(Math.min(2, devicePixelRatio));
      renderer.setSize(width, height, false);
      draw(); // the canvas is empty now
    },
  };
}

// A group for each pose of a track, moved by `update`.
export function createPoses(scene, track, count) {
  const groups = Array.from({ length: count }, () => new Group());
  scene.add(...groups);
  return {
    groups,
    update() {
      const { place, turn } = track;
      groups.forEach((group, p) => {
        group.position.set(place[3 * p], place[3 * p + 1], place[3 * p + 2]);
        group.quaternion.set(turn[4 * p + 1], turn[4 * p + 2], turn[4 * p + 3], turn[4 * p]);
      });
    },
    // a direction in axes of pose p, in those of pose q now
    convert(direction, p, q) {
      const turnOf = (i) => new Quaternion(turnAt(track, i, 1), turnAt(track, i, 2), turnAt(track, i, 3), turnAt(track, i, 0));
      return new Vector3(...direction).applyQuaternion(turnOf(p)).applyQuaternion(turnOf(q).invert());
    },
  };
}

const turnAt = (track, pose, i) => track.turn[4 * pose + i];
