# Singular configurations passed, in the ledger and in the summary; of spatial rows most are redundant.
cat >parallelogram.yaml <<'END'
cotree: 1
name: parallelogram
gravity: [0, -9.81, 0]
bodies:
  ground: {points: {b: [1, 0, 0]}}
  left: {mass: 1, inertia: 0.0834, com: [0, 0.5, 0], points: {end: [0, 1, 0]}}
  right: {mass: 1, inertia: 0.0834, com: [0, 0.5, 0], points: {end: [0, 1, 0]}}
  coupler: {mass: 1, inertia: 0.0834, com: [0.5, 0, 0], points: {end: [1, 0, 0]}}
joints:
  a: {type: revolute, from: ground, to: left, initial: {q: 0, u: -1}}
  b: {type: revolute, from: ground.b, to: right, initial: {q: 0, guess: true}}
  c: {type: revolute, from: left.end, to: coupler, initial: {q: 0, guess: true}}
  d: {type: revolute, from: coupler.end, to: right.end, initial: {q: 0, guess: true}}
outputs: [a.q]
simulation: {duration: 4, tolerance: 1e-8}
END
for options in "" --keep-all "--tree joints" "--tree absolute"; do
    echo "-- $options"
    # shellcheck disable=SC2086
    "$COTREE" simulate parallelogram.yaml --summary s.json $options 2>out
    sed -n '/^singular/,/^seconds/p' out | grep -v '^seconds' | sed 's/\(t = [0-9.]\{5\}\)[0-9]*/\1/'
    grep -o '"rank_loss": .*' s.json | sort | uniq -c | tr -s ' '
    sed -n 's/.*"time": //p' s.json | tr -d , | awk '{ printf "%s%.4f", (NR > 1 ? " " : ""), $1 } END { print "" }'
done
echo '-- implicit methods, and a fixed step'
for method in radau5 generalized-alpha generalized-alpha-index3 newmark hht; do
    "$COTREE" simulate parallelogram.yaml --summary s.json --tolerance 1e-4 --method "$method" --quiet
    printf '%s %s\n' "$method" "$(sed -n 's/.*"singular_positions_passed": //p' s.json)"
done
"$COTREE" simulate parallelogram.yaml --method radau5 --step 0.002 --quiet -o fixed.csv 2>&1 | sed 's/t = [0-9.]*/t = T/'
# Long steps cross a singular configuration and choose other rows and columns near it: the crossing must be detected all the same.
echo '-- as many with tolerances of 5e-4 to 1e-8, in 10 s'
for w in 1 2 3 5; do
    sed "s/u: -1/u: -$w/;s/duration: 4/duration: 10/" parallelogram.yaml >faster.yaml
    for T in 5e-4 3e-4 2e-4 1e-4 1e-8; do
        "$COTREE" simulate faster.yaml --tolerance $T --quiet -o faster.csv --summary s.json
        sed -n 's/.*"singular_positions_passed": //p' s.json
    done | tr -d '\n'
    echo
done
echo '-- members of a sweep'
cat >isosceles.yaml <<'END'
cotree: 1
name: isosceles slider-crank
parameters: {g: 9.81}
gravity: [0, -g, 0]
bodies:
  crank: {mass: 1, inertia: 0.0834, com: [0.5, 0, 0], points: {end: [1, 0, 0]}}
  rod: {mass: 1, inertia: 0.0834, com: [0.5, 0, 0], points: {end: [1, 0, 0]}}
  block: {mass: 1, inertia: 0.01}
joints:
  pin: {type: revolute, from: ground, to: crank, initial: {q: 0.5, u: 3}}
  elbow: {type: revolute, from: crank.end, to: rod, initial: {q: -1, guess: true}}
  wrist: {type: revolute, from: rod.end, to: block, initial: {q: 0.5, guess: true}}
  slide: {type: prismatic, from: ground, to: block}
outputs: [slide.q, elbow.q]
simulation: {duration: 4, samples: 5, tolerance: 1e-9}
END
"$COTREE" sweep isosceles.yaml --vary g=9.5:10:5 -o sweep.csv --quiet
tail -n +2 sweep.csv | while IFS=, read -r run g q elbow status; do
    "$COTREE" simulate isosceles.yaml --set "g=$g" -o one.csv --quiet
    tail -n 1 one.csv | awk -F, -v run="$run" -v q="$q" -v elbow="$elbow" -v status="$status" \
        '{ d = $2 - q; e = $3 - elbow
           printf "%s %.5f %.5f %s %s\n", run, q, elbow, (d*d + e*e < 1e-16 ? "as alone" : "another"), status }'
done
echo '-- in a sweep, what is followed turns fast'
cat >turning.yaml <<'END'
cotree: 1
parameters: {w: 100}
bodies: {a: {mass: 1, inertia: 1}, b: {mass: 1, inertia: 1}}
joints:
  s: {type: revolute, from: ground, to: a, initial: {u: w}}
  c: {type: revolute, from: ground, to: b, initial: {u: -50}}
  rel: {type: revolute, from: a, to: b}
outputs: [rel.q]
simulation: {duration: 10, samples: 3}
END
"$COTREE" sweep turning.yaml --vary w=0:1000:5 -o sweep.csv --quiet
tail -n +2 sweep.csv | awk -F, '{ printf "%s %.6f %s\n", $1, $3, $4 }'

echo '-- starts in a singular configuration, all bars in line, and a shifted parallelogram'
start() {
  cat <<END
cotree: 1
bodies:
  ground: {points: {far: [1, 0, 0]}}
  crank: {mass: 1, inertia: 1/12, com: [0.5, 0, 0], points: {end: [1, 0, 0]}}
  coupler: {mass: 1, inertia: 1/12, com: [0.5, 0, 0], points: {end: [1, 0, 0]}}
  rocker: {mass: 1, inertia: 1/12, com: [0.5, 0, 0], points: {end: [1, 0, 0]}}
joints:
  A: {type: revolute, from: ground, to: crank, initial: {q: $1}}
  B: {type: revolute, from: crank.end, to: coupler, initial: {q: -$1, guess: true}}
  C: {type: revolute, from: coupler.end, to: rocker.end, initial: {q: $1, guess: true}}
  D: {type: revolute, from: ground.far, to: rocker, initial: {q: $1, guess: true}}
outputs: [A.q]
simulation: {duration: 0.1, interval: 0.1}
END
}
start 0 >in_line.yaml
start 1 >shifted.yaml
# the same with bars of 1, 2 and 1.5 m, folded back onto a base of 1.5 m: in line but for the last digit of pi
cat >folded.yaml <<'END'
cotree: 1
bodies:
  ground: {points: {far: [1.5, 0, 0]}}
  crank: {mass: 1, inertia: 1/12, com: [0.5, 0, 0], points: {end: [1, 0, 0]}}
  coupler: {mass: 1, inertia: 1/12, com: [0.5, 0, 0], points: {end: [2, 0, 0]}}
  rocker: {mass: 1, inertia: 1/12, com: [0.5, 0, 0], points: {end: [1.5, 0, 0]}}
joints:
  A: {type: revolute, from: ground, to: crank, initial: {q: 0, u: 0}}
  B: {type: revolute, from: crank.end, to: coupler, initial: {q: 0, guess: true}}
  C: {type: revolute, from: coupler.end, to: rocker, initial: {q: pi, guess: true}}
  D: {type: revolute, from: rocker.end, to: ground.far}
outputs: [A.q]
simulation: {duration: 0.1, interval: 0.1}
END
for options in '' '--keep-all' '--keep-all --tree absolute'; do
  for model in in_line shifted folded; do
    # shellcheck disable=SC2086
    "$COTREE" check "$model.yaml" $options 2>&1 | grep -e '^freedoms' -e warning || echo "exit $?"
  done
done

echo '-- moving in line at the start, but as no motion does: what the run says and, started near it, whether it goes on parallel'
start 0 | sed 's/{q: 0}/{q: 0, u: 3}/;s/{q: -0, guess: true}/{q: 0, u: -2}/' >moving.yaml
"$COTREE" simulate moving.yaml --quiet -o moving.csv 2>&1 | grep -o -e 'E3[0-9]*' -e 'note: give the rates of 2 joints'
start 1e-3 | sed 's/{q: 1e-3}/{q: 1e-3, u: 3}/;s/^outputs: .*/outputs: [A.q, D.q]/' >beside.yaml
"$COTREE" simulate beside.yaml --quiet -o beside.csv
tail -n 1 beside.csv | awk -F, '{ d = $2 - $3; print (d*d < 1e-16 && $2 > 0.2 ? "parallel" : d) }'

# Which rows are kept is chosen near a singular configuration, where all choices are poor: behind it the poor one must not stay.
# Kept, the rows of the platform lose their rank when the cranks hang down, and the energy is lost to 8e-8 at tolerances of 1e-9.
echo '-- a platform on five cranks: the energy within 10 T, whatever the tolerance'
cat >platform.yaml <<'END'
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  ground: {points: {b: [0.4, 0, 0], c: [1, 0, 0], d: [1.3, 0, 0], e: [2, 0, 0]}}
  A: {mass: 0.3, inertia: 0.01, com: [0.25, 0, 0], points: {end: [0.5, 0, 0]}}
  B: {mass: 0.4, inertia: 0.01, com: [0.25, 0, 0], points: {end: [0.5, 0, 0]}}
  C: {mass: 0.5, inertia: 0.01, com: [0.25, 0, 0], points: {end: [0.5, 0, 0]}}
  D: {mass: 0.6, inertia: 0.01, com: [0.25, 0, 0], points: {end: [0.5, 0, 0]}}
  E: {mass: 0.7, inertia: 0.01, com: [0.25, 0, 0], points: {end: [0.5, 0, 0]}}
  table: {mass: 3, inertia: 0.8, com: [0.9, 0.2, 0], points: {b: [0.4, 0, 0], c: [1, 0, 0], d: [1.3, 0, 0], e: [2, 0, 0]}}
joints:
  a: {type: revolute, from: ground, to: A, initial: {q: 1.2, u: -2}}
  aa: {type: revolute, from: A.end, to: table, initial: {q: -1.2, u: 2, guess: true}}
  b: {type: revolute, from: ground.b, to: B, initial: {q: 1.2, u: -2, guess: true}}
  bb: {type: revolute, from: B.end, to: table.b, initial: {q: -1.2, u: 2, guess: true}}
  c: {type: revolute, from: ground.c, to: C, initial: {q: 1.2, u: -2, guess: true}}
  cc: {type: revolute, from: C.end, to: table.c, initial: {q: -1.2, u: 2, guess: true}}
  d: {type: revolute, from: ground.d, to: D, initial: {q: 1.2, u: -2, guess: true}}
  dd: {type: revolute, from: D.end, to: table.d, initial: {q: -1.2, u: 2, guess: true}}
  e: {type: revolute, from: ground.e, to: E, initial: {q: 1.2, u: -2, guess: true}}
  ee: {type: revolute, from: E.end, to: table.e, initial: {q: -1.2, u: 2, guess: true}}
outputs: [A.end.position.x, A.end.position.y, table.velocity.x, table.velocity.y, a.u, e.u, energy.total]
simulation: {duration: 3, samples: 101}
END
for T in $(awk 'BEGIN { for (i = 24; i <= 60; i++) print 10^(-i/6) }'); do
  "$COTREE" simulate platform.yaml --quiet --tolerance $T --summary s.json
  sed -n 's/.*"energy_drift": \([^,]*\),.*/\1/p' s.json | awk -v T=$T '!($1 < 10 * T) { print T ": the energy drifts by " $1 }'
done

# Redundant rows may come to depend before all do, and steps choose others on their way: what is passed is to be seen all the same.
echo '-- the platform with each method: singular configurations, and by how much the rank falls'
for T in 1e-4 1e-6; do
  for method in auto dopri5 dop853 radau5 generalized-alpha generalized-alpha-index3 newmark hht; do
    "$COTREE" simulate platform.yaml --quiet --tolerance $T --method $method --summary s.json -o platform.csv
    printf '%s of %s ' "$(sed -n 's/.*"rank_loss": \([0-9]*\).*/\1/p' s.json | sort -u | paste -sd /)" \
        "$(sed -n 's/.*"singular_positions_passed": //p' s.json)"
  done
  echo
done
# speeds of index 3 are off the constraints where a crossing begins
for options in '' --keep-all; do
  # shellcheck disable=SC2086
  "$COTREE" simulate platform.yaml --quiet --tolerance 1e-7 --method generalized-alpha-index3 $options --summary s.json -o platform.csv
  sed -n 's/.*"singular_positions_passed": //p' s.json
done
echo '-- and of those that steps of fixed size come across, also where two loops lose rank at once'
for model in platform.yaml "$SYSTEMS/n_four_bar/model.yaml"; do
  for method in dopri5 rk4 newmark radau5; do
    "$COTREE" simulate "$model" --method $method --step 0.02 --until 3 --samples 3 --quiet -o fixed.csv 2>&1 |
      sed -n -e 's/.*warning: steps of fixed size \(.* at t = [0-9]\.[0-9]\).*/\1/p' -e 's/.*\[\(E305\)\]/\1/p' \
        -e 's/.*note: \(.* each other there ([a-z0-9]*\).*/\1/p'
  done
done
"$COTREE" simulate "$SYSTEMS/four_bar/model.yaml" --method dopri5 --step 0.02 --quiet -o fixed.csv

# A driver that comes to rest in a singular configuration, or changes its rate or acceleration there, tells nothing of how the motion goes on: that is said,
# with the rows, as no step ends so near to it that they are lost.
# Forces may switch there: singular_switching.sh.
echo '-- drivers that come to rest in a singular configuration, slowly and at once, and that begin to brake there'
for motion in '10*t^3 - 15*t^4 + 6*t^5' '3*t^2 - 2*t^3' t '1 + (t - 1) - (t - 1)^2'; do
  case $motion in 1*-*t*) after="1 + (t - 1) - (t - 1)^2" motion=t ;; *) after=1 ;; esac
  sed "s|initial: {q: 0, u: -1}|motion: \"-pi/2*if(t < 1, $motion, $after)\"|" parallelogram.yaml >rests.yaml
  "$COTREE" simulate rests.yaml --quiet -o rests.csv 2>&1 | grep -o '([a-z.]*): .*drivers may not rest there'
done

# Its rows are a thousandth of those of the large loop; its singular configuration must be detected all the same: the energy within 10 T.
echo '-- a parallelogram of half a millimetre on the crank of one of half a metre'
cat >small.yaml <<'END'
cotree: 1
parameters: {g: 9.81}
gravity: [0, -g, 0]
bodies:
  ground: {points: {b: [0.8, 0, 0], c: [-0.6e-3, 0, 0]}}
  A: {mass: 0.7, inertia: 0.02, com: [0.2, 0.05, 0], points: {e: [0.5, 0, 0], f: [0.2e-3, 0.45e-3, 0]}}
  B: {mass: 0.3, inertia: 0.01, com: [0.25, 0, 0], points: {e: [0.5, 0, 0]}}
  P: {mass: 1.2, inertia: 0.2, com: [0.4, 0.1, 0], points: {b: [0.8, 0, 0]}}
  C: {mass: 1e-9, inertia: 1e-16, com: [0.1e-3, 0.2e-3, 0], points: {e: [0.2e-3, 0.45e-3, 0]}}
  S: {mass: 2e-9, inertia: 1e-16, com: [-0.3e-3, 0, 0], points: {c: [-0.6e-3, 0, 0]}}
joints:
  a: {type: revolute, from: ground, to: A, initial: {q: 0.7, u: -7}}
  b: {type: revolute, from: ground.b, to: B, initial: {q: 0.7, guess: true}}
  c: {type: revolute, from: ground.c, to: C, initial: {q: 0.7, guess: true}}
  pa: {type: revolute, from: A.e, to: P, initial: {q: -0.7, guess: true}}
  pb: {type: revolute, from: B.e, to: P.b}
  sa: {type: revolute, from: A.f, to: S, initial: {q: -0.7, guess: true}}
  sc: {type: revolute, from: C.e, to: S.c}
outputs: [a.q, c.q]
simulation: {duration: 3, samples: 4}
END
for options in '' --keep-all; do
  for T in 1e-4 1e-6 1e-8 1e-10; do
    # shellcheck disable=SC2086
    "$COTREE" simulate small.yaml --quiet --tolerance $T --summary s.json -o small.csv $options
    sed -n 's/.*"energy_drift": \([^,]*\),.*/\1/p' s.json | awk -v T=$T '!($1 < 10 * T) { print T ": the energy drifts by " $1 }'
    printf '%s ' "$(sed -n 's/.*"singular_positions_passed": //p' s.json)"
  done
  echo
done
"$COTREE" sweep small.yaml --vary g=9.5:10:5 --tolerance 1e-8 -o sweep.csv --quiet
tail -n +2 sweep.csv | while IFS=, read -r run g q c status; do
  "$COTREE" simulate small.yaml --tolerance 1e-10 --set "g=$g" -o one.csv --quiet
  tail -n 1 one.csv | awk -F, -v run="$run" -v q="$q" -v c="$c" -v status="$status" \
    '{ d = $2 - q; e = $3 - c; print run, (d*d + e*e < 1e-12 ? "as alone" : sqrt(d*d + e*e)), status }'
done

# Of its three rows one is redundant, and each vanishes somewhere: it is exchanged there for another, as a single one, too.
echo '-- a double slider with a crank to the middle of its bar'
cat >exchanged.yaml <<'END'
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  X: {mass: 0.5, inertia: 0.01}
  Y: {mass: 0.9, inertia: 0.01}
  bar: {mass: 1, inertia: 0.06, com: [0.3, 0, 0], points: {end: [0.8, 0, 0], middle: [0.4, 0, 0]}}
  crank: {mass: 0.4, inertia: 0.01, com: [0.15, 0, 0], points: {end: [0.4, 0, 0]}}
joints:
  px: {type: prismatic, from: ground, to: X, axis: x, initial: {q: 0.66, guess: true}}
  py: {type: prismatic, from: ground, to: Y, axis: y, initial: {q: 0.45, guess: true}}
  rx: {type: revolute, from: X, to: bar, initial: {q: pi - 0.6, u: -5}}
  ry: {type: revolute, from: bar.end, to: Y}
  a: {type: revolute, from: ground, to: crank, initial: {q: 0.6, guess: true}}
  m: {type: revolute, from: crank.end, to: bar.middle}
outputs: [rx.q]
simulation: {duration: 4, samples: 5}
END
for method in auto radau5 newmark; do
  for T in 1e-5 1e-7 1e-8; do
    "$COTREE" simulate exchanged.yaml --quiet --method $method --tolerance $T --summary s.json -o exchanged.csv || continue
    sed -n 's/.*"energy_drift": \([^,]*\),.*/\1/p' s.json | awk -v T=$T '!($1 < 10 * T) { print T ": the energy drifts by " $1 }'
    printf '%s ' "$(sed -n 's/.*"singular_positions_passed": //p' s.json)"
  done
done
echo

# Where a polynomial is not accurate enough across the configuration it is repeated from nearer by, but not for a motion that only passes near one.
echo '-- two slider-cranks on one slider, whose dead centres coincide: singular configurations by tolerances from 1e-2 to 1e-6'
cat >twins.yaml <<'END'
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  ground: {points: {l: [-0.2, 0, 0], r: [0.2, 0, 0]}}
  cl: {mass: 0.5, inertia: 0.01, com: [0.15, 0, 0], points: {pin: [0.3, 0, 0]}}
  cr: {mass: 0.5, inertia: 0.01, com: [0.15, 0, 0], points: {pin: [0.3, 0, 0]}}
  rl: {mass: 0.3, inertia: 0.01, com: [0.25, 0, 0], points: {pin: [0.5, 0, 0]}}
  rr: {mass: 0.3, inertia: 0.01, com: [0.25, 0, 0], points: {pin: [0.5, 0, 0]}}
  s: {mass: 1}
joints:
  A: {type: revolute, from: ground.l, to: cl, initial: {q: 2.2, u: 1.5}}
  B: {type: revolute, from: cl.pin, to: rl, initial: {q: -1.7, guess: true}}
  D: {type: revolute, from: ground.r, to: cr, initial: {q: 0.9416, guess: true}}
  E: {type: revolute, from: cr.pin, to: rr, initial: {q: 1.7, guess: true}}
  sl: {type: revolute, from: rl.pin, to: s, initial: {q: -0.5, guess: true}}
  sr: {type: revolute, from: rr.pin, to: s, initial: {q: -2.6, guess: true}}
  guide: {type: prismatic, axis: y, from: ground, to: s, initial: {q: 0.5, guess: true}}
outputs: [A.q, guide.u]
simulation: {duration: 2, samples: 21}
END
for method in auto dopri5 radau5; do
  for T in 1e-2 5e-3 2e-3 1e-3 5e-4 3e-4 2e-4 1e-4 3e-5 1e-5 1e-6; do
    "$COTREE" simulate twins.yaml --quiet --method $method --tolerance $T --summary s.json -o twins.csv || continue
    printf '%s ' "$(sed -n 's/.*"singular_positions_passed": //p' s.json)"
  done
  echo
done

# The pivots of its rows become small within 3e-3 rad of the singular configuration only, and long steps cross it: the sign of the solver's product of pivots shows it.
echo '-- cranks of 30 m 0.1 m apart: singular configurations by tolerances from 1e-3 to 1e-6'
cat >slender.yaml <<'END'
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  ground: {points: {b: [0.1, 0, 0], c: [0.2, 0, 0]}}
  A: {mass: 1, inertia: 74.97, com: [14.4, 0.9, 0], points: {end: [30, 0, 0]}}
  B: {mass: 1.3, inertia: 97.461, com: [14.4, 0.9, 0], points: {end: [30, 0, 0]}}
  C: {mass: 1.6, inertia: 119.952, com: [14.4, 0.9, 0], points: {end: [30, 0, 0]}}
  table: {mass: 2, inertia: 0.01, com: [0.04, 0.01, 0], points: {b: [0.1, 0, 0], c: [0.2, 0, 0]}}
joints:
  a: {type: revolute, from: ground, to: A, initial: {q: 1.9, u: -3}}
  b: {type: revolute, from: ground.b, to: B, initial: {q: 1.9, u: -3, guess: true}}
  c: {type: revolute, from: ground.c, to: C, initial: {q: 1.9, u: -3, guess: true}}
  aa: {type: revolute, from: A.end, to: table, initial: {q: -1.9, u: 3, guess: true}}
  bb: {type: revolute, from: B.end, to: table.b, initial: {q: -1.9, u: 3, guess: true}}
  cc: {type: revolute, from: C.end, to: table.c, initial: {q: -1.9, u: 3, guess: true}}
outputs: [a.q, a.a, aa.a, table.angular_velocity.z, table.angular_acceleration.z]
simulation: {duration: 1.25, samples: 101}
END
for options in '' '--keep-all' '--method radau5'; do
  for T in 1e-3 2e-4 1.8e-4 1e-4 1e-5 1e-6; do
    # shellcheck disable=SC2086
    "$COTREE" simulate slender.yaml --quiet --tolerance $T --summary s.json -o slender.csv $options
    printf '%s ' "$(sed -n 's/.*"singular_positions_passed": //p' s.json)"
  done
  echo
done

echo '-- speeds that a driver makes jump, far from any singular configuration, are not taken for another motion: no step is refused but for its error'
cat >jump.yaml <<'END'
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  ground: {points: {far: [1, 0, 0]}}
  crank: {mass: 1, inertia: 0.01, com: [0.15, 0, 0], points: {end: [0.3, 0, 0]}}
  coupler: {mass: 1, inertia: 0.1, com: [0.4, 0, 0], points: {end: [0.9, 0, 0]}}
  rocker: {mass: 1, inertia: 0.1, com: [0.3, 0, 0], points: {end: [0.7, 0, 0]}}
joints:
  A: {type: revolute, from: ground, to: crank, motion: "if(t < 0.503, 0.3 + t, 0.803 + 40*(t - 0.503))"}
  B: {type: revolute, from: crank.end, to: coupler, initial: {q: 0.5, guess: true}}
  C: {type: revolute, from: coupler.end, to: rocker.end, initial: {q: 1, guess: true}}
  D: {type: revolute, from: ground.far, to: rocker, initial: {q: 2, guess: true}}
outputs: [A.q, D.q, D.u]
simulation: {duration: 1, samples: 11}
END
for options in '' '--keep-all'; do
  for T in 1e-5 1e-8; do
    # shellcheck disable=SC2086
    "$COTREE" simulate jump.yaml --tolerance $T -o jump.csv $options 2>&1 |
      sed -n 's/^work.* steps, \([0-9]*\) rejected (\([0-9]*\) for their error).*/\1 \2/p' | awk '{ print $1 - $2 }'
  done
done
