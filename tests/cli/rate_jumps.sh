# rate_jumps: continuous keeps the speeds of joints, whatever the trees; in a loop their changes have the least sum of squares
# that closes it, in any tree, and energy is balanced. What floats keeps its momentum.
cat >chain.yaml <<'EOF'
cotree: 1
bodies:
  a: {mass: 2, inertia: 0.3, com: [0.2, 0, 0], points: {end: [0.5, 0, 0]}}
  b: {mass: 1, inertia: 0.1, com: [0.4, 0, 0], points: {end: [0.8, 0, 0]}}
  c: {mass: 1, inertia: 0.1, com: [0.3, 0, 0]}
joints:
  x: {type: revolute, from: ground, to: a, motion: "if(t < 1, 0, 2*(t - 1))"}
  y: {type: revolute, from: a.end, to: b}
  z: {type: revolute, from: b.end, to: c}
outputs: [x.u, y.u, z.u, energy.total]
simulation: {rate_jumps: continuous, duration: 1, samples: 3}
EOF
cat >loop.yaml <<'EOF'
cotree: 1
bodies:
  ground: {points: {far: [1, 0, 0]}}
  a: {mass: 1, inertia: 0.1, com: [0.3, 0, 0], points: {end: [0.6, 0, 0]}}
  b: {mass: 1, inertia: 0.1, com: [0.5, 0, 0], points: {end: [1, 0, 0]}}
  c: {mass: 1, inertia: 0.1, com: [0.4, 0, 0], points: {end: [0.8, 0, 0]}}
  d: {mass: 1, inertia: 0.1, com: [0.3, 0, 0], points: {end: [0.6, 0, 0]}}
joints:
  x: {type: revolute, from: ground, to: a, motion: "2 + if(t < 1, 0, 2*(t - 1))"}
  y: {type: revolute, from: a.end, to: b, initial: {q: -1.2}}
  z: {type: revolute, from: b.end, to: c, initial: {q: -1.5, guess: true}}
  w: {type: revolute, from: c.end, to: d, initial: {q: -0.8, guess: true}}
  v: {type: revolute, from: ground.far, to: d.end, initial: {q: 2, guess: true}}
outputs: [x.u, y.u, z.u, w.u, v.u, constraint.velocity, energy.total]
simulation: {rate_jumps: continuous, duration: 1, samples: 3}
EOF
last() {
  "$COTREE" simulate "$@" -o r.csv --quiet
  tail -n 1 r.csv | tr , '\n' | awk '{ x = $1 < 0 ? -$1 : $1; printf "%s%.6g", (NR > 1 ? " " : ""), (x < 1e-8 ? 0 : $1) } END { print "" }'
}
cat >floating.yaml <<'EOF'
cotree: 1
bodies:
  a: {mass: 2, inertia: 0.3, points: {end: [0.5, 0, 0]}}
  b: {mass: 1, inertia: 0.1, com: [0.4, 0, 0], points: {end: [0.8, 0, 0]}}
  c: {mass: 1, inertia: 0.1, com: [0.3, 0, 0]}
joints:
  x: {type: revolute, from: a.end, to: b, motion: "if(t < 1, 0, 2*(t - 1))"}
  z: {type: revolute, from: b.end, to: c}
outputs: [x.u, z.u, system.momentum.x, system.momentum.y, system.angular_momentum.z]
simulation: {rate_jumps: continuous, duration: 1, samples: 3}
EOF
for chord in y z w v; do
    branches=$(echo 'x y z w v' | tr ' ' '\n' | grep -v "$chord" | tr '\n' ',')
    echo "{translation: [${branches%,}], rotation: [${branches%,}]}" >"$chord.yaml"
done
echo '-- chain: joints keep their speeds'
for tree in auto joints absolute; do last chain.yaml --tree "$tree"; done
echo '-- loop, each joint cut in turn'
for tree in auto joints absolute y.yaml z.yaml w.yaml v.yaml; do last loop.yaml --tree "$tree"; done
echo '-- floating'
for tree in auto joints absolute; do last floating.yaml --tree "$tree"; done
# Coordinates that are small: the jump is that of their equations of first order, the limit of a fast change of the rate. At rest
# in s, theta, of (L + s) long links behind one of length d whose rate jumps by W, s' jumps by -d theta W and theta' by
# -((L^2 + 2 L s) + d (L + s)) W/L^2. All terms would give -d sin(theta) W and -(1 + d cos(theta)/(L + s)) W.
cat >small.yaml <<'EOF'
cotree: 1
bodies:
  link: {points: {end: [0.6, 0, 0]}}
  particle: {mass: 1.5}
joints:
  hub: {type: revolute, from: ground, to: link, motion: "if(t < 1, 0, 3*(t - 1))"}
  arm:
    type: custom
    from: link.end
    to: particle
    coordinates: [s, theta]
    translate: ["(2 + s)*cos(theta)", "(2 + s)*sin(theta)", 0]
    initial: {q: [0.1, 0.2]}
outputs: [arm.u1, arm.u2]
simulation: {small: [arm], duration: 1, samples: 3}
EOF
echo '-- small coordinates: -0.36 -4.245'
last small.yaml

# An impulse takes speeds past the roots of switches: sign(u) is what tanh(u/eps) is for a small eps.
cat >drag.yaml <<'EOF'
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  a: {mass: 1, com: [0.3, 0, 0], inertia: 0.02, points: {end: [0.5, 0, 0]}}
  b: {mass: 2, com: [0.5, 0, 0], inertia: 0.17}
joints:
  x: {type: revolute, from: ground, to: a, motion: "if(t < 0.25, 1.6*t, 0.4 - 2.4*(t - 0.25))"}
  y: {type: revolute, from: a.end, to: b, initial: {q: -0.2}, effort: "-sign(y.u)*y.u^2"}
outputs: [y.u]
simulation: {duration: 0.5, samples: 3}
EOF
echo '-- switches after an impulse'
last drag.yaml
sed 's/sign(y.u)/tanh(y.u*1e6)/' drag.yaml >smooth.yaml
last smooth.yaml
