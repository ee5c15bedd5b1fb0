# simulate --verify where a second run could take the same steps as the first: long runs at tight tolerances, against closed forms,
# and single steps. What is told is between half the error and three times as much, and never nothing.
. "$(dirname "$0")/lib.sh"
# told s.json OUTPUT
told() { sed -n "/\"$1\": {/,/}/s/.*\"relative\": \([^,}]*\).*/\1/p" s.json; }
# judge WHAT TOLD TRUE
judge() {
  awk -v what="$1" -v told="$2" -v true="$3" 'BEGIN {
    print what, (2 * told > true && told < 3 * true) ? "is estimated well" : "errs by " true ", told " told }'
}

cat >spring.yaml <<'END'
cotree: 1
name: mass on a spring, 20 rad/s
bodies: {p: {mass: 2, inertia: 1}}
joints: {j: {type: prismatic, from: ground, to: p, stiffness: 800, initial: {q: 1, u: 0}}}
outputs: [j.q]
simulation: {duration: 200, samples: 401}
END
echo '-- a mass on a spring, 640 turns'
for method in auto dopri5 radau5; do
  "$COTREE" simulate spring.yaml -o r.csv --quiet --method $method --tolerance 1e-10 --verify --summary s.json
  judge $method "$(told j.q)" "$(awk -F, 'NR > 1 { e = $2 - cos(20 * $1); if (e < 0) e = -e; if (e > most) most = e }
    END { print most }' r.csv)"
done

# a = 2, c = 3 kg m^2, w = (6, 0, 8): L = (12, 0, 24), the axis goes round it at sqrt(720)/2
cat >rotor.yaml <<'END'
cotree: 1
name: symmetric body without moments
bodies: {p: {mass: 2, inertia: [2, 2, 3], points: {e: [0, 0, 1]}}}
joints: {j: {type: spherical, from: ground, to: p, initial: {u: [6, 0, 8]}}}
outputs: [{name: y, value: p.e.position.y}]
simulation: {duration: 500, samples: 401}
END
echo '-- a free top, 1000 turns'
for method in auto dopri5; do
  "$COTREE" simulate rotor.yaml -o r.csv --quiet --method $method --tolerance 1e-10 --verify --summary s.json
  judge $method "$(told y)" "$(awk -F, 'NR > 1 { w = sqrt(720); e = $2 + 12 / w * sin(w / 2 * $1)
    if (e < 0) e = -e; if (e > most) most = e } END { print most * w / 12 }' r.csv)"
done

# the place of the slider at the end: by extrapolation in quadruple precision, with the angle of the crank as the only coordinate
echo '-- one step, across a singular configuration'
cat >slider.yaml <<'END'
cotree: 1
name: slider-crank with a rod as long as its crank
gravity: [0, -9.81, 0]
bodies:
  ground: {points: {s: [0.9, 0.5, 0]}}
  crank: {mass: 0.8, inertia: 0.01, com: [0.1, 0.03, 0], points: {p: [0.3, 0, 0]}}
  rod: {mass: 0.5, inertia: 0.006, com: [0.12, 0, 0], points: {p: [0.3, 0, 0]}}
  slide: {mass: 0.7, inertia: 0.001}
joints:
  cj: {type: revolute, from: ground, to: crank, effort: 0.3*cos(3*t), initial: {q: 1.5697963267948967, u: 1.0570478215720236}}
  rj: {type: revolute, from: crank.p, to: rod, initial: {q: -3.1395926535897933, guess: true}}
  sj: {type: prismatic, from: ground, to: slide, initial: {q: 0.0005999998999999756, guess: true}}
  close: {type: revolute, from: rod.p, to: slide}
forces:
  sp: {type: spring, from: ground.s, to: slide, stiffness: 20, length: 0.4}
outputs: [sj.q]
simulation: {duration: 0.02096, samples: 2}
END
"$COTREE" simulate slider.yaml -o r.csv --quiet --tolerance 1e-4 --verify --summary s.json
awk -F, -v told="$(told sj.q)" 'NR == 3 {
    e = $2 / -1.0491399189532773427e-02 - 1; if (e < 0) e = -e
    print "slider", (told > 0 && (2 * told > e || e < 1e-12) ? "is estimated well" : "errs by " e ", told " told) }' r.csv

echo '-- what all runs agree on to the bit'
"$COTREE" simulate "$SYSTEMS/link_column/model.yaml" -o r.csv --tolerance 1e-10 --verify 2>&1 | sed -n '/^global/{s/, [^,]* s)$/)/;p;}'
