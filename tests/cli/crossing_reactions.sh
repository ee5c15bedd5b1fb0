# Reactions and driver efforts on the way across singular configurations, where rows that come to depend carry loads without bound: what does
# not feel that is by hand.
echo '-- a parallelogram whose coupler is heavier on one side: the force across the crank, worst of 1001 samples within 10 T'
cat >heavier.yaml <<'END'
cotree: 1
parameters: {g: 9.81}
gravity: [0, -g, 0]
bodies:
  ground: {points: {far: [0.4, 0, 0]}}
  a: {mass: 1, inertia: 0.02, com: [0.25, 0, 0], points: {end: [0.5, 0, 0]}}
  b: {mass: 1, inertia: 0.02, com: [0.25, 0, 0], points: {end: [0.5, 0, 0]}}
  c: {mass: 2, inertia: 0.03, com: [0.1, 0, 0], points: {end: [0.4, 0, 0]}}
joints:
  A: {type: revolute, from: ground, to: a, initial: {q: 2, u: -7}}
  B: {type: revolute, from: ground.far, to: b, initial: {q: 2, guess: true}}
  C: {type: revolute, from: a.end, to: c, initial: {q: -2, guess: true}}
  D: {type: revolute, from: c.end, to: b.end, initial: {q: 2, guess: true}}
outputs: [A.q, C.force]
simulation: {duration: 1, samples: 1001}
END
# The coupler does not turn, all of it moves as the ends of the cranks do: J = 2 (I + m L^2/4) + M L^2 turns with their angle q, and what
# the coupler asks of a crank across it is what turns the other one and itself less than its weight. Along the crank the force is without bound.
across() {
  awk -F, -v T="$1" -v g="${2:-9.81}" 'NR > 1 {
    L = 0.5; m = 1; M = 2; I = 0.02 + m * L * L / 4
    acc = -g * cos($2) * (m * L + M * L) / (2 * I + M * L * L)
    force = (-I * acc - m * g * L / 2 * cos($2)) / L
    e = $4 - force; e = e < 0 ? -e : e
    worst = e > worst ? e : worst; size = force * force > size ? force * force : size }
    END { print (worst < 10 * T * sqrt(size) ? "within" : worst / sqrt(size)) }'
}
for options in '' '--method dopri5' '--method radau5' '--keep-all' '--keep-all --tree absolute' '--keep-all --method radau5' '--method newmark'; do
  for T in 1e-4 1e-6 1e-8 1e-10; do
    case $options$T in *newmark1e-8 | *newmark1e-10) continue ;; esac
    # shellcheck disable=SC2086
    "$COTREE" simulate heavier.yaml --tolerance $T --quiet -o heavier.csv $options
    printf '%s ' "$(across $T <heavier.csv)"
  done
  echo
done
echo '-- the force along the crank, which has a pole in the singular configuration: times the distance from it'
# The coupler does not turn: the cranks carry its vertical load in the ratio 3 to 1 of the distances from its mass centre.
sed 's/^outputs: .*/outputs: [A.q, C.force, A.u]/' heavier.yaml >along.yaml
for T in 1e-4 1e-6 1e-8; do
  "$COTREE" simulate along.yaml --tolerance $T --quiet -o along.csv
  awk -F, -v T=$T 'NR > 1 {
    L = 0.5; m = 1; M = 2; g = 9.81; I = 0.02 + m * L * L / 4; c = cos($2); s = sin($2)
    acc = -g * c * (m * L + M * L) / (2 * I + M * L * L)
    force = 0.75 * M * (L * (acc * c - $6 * $6 * s) + g)
    e = $3 * s + $4 * c - force; e = e < 0 ? -e : e
    worst = e > worst ? e : worst; size = force * force > size ? force * force : size }
    END { print (worst < 10 * T * sqrt(size) ? "within" : worst / sqrt(size)) }' along.csv
done
echo '-- two of them, the second so much further, whose positions are next to each other: the forces of both'
for apart in 0 0.001 0.003 0.03 0.1 0.3; do
  awk -v apart=$apart '/^bodies:|^joints:|^outputs:|^simulation:|^cotree|^param|^gravity/ { part = $1 }
    { line[n++] = $0; of[n - 1] = part }
    END { for (i = 0; i < n; i++) {
      if (line[i] ~ /^outputs/) { print "outputs: [A.q, C.force, zA.q, zC.force]"; continue }
      print line[i]
      if (line[i] ~ /^  [a-cA-D]: /) {
        copy = line[i]
        sub(/^  /, "  z", copy); gsub(/: ground.far/, ": ground.far", copy)
        gsub(/to: /, "to: z", copy); gsub(/from: /, "from: z", copy); gsub(/zground/, "ground", copy)
        if (copy ~ /q: 2,/) sub(/q: 2,/, "q: 2 + " apart ",", copy)
        if (copy ~ /q: -2,/) sub(/q: -2,/, "q: -2 - " apart ",", copy)
        print copy } } }' heavier.yaml >both.yaml
  for method in auto radau5; do
    for T in 1e-4 1e-6 1e-8; do
      "$COTREE" simulate both.yaml --tolerance $T --method $method --until 0.4 --quiet -o both.csv --summary s.json
      printf '%s %s, ' "$(cut -d, -f1-4 both.csv | across $T)" "$(cut -d, -f1,6-8 both.csv | across $T)"
    done
  done
  echo
done
echo '-- a run that ends there, and rows of a sweep'
"$COTREE" simulate heavier.yaml --tolerance 1e-8 --until 0.2665 --samples 3 --quiet -o ends.csv
across 1e-8 <ends.csv
"$COTREE" sweep heavier.yaml --vary g=9.81:9.85:3 --until 0.2665 --tolerance 1e-8 --quiet -o sweep.csv
tail -n +2 sweep.csv | while IFS=, read -r run g q x y rest; do
  printf 't,A.q,x,y\n0.2665,%s,%s,%s\n' "$q" "$x" "$y" | across 1e-8 "$g"
done
echo '-- a driven crank through the dead centres of a slider-crank of equal links: its effort by virtual power'
cat >driven.yaml <<'END'
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  crank: {mass: 1, inertia: 0.02, com: [0.1, 0, 0], points: {end: [0.3, 0, 0]}}
  rod: {mass: 1.2, inertia: 0.01, com: [0.12, 0, 0], points: {end: [0.3, 0, 0]}}
  s: {mass: 2, inertia: 0.01}
joints:
  A: {type: revolute, from: ground, to: crank, motion: "0.4 + 4*t + 0.3*sin(3*t)"}
  B: {type: revolute, from: crank.end, to: rod, initial: {q: -0.8, guess: true}}
  C: {type: revolute, from: rod.end, to: s, initial: {q: 0.4, guess: true}}
  D: {type: prismatic, from: ground, to: s, initial: {q: 0.55, guess: true}}
outputs: [A.q, A.u, A.a, A.effort]
simulation: {duration: 2, samples: 1001}
END
# The rod is turned by -q, the slider at 2 L cos q: with x, y of mass centres the effort is sum m (x' dx/dq + (y'' + g) dy/dq) + I q''.
effort() {
  awk -F, -v T="$1" 'NR > 1 {
    g = 9.81; L = 0.3; c = cos($2); s = sin($2); u = $3; a = $4
    # crank: 0.1 (c, s); rod: (0.42 c, 0.18 s); slider: (0.6 c, 0)
    e = (0.02 + 0.01) * a
    e += part(1, 0.1, 0.1) + part(1.2, 0.42, 0.18) + part(2, 0.6, 0)
    d = $5 - e; d = d < 0 ? -d : d
    worst = d > worst ? d : worst; size = e * e > size ? e * e : size }
    END { print (worst < 10 * T * sqrt(size) ? "within" : worst / sqrt(size)) }
    function part(m, x, y) { return m * (x * (-s * a - c * u * u) * x * -s + (y * (c * a - s * u * u) + g) * y * c) }'
}
for options in '' '--method radau5' '--keep-all'; do
  for T in 1e-4 1e-6 1e-8 1e-10; do
    # shellcheck disable=SC2086
    "$COTREE" simulate driven.yaml --tolerance $T --quiet -o driven.csv $options
    printf '%s ' "$(effort $T <driven.csv)"
  done
  echo
done
