# Slider-cranks whose guide nearly or quite stops counting twice a turn: with rods as long as the crank, a part of it longer or
# shorter. A method of order 2 has to make small steps there, in which round-off is large; the reference is one of order 8.
cat >model.yaml <<'EOF'
cotree: 1
name: kicked slider-crank
parameters: {r: 0.1, l: 0.1, q0: 0.5, u0: 10, kick: 0, end: 0.4}
bodies:
  frame: {mass: 1, inertia: 0.01}
  crank: {mass: 0.3, inertia: 3e-4, com: [r/2, 0, 0], points: {pin: [r, 0, 0]}}
  rod: {mass: 0.5, inertia: 2e-3, com: [l/2, 0, 0], points: {pin: [l, 0, 0]}}
  slider: {mass: 0.4}
joints:
  shift: {type: prismatic, axis: x, from: ground, to: frame, motion: "if(t < 0.05, 0, kick*(t - 0.05))"}
  main: {type: revolute, from: frame, to: crank, initial: {q: q0, u: u0}}
  big_end: {type: revolute, from: crank.pin, to: rod, initial: {q: "-q0 - asin(r*sin(q0)/l)", guess: true}}
  small_end: {type: revolute, from: rod.pin, to: slider, initial: {q: "asin(r*sin(q0)/l)", guess: true}}
  guide: {type: prismatic, from: ground, to: slider, axis: x,
    initial: {q: "r*cos(q0) + l*sqrt(1 - (r*sin(q0)/l)^2)", guess: true}}
outputs: [main.q, main.u, guide.q, guide.u]
simulation: {duration: end, interval: 0.2}
EOF
while read -r l q0 u0 kick end; do
  set -- --set "l=$l" --set "q0=$q0" --set "u0=$u0" --set "kick=$kick" --set "end=$end" --quiet
  "$COTREE" simulate model.yaml "$@" --method dop853 --tolerance 1e-11 -o reference.csv || exit
  "$COTREE" simulate model.yaml "$@" --method generalized-alpha --tolerance 1e-6 -o run.csv 2>out || head -n 1 out
  tail -qn 1 reference.csv run.csv | awk -F, -v case="l = $l, q0 = $q0, u0 = $u0, kick $kick" '
    NR == 1 { for (i = 1; i <= NF; i++) r[i] = $i }
    NR == 2 { for (i = 2; i <= NF; i++) { d = ($i - r[i])/(r[i] < -1 || r[i] > 1 ? r[i] : 1); d *= d; if (d > worst) worst = d } }
    END { print case ": " (NR == 2 && worst < 1e-10 ? "within 10 T" : "wrong") }'
done <<'EOF'
0.1 0.5 10 0 2
0.1 0.5 0 3 2
0.1000001 0.5 10 0 0.2
0.0999999 0.5 10 0 0.2
0.1001 20.5 10 0 0.4
0.11 62.5 10 0 0.4
EOF
# Rods as long as the crank at 1e-10: stages near the singular configuration have to be closed down to round-off. Nothing but the kick works here, so with
# A(q) = 0.0003 + 0.3 0.05^2 + 0.002 + 0.5 (0.15^2 s^2 + 0.05^2 c^2) + 4 0.4 0.1^2 s^2, s = sin q, c = cos q, A u^2 stays the same before the kick and
# behind it, and A u less s (0.3 0.05 + 0.5 0.15 + 0.4 0.2) times the frame's speed in it: angles at 2 s by quadrature with 25 digits.
while read -r q0 u0 kick angle; do
  for tree in auto absolute; do
    "$COTREE" simulate model.yaml --set "q0=$q0" --set "u0=$u0" --set "kick=$kick" --set end=2 --tree $tree --tolerance 1e-10 --quiet -o run.csv || continue
    tail -n 1 run.csv | awk -F, -v case="q0 = $q0, u0 = $u0, kick $kick, $tree" -v angle="$angle" '
      { d = ($2 - angle)/angle; print case ": " (d*d < 1e-18 ? "within 10 T" : d) }'
  done
done <<'EOM'
0.83 0 8.02 115.054841079418
-1.49 0 5.47 -83.8764025776562
1.4 13 6.42 131.8765671401673
1.43 -0.8 9.45 141.799416104938
0.24265887966818833 47.23529960386989 -1.6714910358721173 32.17350104681078
0.19468792581637495 -57.48033078285942 8.40934125265155 -193.1884211062351
EOM
# Of these the last two are kicked next to the singular configuration, which then comes later than was predicted.
