# The same model gives the same bytes; the order of the file does not change the motion.
. "$(dirname "$0")/lib.sh"
for system in four_bar stewart tumbling_body governor; do
  m=$SYSTEMS/$system/model.yaml
  "$COTREE" simulate "$m" -o a.csv --quiet --until 0.2
  "$COTREE" simulate "$m" -o b.csv --quiet --until 0.2
  cmp a.csv b.csv && echo "$system: same bytes"
done
cat >forward.yaml <<'END'
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  ground: {points: {far: [0.5, 0, 0]}}
  crank: {mass: 0.4, inertia: 1.3e-3, com: [0.1, 0, 0], points: {end: [0.2, 0, 0]}}
  coupler: {mass: 1, inertia: 0.02, com: [0.25, 0, 0], points: {end: [0.5, 0, 0]}}
  rocker: {mass: 0.8, inertia: 0.01, com: [0.2, 0, 0], points: {end: [0.4, 0, 0]}}
joints:
  crank_pin: {type: revolute, from: ground, to: crank, initial: {q: pi/2, u: -12}}
  coupler_pin: {type: revolute, from: crank.end, to: coupler, initial: {q: -1.2, guess: true}}
  rocker_pin: {type: revolute, from: ground.far, to: rocker, initial: {q: 1.6, guess: true}}
  top_pin: {type: revolute, from: coupler.end, to: rocker.end, initial: {q: 1.2, guess: true}}
outputs: [crank_pin.q, rocker_pin.u, top_pin.force.x]
simulation: {duration: 2, samples: 11, tolerance: 1e-10}
END
cat >backward.yaml <<'END'
cotree: 1
simulation: {tolerance: 1e-10, samples: 11, duration: 2}
outputs: [top_pin.force.x, rocker_pin.u, crank_pin.q]
joints:
  top_pin: {initial: {guess: true, q: 1.2}, to: rocker.end, from: coupler.end, type: revolute}
  rocker_pin: {type: revolute, from: ground.far, to: rocker, initial: {q: 1.6, guess: true}}
  coupler_pin: {type: revolute, from: crank.end, to: coupler, initial: {q: -1.2, guess: true}}
  crank_pin: {type: revolute, from: ground, to: crank, initial: {q: pi/2, u: -12}}
bodies:
  rocker: {points: {end: [0.4, 0, 0]}, mass: 0.8, inertia: 0.01, com: [0.2, 0, 0]}
  coupler: {mass: 1, inertia: 0.02, com: [0.25, 0, 0], points: {end: [0.5, 0, 0]}}
  crank: {mass: 0.4, inertia: 1.3e-3, com: [0.1, 0, 0], points: {end: [0.2, 0, 0]}}
  ground: {points: {far: [0.5, 0, 0]}}
gravity: [0, -9.81, 0]
END
"$COTREE" simulate forward.yaml -o forward.csv --quiet
"$COTREE" simulate backward.yaml -o backward.csv --quiet
difference forward.csv backward.csv | awk '{ print ($1 < 1e-8) ? "same numbers" : $0 }'
