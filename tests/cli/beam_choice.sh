# What `formulation: auto` chooses, and why, does not depend on the trees: driven hubs, one that a torque turns, a beam on a wall.
model() { # JOINT HUB
  cat >arm.yaml <<END
cotree: 1
gravity: [0, $2, 0]
bodies:
  hub: {mass: 1, inertia: 2, points: {rim: [0.2, 0, 0]}}
  arm: {type: beam, length: 4, elements: 3, density: 2700, E: 7e10, nu: 0.3, area: 2.4e-3, Iz: 2e-6, points: {tip: length}}
joints:
  axle: {from: ground, to: hub, $1}
  clamp: {type: weld, from: hub.rim, to: arm}
outputs: [arm.tip.deflection.y]
simulation: {duration: 8, samples: 3}
END
  for tree in auto joints absolute; do
    "$COTREE" check arm.yaml --tree $tree | sed -n 's/.*bending-z; \(.*\);.*/\1/p'
  done
}
model 'type: revolute, motion: "if(t < 8, t^2/32 + 2/pi^2*(cos(pi*t/4) - 1), t/2 - 2)"' 0
model 'type: revolute, motion: "if(t < 2, 0.03*t^2, 0.12*t - 0.12)"' 0
model 'type: revolute, effort: "20*(1 - cos(pi*t/4))"' 0
model 'type: weld' -0.1
