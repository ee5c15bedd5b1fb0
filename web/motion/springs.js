// What stretches between two places: coil springs, dampers, rods.

import { CatmullRomCurve3, CylinderGeometry, Group, TubeGeometry, Vector3 } from "three";

const turns = 8;

function coil({ parts, s, dark }, name) {
  const points = [new Vector3(0, 0, 0)];
  const n = 12 * turns;
  for (let i = 0; i <= n; i++) {
    const angle = (2 * Math.PI * turns * i) / n;
    points.push(new Vector3(1.3 * s * Math.cos(angle), 0.12 + (0.76 * i) / n, 1.3 * s * Math.sin(angle)));
  }
  points.push(new Vector3(0, 1, 0));
  return parts.solid(new TubeGeometry(new CatmullRomCurve3(points), 3 * n, 0.16 * s, 6), dark, name, false);
}

// Unit length along y: a cylinder that ends in the middle, a rod into it.
function dashpot({ parts, s, dark, light }, name) {
  const group = new Group();
  const cylinder = parts.solid(new CylinderGeometry(0.7 * s, 0.7 * s, 0.4, 24), light, name);
  const rod = parts.solid(new CylinderGeometry(0.16 * s, 0.16 * s, 1, 12), dark, name, false);
  cylinder.position.y = 0.42;
  rod.position.y = 0.5;
  group.add(rod, cylinder);
  return group;
}

const y = new Vector3(0, 1, 0);

// ends: two [pose, x, y, z]; kinds: "spring", "damper", "rod". Returns what moves it: update().
export function createStretched(context, ends, kinds, name) {
  const { parts, track, scene, s } = context;
  const group = new Group();
  const a = new Float64Array(3);
  const b = new Float64Array(3);
  const along = new Vector3();
  const both = kinds.length > 1;
  kinds.forEach((kind, k) => {
    const object =
      kind === "spring"
        ? coil(context, name)
        : kind === "damper"
          ? dashpot(context, name)
          : parts.solid(new CylinderGeometry(0.35 * s, 0.35 * s, 1, 16).translate(0, 0.5, 0), context.dark, name, false);
    if (both && kind === "damper") object.position.x = 2.4 * s;
    group.add(object);
  });
  scene.add(group);
  return function update() {
    track.locate(ends[0], a);
    track.locate(ends[1], b);
    along.set(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    const length = along.length();
    group.visible = length > 0.1 * s;
    if (!group.visible) return;
    group.position.set(a[0], a[1], a[2]);
    group.quaternion.setFromUnitVectors(y, along.divideScalar(length));
    group.scale.set(1, length, 1);
  };
}
