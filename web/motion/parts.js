// What the picture is made of: surfaces with dark edges, which know their component, can be picked and lit.

import {
  BoxGeometry,
  CapsuleGeometry,
  Color,
  CylinderGeometry,
  DoubleSide,
  EdgesGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  Quaternion,
  Raycaster,
  SphereGeometry,
  Vector3,
} from "three";

const sharp = 30; // [degrees]; a line is drawn where a surface bends by more
const y = new Vector3(0, 1, 0);

// colors: of colors.js
export function createParts(colors) {
  const surfaces = new Map(); // colour -> material
  const ofComponent = new Map(); // name -> objects
  const pickable = [];
  const edge = new LineBasicMaterial({ transparent: true, opacity: 0.75 });
  const litSurface = new MeshLambertMaterial({ side: DoubleSide });
  const litEdge = new LineBasicMaterial();
  const ray = new Raycaster();
  ray.params.Line.threshold = 0;
  edge.color = colors.edge; // shared: they follow the page
  litSurface.color = litSurface.emissive = colors["lit-line"];
  litSurface.emissiveIntensity = 0.35;
  litEdge.color = colors["lit-line"];

  // color: "#rrggbb", or a Color that is shared
  function surface(color, opacity = 1) {
    const key = `${Object.keys(colors).find((name) => colors[name] === color) ?? color} ${opacity}`;
    if (!surfaces.has(key)) {
      const material = new MeshLambertMaterial({ side: DoubleSide, opacity, transparent: opacity < 1 });
      material.polygonOffset = true; // edges lie before their surface
      material.polygonOffsetFactor = material.polygonOffsetUnits = 1;
      material.depthWrite = opacity === 1;
      material.color = color.isColor ? color : new Color(color);
      surfaces.set(key, material);
    }
    return surfaces.get(key);
  }

  function own(object, component) {
    object.userData.component = component;
    object.userData.material = object.material;
    if (!ofComponent.has(component)) ofComponent.set(component, []);
    ofComponent.get(component).push(object);
    if (object.isMesh) pickable.push(object);
    return object;
  }

  // A surface with its edges, a component's; edges: false where it is round.
  function solid(geometry, material, component, edges = true) {
    const mesh = own(new Mesh(geometry, material), component);
    if (edges) mesh.add(own(new LineSegments(new EdgesGeometry(geometry, sharp), edge), component));
    return mesh;
  }

  return {
    surface,
    own,
    solid,
    edge,
    box: (x, h, z, material, component) => solid(new BoxGeometry(x, h, z), material, component),
    ball: (r, material, component) => solid(new SphereGeometry(r, 24, 16), material, component, false),
    // along y
    cylinder: (r, length, material, component) => solid(new CylinderGeometry(r, r, length, 32), material, component),
    // A bar with round ends from a to b.
    bar(a, b, r, material, component) {
      const length = a.distanceTo(b);
      const mesh = solid(new CapsuleGeometry(r, length, 4, 16), material, component, false);
      mesh.position.copy(a).add(b).multiplyScalar(0.5);
      if (length > 0) mesh.quaternion.setFromUnitVectors(y, b.clone().sub(a).divideScalar(length));
      return mesh;
    },
    // An empty place, its y along a direction.
    stand(place, direction) {
      const group = new Group();
      group.position.set(...place);
      if (direction) group.quaternion.copy(new Quaternion().setFromUnitVectors(y, new Vector3(...direction).normalize()));
      return group;
    },
    // names: a Set of components that are lit now
    light(names) {
      for (const [name, objects] of ofComponent)
        for (const object of objects)
          object.material = names.has(name) ? (object.isMesh ? litSurface : litEdge) : object.userData.material;
    },
    // The nearest component at (x, y), -1 ... 1 over the picture; undefined: none.
    pick(at, camera) {
      ray.setFromCamera(at, camera);
      const hits = ray.intersectObjects(pickable, false);
      return hits.find((hit) => isSeen(hit.object))?.object.userData.component;
    },
  };
}

function isSeen(object) {
  for (let o = object; o; o = o.parent) if (!o.visible) return false;
  return true;
}
