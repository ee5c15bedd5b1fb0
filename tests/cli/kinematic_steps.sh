# kinematics: a driven mechanism keeps its assembly mode, however far apart the samples are. Links of 1 m on feet D apart,
# nearly a parallelogram, pass a singular configuration where the rocker turns back within sqrt(1 - D) rad of the crank; at
# D = 1 they go straight through. Samples are compared with those of a run with a sample each thousandth of a second.
four_bar() {
  cat <<E
cotree: 1
bodies:
  ground: {points: {far: [$1, 0, 0]}}
  crank: {mass: 1, inertia: 0.1, points: {end: [1, 0, 0]}}
  coupler: {mass: 1, inertia: 0.1, points: {end: [1, 0, 0]}}
  rocker: {mass: 1, inertia: 0.1, points: {end: [1, 0, 0]}}
joints:
  A: {type: revolute, from: ground, to: crank, motion: pi/2 - $2*t}
  B: {type: revolute, from: crank.end, to: coupler, initial: {q: -pi/2, guess: true}}
  C: {type: revolute, from: ground.far, to: rocker, initial: {q: pi/2, guess: true}}
  D: {type: revolute, from: coupler.end, to: rocker.end, initial: {q: pi/2, guess: true}}
outputs: [B.q, C.q]
simulation: {duration: 12, interval: $3}
E
}

for case in "0.9 1.3 2" "0.99 1.3 2" "0.999 1.3 0.5" "0.9999 3 1" "0.999999 6.2 1" "1 3 1"; do
  set -- $case
  four_bar $1 $2 $3 >coarse.yaml
  four_bar $1 $2 0.001 >fine.yaml
  for f in coarse fine; do "$COTREE" kinematics $f.yaml -o $f.csv --quiet; done
  awk -F, -v h=$3 'FNR == 1 { next }
    NR == FNR { b[FNR - 2] = $2; c[FNR - 2] = $3; next }
    (FNR - 2) % (1000 * h) == 0 {
      i = (FNR - 2) / (1000 * h); db = b[i] - $2; dc = c[i] - $3; seen++
      if (db * db + dc * dc > 1e-18) bad++
    }
    END { printf "%d samples, %d of them elsewhere\n", seen, bad }' coarse.csv fine.csv
done
