// Bodies without a shape, drawn from their frames: a bar between two places, a plate through more in a plane, bars from the middle to
// those that are not; a single place as what it is: a particle, a mass, axes.

import { BufferAttribute, BufferGeometry, SphereGeometry, Vector3 } from "three";

const distinct = 1e-6; // of the scene's size

// Places that joints, springs and forces hold, in axes of the body, each once.
export function placesOf(body, size) {
  const places = [];
  const add = (at) => {
    const p = new Vector3(...at);
    if (places.every((q) => q.distanceTo(p) > distinct * size)) places.push(p);
  };
  for (const [, ...at] of body.held) add(at);
  if (!places.length) add([0, 0, 0]);
  return { places, add };
}

// Does the line through two places lead on to a third one?
function extends_(a, b, c) {
  const d = b.clone().sub(a);
  const e = c.clone().sub(a);
  const part = e.dot(d) / d.lengthSq();
  return e.addScaledVector(d, -part).length() < 0.02 * d.length() && (part < -0.1 || part > 1.1);
}

// The normal of the plane through all places; null: there is none, they are on a line or in space.
function planeOf(places, size) {
  const [o, ...others] = places;
  const normal = new Vector3();
  for (const p of others)
    for (const q of others) {
      const n = p.clone().sub(o).cross(q.clone().sub(o));
      if (n.lengthSq() > normal.lengthSq()) normal.copy(n);
    }
  if (normal.length() < distinct * size * size) return null;
  normal.normalize();
  return places.every((p) => Math.abs(p.clone().sub(o).dot(normal)) < 0.01 * size) ? normal : null;
}

// Corners of the convex hull in a plane, counterclockwise (Andrew's monotone chain).
function hullOf(places, normal) {
  const a = new Vector3(1, 0, 0).cross(normal).lengthSq() > 0.1 ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0);
  const u = a.cross(normal).normalize();
  const v = normal.clone().cross(u);
  const sorted = places.map((p) => ({ p, x: p.dot(u), y: p.dot(v) })).sort((s, t) => s.x - t.x || s.y - t.y);
  const half = (points) => {
    const h = [];
    for (const c of points) {
      while (h.length > 1) {
        const [s, t] = h.slice(-2);
        if ((t.x - s.x) * (c.y - s.y) - (t.y - s.y) * (c.x - s.x) > 0) break;
        h.pop();
      }
      h.push(c);
    }
    return h.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())].map((c) => c.p);
}

function plate(parts, corners, color, name) {
  const geometry = new BufferGeometry();
  const triangles = [];
  for (let i = 2; i < corners.length; i++) triangles.push(corners[0], corners[i - 1], corners[i]);
  geometry.setFromPoints(triangles).computeVertexNormals();
  return parts.solid(geometry, parts.surface(color, 0.35), name, false);
}

// Centre of mass: a ball whose octants are dark and light.
function centre(parts, at, r, name) {
  const geometry = new SphereGeometry(r, 16, 12).toNonIndexed();
  const place = geometry.getAttribute("position");
  const color = new Float32Array(3 * place.count);
  const middle = new Vector3();
  for (let i = 0; i < place.count; i += 3) {
    middle.set(0, 0, 0);
    for (let k = 0; k < 3; k++) middle.add(new Vector3().fromBufferAttribute(place, i + k));
    color.fill(middle.x * middle.y * middle.z > 0 ? 0.05 : 1, 3 * i, 3 * i + 9);
  }
  geometry.setAttribute("color", new BufferAttribute(color, 3));
  const material = parts.surface("#ffffff").clone();
  material.vertexColors = true;
  const mesh = parts.solid(geometry, material, name, false);
  mesh.position.copy(at);
  return mesh;
}

// What a body is drawn as, in its axes. s: radius of a pin [m]; size: of the scene [m]; onBlock: a slider's block is what is seen of
// it; njoint: ends of joints that are seen.
export function createLink(parts, body, color, s, size, onBlock, njoint) {
  const objects = [];
  const material = parts.surface(color);
  const { places, add } = placesOf(body, size);
  const com = body.com && new Vector3(...body.com);
  const isHeld = places.length;
  if (com && (places.length < 2 || (places.length === 2 && extends_(...places, com)))) add(body.com);
  const hasCentre = places.length > isHeld;
  if (body.particle) {
    if (!onBlock) objects.push(parts.ball(1.5 * s, material, body.name));
    return objects;
  }
  const bar = (a, b) => objects.push(parts.bar(a, b, 0.5 * s, material, body.name));
  const normal = places.length > 2 ? planeOf(places, size) : null;
  if (places.length === 2) bar(...places);
  else if (normal) {
    const corners = hullOf(places, normal);
    objects.push(plate(parts, corners, color, body.name));
    corners.forEach((p, i) => bar(p, corners[(i + 1) % corners.length]));
  } else if (places.length > 2) {
    const middle = places.reduce((sum, p) => sum.add(p), new Vector3()).divideScalar(places.length);
    for (const p of places) bar(middle, p);
  } else {
    if (njoint === 0)
      for (const axis of [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)])
        bar(places[0], places[0].clone().addScaledVector(axis, 7 * s));
    if (com && !onBlock && njoint < 2) objects.push(centre(parts, com, 1.2 * s, body.name));
  }
  if (hasCentre) objects.push(centre(parts, com, 1.2 * s, body.name));
  return objects;
}
