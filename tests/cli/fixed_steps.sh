# A four-bar in space whose crank turns three times: shorter fixed steps of radau5 do not err more, down to rounding. The reference is
# a method of order 8 with step control.
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
  paste -d, reference.csv run.csv | awk -F, -v step=$step '
    NR > 1 { for (i = 2; i <= 5; i++) { d = ($i - $(i + 5))^2; if (d > worst) worst = d } }
    END { print "steps of " step ": " (sqrt(worst) < 1e-8 ? "within 1e-8" : sqrt(worst)) }'
done
