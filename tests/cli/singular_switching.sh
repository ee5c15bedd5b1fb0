# Forces that switch in a singular configuration or next to it, where accelerations cannot be computed. Final angles by hand: M(q) q'' + M' q'^2/2 + V' = Q of the
# crank's angle on the smooth motion, by DOP853 to 1e-13, its steps ending on the switches.

# crank, coupler, rocker, base [m]; angle and rate of the crank, angles of the others; gravity, end
four_bar() {
  cat <<E
cotree: 1
parameters: {beside: 0}
gravity: [0, -$9, 0]
bodies:
  ground: {points: {d: [$4, 0, 0]}}
  crank: {mass: 1, inertia: 0.01, com: [$1/2, 0, 0], points: {e: [$1, 0, 0]}}
  rocker: {mass: 0.5, inertia: 0.02, com: [0.4*$3, 0, 0], points: {e: [$3, 0, 0]}}
  coupler: {mass: 2, inertia: 0.05, com: [$2/2, 0, 0], points: {e: [$2, 0, 0]}}
joints:
  a: {type: revolute, from: ground, to: crank, initial: {q: $5, u: $6}, effort: "if(a.q < beside, ${11}, ${12})"}
  b: {type: revolute, from: crank.e, to: coupler, initial: {q: $7, guess: true}}
  d: {type: revolute, from: ground.d, to: rocker, initial: {q: $8, guess: true}}
  c: {type: revolute, from: coupler.e, to: rocker.e}
outputs: [a.q]
simulation: {duration: ${10}, samples: 41}
E
}
four_bar 0.25 0.4 0.25 0.4 1 -3 -1 1 9.81 2 12 -4 >parallelogram.yaml
four_bar 0.15 0.1 0.15 0.1 0.3 -0.4 -0.3 0.3 0 2 0.5 -0.2 >slow.yaml
four_bar 0.3 0.4 0.4 0.3 0.8 -8 -0.696 0.696 9.81 1 6 -2 >kite.yaml
cat >isosceles.yaml <<'E'
cotree: 1
parameters: {beside: 0}
gravity: [0, -9.81, 0]
bodies:
  crank: {mass: 0.3, inertia: 3.0e-4, com: [0.05, 0, 0], points: {pin: [0.1, 0, 0]}}
  rod: {mass: 0.5, inertia: 2.0e-3, com: [0.05, 0, 0], points: {pin: [0.1, 0, 0]}}
  slider: {mass: 0.4}
joints:
  a: {type: revolute, from: ground, to: crank, initial: {q: 0.5, u: 12}, effort: "if(guide.q < beside, 0.5, -0.3)"}
  big_end: {type: revolute, from: crank.pin, to: rod, initial: {q: -1, guess: true}}
  small_end: {type: revolute, from: rod.pin, to: slider, initial: {q: 0.5, guess: true}}
  guide: {type: prismatic, from: ground, to: slider, axis: x, initial: {q: 0.2*cos(0.5), guess: true}}
outputs: [a.q]
simulation: {duration: 1, samples: 41}
E
while read -r model beside angle; do
  for with in 'dop853 1e-4' 'dop853 3.16228e-8' 'dop853 1e-9' 'dopri5 1e-6' 'radau5 1e-5'; do
    T=${with#* }
    "$COTREE" simulate "$model.yaml" --set "beside=$beside" --method "${with% *}" --tolerance "$T" --quiet -o run.csv || continue
    tail -n 1 run.csv | awk -F, -v angle="$angle" -v T="$T" -v run="$model $beside $with" '
      { d = ($2 - angle)/angle; print run ": " (d*d < 100*T*T ? "within 10 T" : d) }'
  done
done <<'E'
parallelogram 0 -0.4449418574891973
parallelogram -1e-11 -0.44494185748083487
parallelogram 1e-10 -0.44494185757304133
slow 0 -0.1293769745094032
slow -1e-11 -0.12937697451629873
slow 1e-10 -0.12937697444044893
kite 0 1.4379485247041797
kite -1e-11 1.4379485247050074
kite 1e-10 1.4379485246958694
isosceles 0 12.890285681526796
isosceles -1e-11 12.890285680852767
isosceles 1e-10 12.890285688267008
E

# The step that leads from before the singular configuration to a start near it may not contain the switch. The parallelogram has constant inertia.
echo '-- starts near it and near a switch'
while read -r q beside angle; do
  four_bar 0.25 0.4 0.25 0.4 "$q" -3 "-($q)" "$q" 9.81 0.5 2 -1 >start.yaml
  for T in 1e-5 1e-9; do
    "$COTREE" simulate start.yaml --set "beside=$beside" --tolerance $T --quiet -o run.csv || continue
    tail -n 1 run.csv | awk -F, -v angle="$angle" -v T=$T -v run="$q $beside" '
      { d = ($2 - angle)/angle; print run ": " (d*d < 100*T*T ? "within 10 T" : d) }'
  done
done <<'E'
-0.03 -0.015 -2.44347634322959
-0.1 -0.09 -2.39237979209802
E

# 20 switches in the singular configuration: long steps end on some of them before it was predicted, or it is predicted late. Taylor series of order 30 with 30 digits.
echo '-- 20 in a row'
four_bar 0.225 0.556 0.225 0.556 0.26663298026471416 -7.593300786639396 -0.266 0.266 0 2 42.9546 -39.4938 >often.yaml
for T in 1e-4 1e-6 4.64e-7 1e-8 1e-9 5e-10 1e-10; do
  "$COTREE" simulate often.yaml --tolerance $T --quiet -o run.csv || continue
  tail -n 1 run.csv | awk -F, -v T=$T '{ d = ($2 - 0.37070216673645145)/0.37070216673645145; print T ": " (d*d < 100*T*T ? "within 10 T" : d) }'
done

# Speeds: the force lets the crank go on beyond the rate, which it has in the singular configuration, or holds it there, which is no motion.
echo '-- at a rate that it has in the singular configuration'
sed 's/if(a.q < beside, 12, -4)/if(a.u < -10.86301531376374, beside, -4)/; s/duration: 2, samples: 41/duration: 0.6, samples: 13/' parallelogram.yaml >rate.yaml
for T in 1e-4 1e-9; do
  "$COTREE" simulate rate.yaml --set beside=-30 --tolerance $T --quiet -o run.csv || continue
  tail -n 1 run.csv | awk -F, -v T=$T '{ d = ($2 + 22.678771419064137)/22.678771419064137; print T ": " (d*d < 100*T*T ? "within 10 T" : d) }'
  "$COTREE" simulate rate.yaml --set beside=12 --tolerance $T --quiet -o run.csv 2>&1 | grep -o 'E[0-9]*'
done

# The configuration is reported once, whether the force switches just before it or behind.
echo '-- singular configurations and switches'
for beside in 0 1e-12 -1e-12 1e-3 -1e-3; do
  "$COTREE" simulate parallelogram.yaml --set "beside=$beside" --quiet -o run.csv --summary s.json
  sed -n 's/.*"\(singular_positions_passed\|events\)": \([0-9]*\).*/\1 \2/p' s.json | tr '\n' ' '
  echo
done
