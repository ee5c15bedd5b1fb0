// Shapes that the model gives its bodies: box, cylinder, sphere, lines, triangles of a file.

import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  Color,
  CylinderGeometry,
  Line,
  LineBasicMaterial,
  Quaternion,
  SphereGeometry,
  Vector3,
} from "three";
import { unpack } from "../packed.js";

async function geometryOf(solid) {
  const [a, b, c] = solid.size;
  if (solid.kind === "box") return new BoxGeometry(a, b, c);
  if (solid.kind === "sphere") return new SphereGeometry(a, 40, 24);
  if (solid.kind === "cylinder") {
    const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), new Vector3(...solid.axis));
    return new CylinderGeometry(a, a, b, 48).applyQuaternion(turn);
  }
  const geometry = new BufferGeometry();
  if (solid.kind === "lines") return geometry.setFromPoints(solid.points.map((p) => new Vector3(...p)));
  const columns = await unpack(solid.corners);
  const corner = new Float32Array(3 * columns[0].length);
  columns.forEach((column, k) => column.forEach((v, i) => (corner[3 * i + k] = v)));
  geometry.setAttribute("position", new BufferAttribute(corner, 3));
  geometry.computeVertexNormals();
  return geometry;
}

// A surface without a colour of its own is lighter than bars of its body's.
const tint = (color) => new Color(color).lerp(new Color("#ffffff"), 0.3).getStyle();

// An object in axes of the body.
export async function createSolid(parts, solid, color, component) {
  const geometry = await geometryOf(solid);
  const object =
    solid.kind === "lines"
      ? parts.own(new Line(geometry, new LineBasicMaterial({ color: solid.color ?? color })), component)
      : parts.solid(geometry, parts.surface(solid.color ?? tint(color)), component, solid.kind !== "sphere");
  for (const [angle, ...axis] of solid.turns)
    object.quaternion.multiply(new Quaternion().setFromAxisAngle(new Vector3(...axis), angle));
  object.position.set(...solid.at);
  return object;
}
