# A joint that starts more than a right angle from its guess gets a warning at the guess; the list shows guess and start.
. "$(dirname "$0")/lib.sh"
cat >far.yaml <<'END'
cotree: 1
bodies:
  ground: {points: {far: [0.5, 0, 0]}}
  a: {mass: 1, inertia: 1, points: {end: [0.2, 0, 0]}}
  b: {mass: 1, inertia: 1, points: {end: [0.5, 0, 0]}}
  c: {mass: 1, inertia: 1, points: {end: [0.4, 0, 0]}}
joints:
  crank: {type: revolute, from: ground, to: a, initial: {q: 1}}
  coupler: {type: revolute, from: a.end, to: b, initial: {q: 2.2, guess: true}}
  rocker: {type: revolute, from: ground.far, to: c, initial: {q: 3.2, guess: true}}
  top: {type: revolute, from: b.end, to: c.end}
simulation: {duration: 0.1, samples: 2}
END
"$COTREE" check far.yaml >out.txt 2>err.txt
cat err.txt
grep '^start' out.txt
