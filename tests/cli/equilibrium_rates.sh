# A loop in space of parallel and one tilted axis, which joints alone cannot follow: beams in equilibrium are driven. They start
# with the rates of the equilibrium while the driver moves on, in any tree: differences of equilibria for drivers a little
# ahead and behind give the same.
cat >loop.yaml <<'EOF'
cotree: 1
gravity: [0, 0, -9.81]
parameters: {ahead: 0}
bodies:
  ground: {points: {e: {at: [0.5, 0, 0], rotate: [x, 0.06]}}}
  crank: {mass: 0.2, inertia: [1e-4, 2e-4, 2e-4], com: [0.05, 0, 0], points: {pin: [0.1, 0, 0]}}
  rod: {type: beam, length: 0.5, elements: 2, density: 2700, E: 7e9, nu: 0.3, area: 1e-4, Iy: 8e-10, Iz: 9e-10, rotary_inertia: true, formulation: foreshortening, deformation: [bending-y, bending-z, torsion], initial: equilibrium, points: {mid: length/2, end: length}}
  rocker: {type: beam, length: 0.3, density: 2700, E: 7e9, nu: 0.3, area: 1e-4, Iy: 8e-10, Iz: 9e-10, rotary_inertia: true, formulation: foreshortening, deformation: [bending-y, bending-z, torsion], initial: equilibrium, points: {end: length}}
joints:
  drive: {type: revolute, from: ground, to: crank, motion: "0.4 + ahead + 3*t + t^2"}
  a: {type: revolute, from: crank.pin, to: rod, initial: {q: 0.2, guess: true}}
  b: {type: revolute, from: rod.end, to: rocker.end, initial: {q: 0.9, guess: true}}
  c: {type: revolute, from: ground.e, to: rocker, initial: {q: 1.6, guess: true}}
outputs: [c.q, a.q, rod.mid.position, rod.end.position, c.u, a.u, rod.mid.velocity, rod.end.velocity]
simulation: {duration: 0.01, samples: 2, tolerance: 1e-9}
EOF
for tree in joints absolute; do
  "$COTREE" simulate loop.yaml --tree $tree --quiet -o $tree.csv
done
"$COTREE" simulate loop.yaml --set ahead=3e-4 --quiet -o ahead.csv
"$COTREE" simulate loop.yaml --set ahead=-3e-4 --quiet -o behind.csv
cat joints.csv absolute.csv ahead.csv behind.csv | awk -F, '
  /^t/ { run++; line = 0; next }
  { line++; for (i = 2; i <= NF; i++) v[run, line, i] = $i; n = (NF - 1)/2 }
  function size(x) { return x < 0 ? -x : x }
  END {
    for (i = 2; i <= 2*n + 1; i++)
      for (line = 1; line <= 2; line++) {
        e = size(v[1, line, i] - v[2, line, i])
        if (e > trees) trees = e
      }
    for (i = 2; i <= n + 1; i++) {
      rate = 3*(v[3, 1, i] - v[4, 1, i])/6e-4
      e = size(rate - v[1, 1, n + i])
      if (e > off) off = e
    }
    if (run != 4 || n != 8) print run " runs, " n " places"
    print (trees < 1e-10 ? "trees agree" : trees), (off < 1e-6 ? "rates of the equilibrium" : off)
  }'
# A wire of a tenth of a millimetre that hangs out from a wall by a metre: q L^4/(8 EI) = 0.0195 m
cat >wire.yaml <<'EOF'
cotree: 1
gravity: [0, -0.01, 0]
bodies:
  wire: {type: beam, length: 1, elements: 4, density: 7800, E: 2e11, area: "pi*1e-8", Iz: "pi*1e-16/4", formulation: foreshortening, initial: equilibrium, points: {tip: length}}
joints: {w: {type: weld, from: ground, to: wire}}
outputs: [wire.tip.deflection.y]
simulation: {duration: 1e-5, samples: 2}
EOF
"$COTREE" simulate wire.yaml --quiet -o wire.csv
awk -F, 'NR == 2 { e = $2/0.0195 + 1; print (e*e < 1e-20 ? "wire at rest" : $2) }' wire.csv
