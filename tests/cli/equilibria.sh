# Equilibria that are hard to find: upside down, loops with redundant rows in space and with beams, joints without
# stiffness, meshes whose soft directions are far below their stiff ones; the same on every tree.
. "$(dirname "$0")/lib.sh"

# rows NAME ARGUMENTS ...: outputs to 6 digits, and whether it is stable
rows() {
  name=$1
  shift
  "$COTREE" equilibrium "$name.yaml" "$@" -o out.csv 2>err || { sed 's/^.*error/error/; 2,$d' err; return; }
  awk -F, -v name="$name $*" 'NR > 1 {
    printf "%s:", name
    for (i = 2; i <= NF; i++) printf " %.6g", ($i < 1e-9 && $i > -1e-9) ? 0 : $i
  }' out.csv
  sed -n 's/^stability *\([a-z]*\).*/ \1/p' err
}

links='bodies:
  a: {mass: 1, inertia: 0.01, com: [0.5, 0, 0], points: {end: [1, 0, 0]}}
  b: {mass: 1, inertia: 0.01, com: [0.5, 0, 0], points: {end: [1, 0, 0]}}
joints:
  p: {type: revolute, from: ground, to: a, initial: {q: TILT deg}}
  q: {type: revolute, from: a.end, to: b, stiffness: 0}
outputs: [p.q, q.q]'
printf 'cotree: 1\ngravity: [0, -9.81, 0]\n%s\n' "$links" | sed 's/TILT/90/' >upside_down.yaml
printf 'cotree: 1\ngravity: [0, -9.81, 0]\n%s\n' "$links" | sed 's/TILT/89.9/' >falls.yaml
cat >nothing_holds.yaml <<'END'
cotree: 1
gravity: [0, -9.81, 0]
bodies: {s: {mass: 1, inertia: 0.01}}
joints: {x: {type: prismatic, axis: [0, 1, 0], from: ground, to: s, stiffness: 0}}
outputs: [x.q]
END
cat >loop.yaml <<'END'
cotree: 1
gravity: [0, 0, -9.81]
bodies:
  ground: {points: {far: [1, 0, 0]}}
  a: {mass: 1, inertia: [0.1, 0.1, 0.1], com: [0, 0, 0.5], points: {end: [0, 0, 1]}}
  b: {mass: 1, inertia: [0.1, 0.1, 0.1], com: [0.5, 0, 0], points: {end: [1, 0, 0]}}
  c: {mass: 1, inertia: [0.1, 0.1, 0.1], com: [0, 0, 0.5], points: {end: [0, 0, 1]}}
joints:
  j1: {type: revolute, axis: [0, 1, 0], from: ground, to: a, initial: {q: 0.2}}
  j2: {type: revolute, axis: [0, 1, 0], from: a.end, to: b, initial: {q: -0.2, guess: true}}
  j3: {type: revolute, axis: [0, 1, 0], from: b.end, to: c.end, initial: {q: 0.2, guess: true}}
  j4: {type: revolute, axis: [0, 1, 0], from: ground.far, to: c, initial: {q: 0.2, guess: true}}
outputs: [j1.q, j2.q]
END
cat >soft_loop.yaml <<'END'
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  ground: {points: {far: [1, 0, 0]}}
  a: {type: beam, length: 1, elements: 2, density: 2700, E: 7e10, nu: 0.3, area: 1e-5, Iy: 1e-12, Iz: 1e-12, points: {end: length}}
  b: {type: beam, length: 1.2, elements: 2, density: 2700, E: 7e10, nu: 0.3, area: 1e-5, Iy: 1e-12, Iz: 1e-12, points: {end: length}}
  c: {mass: 1, inertia: 0.1, com: [0.4, 0, 0], points: {end: [0.8, 0, 0]}}
joints:
  j1: {type: revolute, from: ground, to: a, initial: {q: 1.2}}
  j2: {type: revolute, from: a.end, to: b, initial: {q: -1.2, guess: true}}
  j3: {type: revolute, from: b.end, to: c.end, initial: {q: 0.2, guess: true}}
  j4: {type: revolute, from: ground.far, to: c, initial: {q: 1.2, guess: true}}
outputs: [j1.q, a.end.deflection.y]
END
# m g L^4/(8 E I) = 1.5e-5 m
cat >mesh.yaml <<'END'
cotree: 1
gravity: [0, 0, -0.01]
bodies:
  beam: {type: beam, length: 10, elements: 100, mass_per_length: 1, E: 1e7, nu: 0.3, area: 1, Iy: 1/12, Iz: 1/10, J: 1/6, points: {tip: length},
    deformation: [bending-y]}
joints: {clamp: {type: weld, from: ground, to: beam}}
outputs: [beam.tip.deflection.z]
END

# 100 elements in all families: sparse
sed 's/deformation: .*/deformation: [axial, bending-y, bending-z, torsion]}/' mesh.yaml >large_mesh.yaml
rows upside_down
rows falls
rows nothing_holds
rows loop
rows loop --keep-all
rows loop --keep-all --tree joints
for tree in auto joints absolute; do rows soft_loop --tree $tree; done
rows mesh
rows large_mesh

# Ziegler's column under a force that follows its tip, which the forces circle but do not come down to. With the moments of the weights
# G1, G2: -10 p - P/2 sin(q) + G1 = 0, -10 q + G2 = 0, solved apart: -0.0132778899, -0.0048631271 at P = 46, -0.0001492102, -0.0049616038 at 100.
cat >follower.yaml <<'END'
cotree: 1
gravity: [0.3, -0.2, 0]
parameters: {P: 46}
bodies:
  a: {mass: 2, inertia: 0.02, com: [0.25, 0, 0], points: {end: [0.5, 0, 0]}}
  b: {mass: 1, inertia: 0.02, com: [0.25, 0, 0], points: {end: [0.5, 0, 0]}}
joints:
  p: {type: revolute, from: ground, to: a, initial: {q: 0.01}, stiffness: 10, damping: 0.1}
  q: {type: revolute, from: a.end, to: b, stiffness: 10, damping: 0.05}
forces:
  push: {type: force, at: b.end, value: [-P, 0, 0], in: b}
outputs: [p.q, q.q]
END
rows follower
rows follower --set P=100

# Beck's beam, EI = 1, under a force that follows its tip: stable up to 20.051, without damping, so that growth at round-off is none.
cat >beck.yaml <<'END'
cotree: 1
parameters: {p: 10, n: 20}
bodies:
  beam: {type: beam, elements: n, length: 1, density: 1, E: 1e4, area: 1e-2, Iz: 1e-4, formulation: foreshortening, deformation: [bending-z], points: {tip: length}}
joints:
  clamp: {type: weld, from: ground, to: beam}
forces:
  push: {type: force, at: beam.tip, value: [-p, 0, 0], in: beam.tip}
outputs: [beam.tip.deflection.y]
END
rows beck --set p=5
rows beck --set p=10 --set n=40
rows beck --set p=20.05
rows beck --set p=20.06
