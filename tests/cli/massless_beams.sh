# Motions of beams that move no mass are found on all trees, through sums of inertias that cancel, and what helps is said.

say() {
  for tree in auto joints absolute; do
    "$COTREE" simulate "$1" --tree $tree --quiet -o out.csv 2>&1 | sed -n 's/.*error: //p'
  done
}

echo '-- the mass at one point of an element leaves some of its motions none, rotary inertia or not'
for rotary in '[1e-4, 1e-4, 1e-4]' false; do
  cat >point.yaml <<END
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  rod: {type: beam, length: 1, theory: timoshenko, E: 2e9, nu: 0.3, shear_factor: 5/6, integration: one-point, area: 4e-4, Iz: 2e-8, density: 2000, rotary_inertia: $rotary, formulation: foreshortening, deformation: [axial, bending-z], points: {mid: 0.5*length, off: [0.3, 0.1, 0]}}
  bob: {mass: 0.5, inertia: 0.01, com: [0.2, 0, 0]}
joints:
  pin: {type: revolute, from: ground, to: rod.mid}
  hinge: {type: revolute, from: rod.off, to: bob}
outputs: [pin.q]
simulation: {duration: 0.05, samples: 3}
END
  say point.yaml
done
echo '-- a hinge on modes of a rod whose sections have no inertia'
cat >modes.yaml <<END
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  beam: {type: beam, length: 1, elements: 3, E: 2e9, area: 4e-4, Iz: 2e-8, density: 2000, formulation: stretch-linear, points: {tip: length}}
  rod: {type: beam, length: 1, elements: 2, theory: timoshenko, E: 2e9, nu: 0.3, shear_factor: 5/6, area: 4e-4, Iz: 2e-8, density: 2000, mass: lumped, modes: 3}
joints:
  wall: {type: weld, from: ground, to: beam}
  hinge: {type: revolute, from: beam.tip, to: rod}
outputs: [hinge.q]
simulation: {duration: 0.05, samples: 3}
END
say modes.yaml
echo '-- a loop: the beam that lacks the inertia is named, not the one that has it'
cat >loop.yaml <<END
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  ground: {points: {e: [1.5, -0.3, 0]}}
  bare: {type: beam, length: 1, theory: timoshenko, E: 2e9, nu: 0.3, shear_factor: 5/6, integration: reduced, area: 4e-4, Iz: 2e-8, density: 2000, formulation: force-only, modes: 3, deformation: [axial, bending-z], points: {tip: length}}
  rod: {type: beam, length: 1, E: 2e9, area: 4e-4, Iz: 2e-8, density: 2000, rotary_inertia: [1e-4, 1e-4, 1e-4], formulation: linear, points: {tip: length}}
  bar: {mass: 0.5, inertia: 0.01, points: {p: [0.5, 0, 0]}}
joints:
  j1: {type: revolute, from: ground, to: bare, initial: {q: 0.6}}
  j2: {type: revolute, from: bare.tip, to: rod, initial: {q: -0.8, guess: true}}
  j3: {type: revolute, from: rod.tip, to: bar, initial: {q: -0.5, guess: true}}
  j4: {type: revolute, from: ground.e, to: bar.p, initial: {guess: true}}
outputs: [j1.q]
simulation: {duration: 0.05, samples: 3}
END
say loop.yaml
echo '-- a lumped rod between a ball and a universal joint, and between two balls: the key of the beam, on all trees'
cat >between.yaml <<END
cotree: 1
gravity: [0, 0, -9.81]
bodies:
  crank: {mass: 1, inertia: [0.1, 0.1, 0.1], points: {e: [0.3, 0, 0]}}
  rod:
    type: beam
    length: 1.2
    elements: 2
    E: 7e10
    nu: 0.3
    area: 1e-4
    Iy: 8e-10
    Iz: 8e-10
    density: 2700
    mass: lumped
    frame: chord
    formulation: linear
    deformation: [axial, bending-y, bending-z]
    points: {tip: length}
  slider: {mass: 1, inertia: [0.1, 0.1, 0.1]}
joints:
  m: {type: revolute, axis: z, from: ground, to: crank, initial: {q: 0.7, u: 2}}
  ball: {type: spherical, from: crank.e, to: rod, initial: {guess: true}}
  end: {type: universal, axes: [y, z], from: slider, to: rod.tip, initial: {guess: true}}
  s: {type: prismatic, axis: x, from: ground, to: slider, initial: {q: 1.4, guess: true}}
outputs: [s.q]
simulation: {duration: 0.01, samples: 2}
END
sed 's/universal, axes: \[y, z\]/spherical/' between.yaml >balls.yaml
sed 's/elements: 2/elements: 1/' between.yaml >one.yaml
for model in between balls one; do
  for tree in auto joints absolute; do
    "$COTREE" simulate $model.yaml --tree $tree --quiet -o out.csv 2>&1 | grep 'error: '
  done
done
echo '-- modes that leave such a motion a little mass: it is told, and steps are long with what is advised'
cat >points.yaml <<END
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  rod: {type: beam, length: 1.095, elements: 2, theory: timoshenko, shear_factor: 0.85, integration: RULE, modes: 1, E: 7e10, nu: 0.3, density: 7800, area: 1.277e-4, Iy: 1.3e-9, Iz: 1.3e-9, rotary_inertia: true, formulation: linear, frame: chord, points: {p: length/2}}
  bob: {mass: 0.5, inertia: 0.01, com: [0.2, 0, 0]}
joints:
  pin: {type: revolute, from: ground, to: rod, initial: {q: 0.31}}
  hinge: {type: revolute, from: rod.p, to: bob, initial: {q: -0.9}}
outputs: [pin.q]
simulation: {duration: 1e-5, samples: 2}
END
for rule in one-point reduced; do
  sed "s/RULE/$rule/" points.yaml >rule.yaml
  for tree in joints absolute; do
    "$COTREE" simulate rule.yaml --method dop853 --tree $tree --summary rule.json -o rule.csv 2>&1 |
      sed -n 's/.*\(warning: the mass at\)/\1/p; s/.*: error: /error: /p'
    sed -n 's/^.*"steps": \([0-9]*\).*/\1/p' rule.json | awk '{ print ($1 > 40) ? "many steps" : "few steps" }'
  done
done
