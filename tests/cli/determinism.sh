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

# Angles of chords: in a plane they are sums of others and whole turns, in space they are followed.
cat >turned.yaml <<'END2'
cotree: 1
parameters: {r: 0.15, l: 0.3, turns: -2}
bodies:
  crank: {mass: 0.35, inertia: 7e-4, com: [r/2, 0, 0], points: {pin: [r, 0, 0]}}
  rod: {mass: 0.7, inertia: 5.5e-3, com: [l/2, 0, 0], points: {pin: [l, 0, 0]}}
  slider: {mass: 0.5}
joints:
  main: {type: revolute, from: ground, to: crank, axis: [0, 0, -1], effort: 0.5, initial: {q: 20 rad, u: 10}}
  big_end: {type: revolute, from: crank.pin, to: rod, effort: "-0.05*big_end.q", initial: {q: 2*pi*turns - 2, guess: true}}
  small_end: {type: revolute, from: rod.pin, to: slider, axis: [0, 0, -1], initial: {q: 0.35, guess: true}}
  guide: {type: prismatic, from: ground, to: slider, axis: x, initial: {q: 0.4, guess: true}}
outputs: [main.q, big_end.q, small_end.q, big_end.u, guide.q, energy.total]
simulation: {duration: 3, interval: 0.01, tolerance: 1e-10, method: dop853}
END2
for turns in -2 0 3; do
  for tree in joints absolute; do
    "$COTREE" simulate turned.yaml --set turns=$turns --tree $tree -o plane.csv --quiet
    "$COTREE" simulate turned.yaml --set turns=$turns --tree $tree -o space.csv --quiet --keep-all
    difference plane.csv space.csv | awk -v what="turned by $turns, $tree" '{ print what ": " (($1 < 1e-8) ? "the same motion" : $0) }'
  done
  awk -F, 'NR == 2 { printf "big_end begins at %.3f\n", $3 }' plane.csv
done
