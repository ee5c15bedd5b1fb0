# Two turning bodies on a damped spring, near the origin and two thousand kilometres away, where roundings of places shake the forces: what
# turns is not damped, so that these are no errors that shorter steps would make less.
model() {
  cat <<END
cotree: 1
bodies:
  a: {mass: 100, inertia: [3, 5, 6], points: {h: [0.5, 0, 0]}}
  b: {mass: 40, inertia: [1, 2, 2.5], points: {h: [-0.2, 0.1, 0]}}
joints:
  fa: {type: free, from: ground, to: a, initial: {q: [$1, $2, $3], rotate: [z, 0.4], u: [0, 0, 0, 0.1, 0.2, 0.3]}}
  fb: {type: free, from: ground, to: b, initial: {q: [$1 + 30, $2, $3, 1, 0, 0, 0], u: [0, 1, 0, 0.3, -0.2, 0.1]}}
forces:
  s: {type: spring, from: a.h, to: b.h, stiffness: 20, length: 28, damping: 0.5}
outputs: [s.length, s.force, a.angular_velocity, a.quaternion]
simulation: {duration: 30, samples: 16, tolerance: 1e-10}
END
}
model 0 0 0 >near.yaml
model 1e6 -2e6 3e5 >far.yaml
sed -i 's/q: \[\(1e6\|0\) + 30,/q: ["\1 + 30",/' near.yaml far.yaml
for m in near far; do
  "$COTREE" simulate $m.yaml --quiet -o $m.csv --summary $m.json
done
steps() { sed -n 's/.*"steps": \([0-9]*\).*/\1/p' "$1".json; }
[ "$(steps far)" -lt $((10 * $(steps near))) ] && echo "not ten times the steps far away" || echo "$(steps far) steps, near $(steps near)"
# beside 1e6 m a rounding is 1e-10 m, which the motion amplifies by 1e4
paste -d, near.csv far.csv | awk -F, 'NR > 1 { n = NF/2; for (i = 2; i <= n; i++) { d = ($i - $(i + n))^2; if (d > E) E = d } }
  END { print "the same motion", (sqrt(E) < 1e-4 ? "within 1e-4" : sqrt(E)) }'
