# Shorter fixed steps of radau5 do not err more, down to round-off. The reference is a method of order 8 with step control.
# agrees BOUND STEP: columns of run.csv and reference.csv
agrees() {
  paste -d, reference.csv run.csv | awk -F, -v bound="$1" -v step="$2" '
    NR > 1 { n = NF/2; for (i = 2; i <= n; i++) { d = ($i - $(i + n))^2; if (d > worst) worst = d } }
    END { print "steps of " step ": " (sqrt(worst) < bound ? "within " bound : sqrt(worst)) }'
}
# A four-bar in space whose crank turns three times.
cat >model.yaml <<'EOF'
cotree: 1
name: four-bar in space
gravity: [0, 0, -9.81]
bodies:
  ground: {points: {D: [0.6, 0.2, 0]}}
  crank: {mass: 1, inertia: [1e-3, 2e-3, 2e-3], com: [0.05, 0, 0], points: {e: [0.1, 0, 0]}}
  coupler: {mass: 1, inertia: [1e-3, 0.03, 0.03], com: [0.3, 0, 0], points: {e: [0.62, 0, 0]}}
  rocker: {mass: 1, inertia: [1e-3, 0.01, 0.01], com: [0.15, 0, 0], points: {e: [0.3, 0, 0]}}
joints:
  A: {type: revolute, axis: z, from: ground, to: crank, initial: {q: 0.3, u: 6}}
  B: {type: spherical, from: crank.e, to: coupler}
  C: {type: universal, from: coupler.e, to: rocker.e, axes: [z, y]}
  D: {type: revolute, axis: y, from: ground.D, to: rocker, initial: {q: -1.2, guess: true}}
outputs: [A.q, A.u, D.q, D.u]
simulation: {duration: 3, interval: 0.25}
EOF
"$COTREE" simulate model.yaml --method dop853 --tolerance 1e-12 --quiet -o reference.csv
for step in 1e-3 5e-4 2.5e-4; do
  "$COTREE" simulate model.yaml --method radau5 --step $step --quiet -o run.csv
  agrees 1e-8 $step
done
# A body that tumbles about its middle axis: what the iteration leaves of speeds in each step adds up.
cat >model.yaml <<'EOF'
cotree: 1
name: tumbling body
bodies: {b: {mass: 1.7, inertia: [0.11, 0.23, 0.31, 0.02, -0.03, 0.01], com: [0.1, -0.2, 0.05], points: {p: [0.5, 0.3, 0.2]}}}
joints: {f: {type: free, from: ground, to: b, initial: {q: [0, 0, 0, 1, 0, 0, 0], u: [0.1, 0.1, 0.2, 0.01, 4, 0.02]}}}
outputs: [b.p.position, b.p.velocity, b.angular_velocity]
simulation: {duration: 20, interval: 0.25}
EOF
"$COTREE" simulate model.yaml --method dop853 --tolerance 1e-12 --quiet -o reference.csv
for step in 5e-3 2.5e-3 1.25e-3; do
  "$COTREE" simulate model.yaml --method radau5 --step $step --quiet -o run.csv
  agrees 1e-9 $step
done
# A million steps between a thousand samples are no more, though their round-off adds up.
"$COTREE" simulate "$SYSTEMS/pendulum/model.yaml" --method rk4 --step 1e-3 --until 1000 --samples 1001 --quiet -o run.csv --summary run.json
grep '"steps"' run.json | tr -d ' ,'
# Particles on rods, whose dependent coordinates are worn within a few steps: the error is that of dense matrices, which see it at once.
cat >model.yaml <<'EOF'
cotree: 1
gravity: [0, 0, -9.81]
bodies:
  ground: {points: {a: [0, 0, 0], b: [0.5, 0, 0]}}
  p: {type: particle, mass: 1}
  q: {type: particle, mass: 0.6}
  r: {type: particle, mass: 0.3}
joints:
  fp: {type: free, from: ground, to: p, initial: {q: [0.3, 0.4, -0.5], u: [0, 0, 0]}}
  fq: {type: free, from: ground, to: q, initial: {q: [0.7, 0.5, -0.3], u: [0, 0, 0]}}
  fr: {type: free, from: ground, to: r, initial: {q: [0.6, 0.9, -0.6], u: [0, 0, 0]}}
  d1: {type: distance, from: ground.a, to: p}
  d2: {type: distance, from: ground.b, to: q}
  d3: {type: distance, from: p, to: q}
  d4: {type: distance, from: q, to: r}
outputs: [p.position, q.position, r.position]
simulation: {duration: 2.5, interval: 0.05}
EOF
"$COTREE" simulate model.yaml --method dop853 --tolerance 1e-11 --quiet -o reference.csv
for step in 0.0167 0.0125 0.01 0.00714; do
  "$COTREE" simulate model.yaml --method rk4 --step $step --quiet -o run.csv
  agrees 2e-4 $step
done
