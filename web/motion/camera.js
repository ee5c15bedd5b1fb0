// How the scene is looked at: parallel projection, along an axis, isometric or as the reader turns it.
//
// What always holds: (right, up, toward) are orthonormal, toward points to the eye; the middle of the picture is `target`; `height`
// is that of the picture [m].

import { Matrix4, OrthographicCamera, Quaternion, Vector3 } from "three";

// views: {NAME: {right, up}}; upward: the axis of ground that is up in `iso`; changed: called after each change.
export function createCamera(views, upward, changed) {
  const camera = new OrthographicCamera();
  const target = new Vector3();
  const right = new Vector3();
  const up = new Vector3();
  const toward = new Vector3();
  const vertical = new Vector3(); // what turning keeps upright
  const axes = new Matrix4();
  const turned = new Quaternion();
  const trial = new Vector3();
  let height = 1;
  let aspect = 1;
  let depth = 1; // half of the scene's [m]
  let version = 0; // how often it has changed
  let fitted; // the arguments of `fit`, until the reader moves the view

  function place() {
    version++;
    camera.position.copy(target).addScaledVector(toward, 2 * depth + height);
    axes.makeBasis(right, up, toward);
    camera.quaternion.setFromRotationMatrix(axes);
    camera.top = height / 2;
    camera.bottom = -camera.top;
    camera.right = camera.top * aspect;
    camera.left = -camera.right;
    camera.near = 0;
    camera.far = 4 * depth + 2 * height;
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    changed();
  }

  // All of the points (x y z, one after the other) are seen, `margin` [m] around them.
  function fit(points, margin) {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < points.length; i += 3) {
      trial.fromArray(points, i);
      [right, up, toward].forEach((axis, k) => {
        const at = axis.dot(trial);
        low[k] = Math.min(low[k], at);
        high[k] = Math.max(high[k], at);
      });
    }
    target.set(0, 0, 0);
    [right, up, toward].forEach((axis, k) => target.addScaledVector(axis, (low[k] + high[k]) / 2));
    depth = Math.max(...high.map((h, k) => h - low[k])) + 2 * margin;
    height = Math.max(high[1] - low[1] + 2 * margin, (high[0] - low[0] + 2 * margin) / aspect);
    fitted = [points, margin];
    place();
  }

  return {
    camera,
    target,
    right,
    up,
    toward,
    get height() {
      return height;
    },
    get version() {
      return version;
    },
    // What was all in sight stays so.
    resize(width, tall) {
      aspect = width / tall;
      if (fitted) fit(...fitted);
      else place();
    },
    look(name) {
      right.fromArray(views[name].right);
      up.fromArray(views[name].up);
      toward.crossVectors(right, up);
      vertical.fromArray(name === "iso" ? upward : views[name].up);
      place();
    },
    fit,
    // by angles about the vertical and about `right` [rad]; upside down is not reached
    turn(around, over) {
      fitted = undefined;
      turned.setFromAxisAngle(right, over);
      trial.copy(up).applyQuaternion(turned);
      if (trial.dot(vertical) > -1e-6) {
        up.copy(trial);
        toward.applyQuaternion(turned);
      }
      turned.setFromAxisAngle(vertical, around);
      for (const axis of [right, up, toward]) axis.applyQuaternion(turned).normalize();
      place();
    },
    // by parts of the height
    pan(x, y) {
      fitted = undefined;
      target.addScaledVector(right, x * height).addScaledVector(up, y * height);
      place();
    },
    // factor > 1: nearer; (x, y) stays where it is, from the middle in parts of the height
    zoom(factor, x = 0, y = 0) {
      fitted = undefined;
      const before = height;
      height = Math.min(40 * depth, Math.max(1e-4 * depth, height / factor));
      target.addScaledVector(right, x * (before - height)).addScaledVector(up, y * (before - height));
      place();
    },
  };
}
