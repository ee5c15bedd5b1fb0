# Round-off of places in forces is no error of steps.
# Two turning bodies on a damped spring, near the origin and two thousand kilometres away, where round-off errors of places shake the forces: what
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
# beside 1e6 m a round-off is 1e-10 m, which the motion amplifies by 1e4
paste -d, near.csv far.csv | awk -F, 'NR > 1 { n = NF/2; for (i = 2; i <= n; i++) { d = ($i - $(i + n))^2; if (d > E) E = d } }
  END { print "the same motion", (sqrt(E) < 1e-4 ? "within 1e-4" : sqrt(E)) }'

# A mass on a stiff bar that turns at 20 rad/s: steps that round-off keeps short may err by just less than what they would be refused for.
cat >bar.yaml <<'END'
cotree: 1
bodies:
  link: {points: {end: [1, 0, 0]}}
  particle: {mass: 1}
joints:
  hub: {type: revolute, from: ground, to: link, motion: "if(t < 1, 10*t^2 + 5/pi^2*(cos(2*pi*t) - 1), 20*t - 10)"}
  arm:
    type: custom
    from: link.end
    to: particle
    coordinates: [x, y]
    translate: ["1 + x", y, 0]
    effort:
      - "-6e5*(sqrt((1 + x)^2 + y^2) - 1)*(1 + x)/sqrt((1 + x)^2 + y^2) + 300*atan2(y, 1 + x)*y/((1 + x)^2 + y^2)"
      - "-6e5*(sqrt((1 + x)^2 + y^2) - 1)*y/sqrt((1 + x)^2 + y^2) - 300*atan2(y, 1 + x)*(1 + x)/((1 + x)^2 + y^2)"
outputs: [arm.q2]
simulation: {duration: 2, interval: 0.25}
END
for T in 6e-11 1e-10 1.2e-10 2e-10 3e-10 5e-10 1e-9; do
  "$COTREE" simulate bar.yaml --tolerance $T --quiet -o bar.csv --summary bar.json
  steps bar
done | awk '$1 > most { most = $1 } END { print "a stiff bar:", (most < 10000 ? "fewer than 10000 steps" : most " steps") }'

# A stiff damped spring ten metres from the origin: damping is no reason to follow round-off.
cat >damped.yaml <<'END'
cotree: 1
bodies: {a: {mass: 1}}
joints:
  s: {type: prismatic, from: ground, to: a, initial: {q: 10}, stiffness: 1e8, damping: 2e3, rest: 10, effort: sin(3*t)}
outputs: [s.q]
simulation: {duration: 0.2, samples: 101, tolerance: 1e-8, method: dop853}
END
"$COTREE" simulate damped.yaml --quiet -o damped.csv --summary damped.json
echo "a stiff damped spring: $([ "$(steps damped)" -lt 10000 ] && echo "fewer than 10000" || steps damped) steps"
