# Singular configurations that are hard to foresee. Motions that come to them slowly, held up by their forces: that of a parallelogram, in line at
# 0, whose crank a moment k q drives is known, q = q0 cosh(l t) - sqrt(q0^2 + (w/l)^2) sinh(l t) with w the speed that is left in line, and so
# is one with a driver.
parallelogram() {
  cat <<END
cotree: 1
parameters: {w: 0.05, l: "sqrt(8/0.175625)"}
bodies:
  ground: {points: {d: [0.4, 0, 0]}}
  crank: {mass: 1, inertia: 0.01, com: [0.125, 0, 0], points: {e: [0.25, 0, 0]}}
  rocker: {mass: 0.5, inertia: 0.02, com: [0.1, 0, 0], points: {e: [0.25, 0, 0]}}
  coupler: {mass: 2, inertia: 0.05, com: [0.2, 0, 0], points: {e: [0.4, 0, 0]}}
joints:
  a: {type: revolute, from: ground, to: crank, $1}
  b: {type: revolute, from: crank.e, to: coupler, initial: {q: -1, guess: true}}
  d: {type: revolute, from: ground.d, to: rocker, initial: {q: 1, guess: true}}
  c: {type: revolute, from: coupler.e, to: rocker.e}
outputs: [a.q, d.q]
simulation: {duration: 1.2, samples: 121}
END
}
# from the speed w in line on a small error of the start grows by 2 l^2/w e^(l t) from there on
motion='initial: {q: 1, u: "-sqrt(l^2 + w^2)"}, effort: "8*a.q"'
echo '-- with speeds left of 0.5 and 0.05 rad/s: the largest error is below 10 T times what errors of the start grow by'
parallelogram "$motion" >slow.yaml
for w in 0.5 0.05; do
  for T in 1e-4 1e-6 1e-8; do
    "$COTREE" simulate slow.yaml --set w=$w --tolerance $T --quiet -o slow.csv --summary s.json
    awk -F, -v w=$w -v T=$T 'NR > 1 {
        l = sqrt(8/0.175625); e = exp(l*$1); r = sqrt(1 + (w/l)^2)
        q = (e + 1/e)/2 - r*(e - 1/e)/2; grown = (e + 1/e)/2
        error = $2 - q; if (error < 0) error = -error
        other = $3 - $2; if (other < 0) other = -other
        if (error > 10*T*grown || other > 10*T*grown) { print w, T, "at", $1, "errs by", error, other; exit }
        }' slow.csv
    sed -n 's/.*"singular_positions_passed": \([0-9]*\).*/\1 passed/p' s.json
  done
done
echo '-- with a driver that slows down there'
parallelogram 'motion: "0.05*(1 - t) + (1 - t)^3"' >creep.yaml
for T in 1e-4 1e-6 1e-8 1e-10; do
    "$COTREE" simulate creep.yaml --tolerance $T --quiet -o creep.csv --until 2
    tail -n 1 creep.csv | awk -F, -v T=$T '{ d = $3 - $2; print (d*d < T*T ? "parallel" : d) }'
done
echo '-- the end of a run in a singular configuration is no reason to warn'
"$COTREE" simulate slow.yaml --set w=3 --until "$(awk 'BEGIN { l = sqrt(8/0.175625); x = l/3; print log(x + sqrt(x*x + 1))/l }')" --quiet -o end.csv
# Seen from far off, where its smallest pivot has only begun to fall, a singular configuration seems to be seconds away: crossings that fail there are
# none of the one that comes. With six such failures counted against it implicit methods were not carried across any more (E301, E308).
echo '-- implicit methods on two parallelograms one upon the other, three cranks in a row below, 14 and -11 rad/s'
cat >upon.yaml <<'END'
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  ground: {points: {b: [0.2, 0, 0], c: [0.5, 0, 0]}}
  c1: {mass: 0.4, inertia: 0.003, com: [0.1, 0, 0], points: {e: [0.2, 0, 0]}}
  c2: {mass: 0.4, inertia: 0.003, com: [0.06, 0, 0], points: {e: [0.2, 0, 0]}}
  c3: {mass: 0.4, inertia: 0.003, com: [0.1, 0, 0], points: {e: [0.2, 0, 0]}}
  p1: {mass: 1.5, inertia: 0.05, com: [0.25, 0, 0], points: {b: [0.2, 0, 0], c: [0.5, 0, 0], u: [0.1, 0, 0], v: [0.4, 0, 0]}}
  d1: {mass: 0.3, inertia: 0.002, com: [0.08, 0, 0], points: {e: [0.15, 0, 0]}}
  d2: {mass: 0.3, inertia: 0.002, com: [0.08, 0, 0], points: {e: [0.15, 0, 0]}}
  p2: {mass: 1, inertia: 0.03, com: [0.15, 0, 0], points: {e: [0.3, 0, 0]}}
joints:
  a1: {type: revolute, from: ground, to: c1, initial: {q: 1.2, u: 14}}
  a2: {type: revolute, from: ground.b, to: c2, initial: {q: 1.2, guess: true}}
  a3: {type: revolute, from: ground.c, to: c3, initial: {q: 1.2, guess: true}}
  b1: {type: revolute, from: c1.e, to: p1, initial: {q: -1.2, guess: true}}
  b2: {type: revolute, from: c2.e, to: p1.b, initial: {q: -1.2, guess: true}}
  b3: {type: revolute, from: c3.e, to: p1.c, initial: {q: -1.2, guess: true}}
  s1: {type: revolute, from: p1.u, to: d1, initial: {q: 0.4, u: -11}}
  s2: {type: revolute, from: p1.v, to: d2, initial: {q: 0.4, guess: true}}
  t1: {type: revolute, from: d1.e, to: p2, initial: {q: -0.4, guess: true}}
  t2: {type: revolute, from: d2.e, to: p2.e, initial: {q: -0.4, guess: true}}
outputs: [a1.q, s1.q, a2.q, s2.q, energy.total]
simulation: {duration: 3, samples: 31}
END
for run in radau5:1e-5 radau5:1e-7 generalized-alpha:1e-5 newmark:1e-5; do
    T=${run#*:}
    "$COTREE" simulate upon.yaml --method "${run%:*}" --tolerance "$T" --quiet -o upon.csv --summary s.json
    tail -n 1 upon.csv | awk -F, -v run="$run" '{ d = $2 - $4; e = $3 - $5; print run, (d*d + e*e < 1e-16 ? "parallel" : d " " e) }'
    sed -n 's/.*"energy_drift": \([^,]*\),.*/\1/p' s.json | awk -v T="$T" '!($1 < 10*T) { print "the energy drifts by " $1 }'
done
echo '-- inertias that cancel in a dead centre: what round-off leaves is told where the tolerance is less'
for T in 1e-6 1e-8; do
    "$COTREE" simulate "$(dirname "$0")/../reference/dead_centre.yaml" --tolerance $T --quiet -o dead.csv 2>&1 |
        sed -n 's/.*\(warning: the inertias .* cancel\).*/\1/p'
done
