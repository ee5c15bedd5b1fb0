# Implicit methods go on where corrections have come to round-off.
steps() { sed -n 's/^ *"steps": \([0-9]*\),$/\1/p' summary.json; }
# agrees BOUND: columns of run.csv and reference.csv
agrees() {
  paste -d, reference.csv run.csv | awk -F, -v bound="$1" '
    NR > 1 { n = NF/2; for (i = 2; i <= n; i++) { d = ($i - $(i + n))^2; if (d > worst) worst = d } }
    END { print (sqrt(worst) < bound ? "within " bound : sqrt(worst)) }'
}
# All coordinates are zero where the mechanism starts, its constraints are known to 1e-16 all the same.
echo "-- from zero"
bricard() { "$COTREE" simulate "$SYSTEMS/bricard/model.yaml" --until 0.2 --samples 11 --quiet "$@"; }
bricard --method dop853 --tolerance 1e-12 -o reference.csv
for method in generalized-alpha hht newmark; do
  printf '%s: ' "$method"
  bricard --method "$method" --tolerance 1e-8 -o run.csv && agrees 1e-7
done
# Steps so short that what round-off leaves of places, over a step, is most of what corrections are: they may grow as well as shrink.
echo "-- short steps"
cat >model.yaml <<'EOF'
cotree: 1
bodies:
  ground: {points: {g: [1.16, 0, 0]}}
  crank: {mass: 1, inertia: [0.02, 0.03, 0.03], com: [0.23, 0, 0], points: {tip: [0.46, 0, 0]}}
  coupler:
    type: beam
    length: 1.06
    elements: 2
    E: 7e9
    G: 2.7e9
    density: 2700
    modes: 2
    area: 1e-4
    Iy: 8e-10
    Iz: 8e-10
    rotary_inertia: true
    formulation: foreshortening
    frame: clamped
    initial: {v: 0.2*x^2*(length-x)}
    points: {tip: length}
  rocker: {mass: 1, inertia: [0.02, 0.03, 0.03], com: [0.4, 0, 0], points: {tip: [0.81, 0, 0]}}
joints:
  a: {type: revolute, from: ground, to: crank, initial: {q: 4.05, u: 1}}
  b: {type: revolute, from: crank.tip, to: coupler, initial: {q: 2.7, guess: true}}
  c: {type: revolute, from: coupler.tip, to: rocker.tip, initial: {q: -3.74, guess: true}}
  d: {type: revolute, from: ground.g, to: rocker, initial: {q: -6.79 rad, guess: true}}
outputs: [a.q, b.q, c.q, d.q, d.u]
simulation: {duration: 2e-6, samples: 11}
EOF
"$COTREE" simulate model.yaml --method dop853 --tolerance 1e-12 --quiet -o reference.csv
for method in radau5 generalized-alpha hht newmark; do
  printf '%s: ' "$method"
  "$COTREE" simulate model.yaml --method "$method" --step 1e-9 --quiet -o run.csv --summary summary.json && printf '%s steps, ' "$(steps)" && agrees 1e-9
done
echo '-- a tolerance below what steps can be held to says nothing of singular configurations that are far away'
cat >regular.yaml <<'END'
cotree: 1
bodies:
  a: {mass: 0.4}
  b: {mass: 0.7}
  rod: {mass: 1.1, inertia: 0.09, com: [0.3, 0, 0], points: {end: [0.8, 0, 0]}}
joints:
  across: {type: prismatic, axis: x, from: ground, to: a, initial: {q: 0.5, guess: true}}
  up: {type: prismatic, axis: y, from: ground, to: b, initial: {q: 0.5, guess: true}}
  turn: {type: revolute, from: a, to: rod, initial: {q: 2.2, u: 3.5}}
  end: {type: revolute, from: b, to: rod.end}
outputs: [across.q]
simulation: {duration: 1, samples: 2, tolerance: 1e-20}
END
"$COTREE" simulate regular.yaml --quiet -o regular.csv 2>&1
