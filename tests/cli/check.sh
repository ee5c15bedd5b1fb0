# What a system is. Costs change with the engine and are left out.
. "$(dirname "$0")/lib.sh"
plain() {
  say "$@" | sed -e '/^motion/d' -e '/^constraints/d' -e '/^evaluation/d' -e 's/pairs.*/pairs/' -e 's/[0-9]* pairs/N pairs/' -e '/^solver/s/ [0-9][0-9]*/ N/g' \
    -e '/^translation/d' -e '/^rotation/d' -e '/^branches/d'
}
plain check "$SYSTEMS/slider_crank/model.yaml"
plain check "$SYSTEMS/bricard/model.yaml" --tree joints
echo '-- a planar mechanism in space: redundant rows, and outputs they leave open'
sed 's/^outputs:/outputs:\n  - top_pin.force.x\n  - top_pin.force.z\n  - crank_pin.torque.y/' \
  "$SYSTEMS/four_bar/model.yaml" >four_bar.yaml
plain check four_bar.yaml --keep-all --tree joints
plain simulate four_bar.yaml --keep-all --tree joints --until 0.1 | grep undetermined
"$COTREE" check four_bar.yaml --keep-all --tree joints -q -o text.txt --summary loops.json
sed -n '/^  "undetermined"/,/]/p' loops.json
sed -n '/^  "loops"/,/^  "final"/p' loops.json | sed -e 's/\(value": 0\.[0-9]\{3\}\)[0-9]*/\1/'
echo '-- in a plane a loop leaves forces across it open, what hangs on the loop has them determined, in any tree'
cat >tail.yaml <<'END'
cotree: 1
gravity: [0, -9.81, 0.7]
bodies:
  ground: {points: {far: [1.8, -0.5, 0]}}
  crank: {mass: 2, inertia: [0.1, 0.15, 0.2], points: {end: [1, 0, 0.2]}}
  rod: {mass: 1, inertia: [0.1, 0.15, 0.2], points: {near: [-0.5, 0, 0.2], far: [0.5, 0.1, 0.2], low: [0, -0.2, 0.1]}}
  rocker: {mass: 0.5, inertia: [0.02, 0.02, 0.03], points: {end: [-1, 0, 0.2]}}
  tail: {mass: 0.5, inertia: [0.02, 0.02, 0.03], points: {end: [0, 0.5, 0]}}
joints:
  root: {type: revolute, from: ground, to: crank, initial: {q: 0.4}}
  near: {type: revolute, from: crank.end, to: rod.near}
  far: {type: revolute, from: rod.far, to: rocker.end}
  foot: {type: revolute, from: rocker, to: ground.far}
  hang: {type: revolute, from: rod.low, to: tail.end}
outputs: [root.force.z, near.force.z, hang.force.z, hang.torque.x]
END
for tree in auto joints absolute; do
  "$COTREE" check tail.yaml --tree $tree | grep undetermined
done
echo '-- why: redundant rows, or a planar loop'
"$COTREE" simulate four_bar.yaml --keep-all --tree joints --until 0.1 2>&1 | grep '^note'
"$COTREE" simulate tail.yaml --until 0.01 2>&1 | grep -E 'redundant|^note'
echo '-- signals that joints and forces do not have'
cat >signals.yaml <<'END'
cotree: 1
bodies:
  crank: {mass: 1, inertia: 1}
  block: {mass: 1, inertia: 1}
joints:
  pin: {type: revolute, from: ground, to: crank}
  slot: {type: cylindrical, from: crank, to: block}
  rod: {type: distance, from: ground, to: block, length: 1}
forces:
  pull: {type: spring, from: ground, to: block, stiffness: 1, length: 1}
outputs: [pin.q2, slot.q3, slot.effort3, rod.q, pull.lenght]
END
say check signals.yaml
echo '-- beams with nothing left out'
for model in "$SYSTEMS"/spin_up_stiff/model.yaml "$SYSTEMS"/tapered_cantilever/model.yaml "$SYSTEMS"/slider_crank_flexible/model.yaml; do
  "$COTREE" check "$model" --keep-all | grep '^beam'
done
echo '-- what lumped mass does not have'
for mass in lumped consistent; do
  for inertia in false true '[1e-3, 5e-4, 5e-4]'; do
    cat >rotary.yaml <<END
cotree: 1
bodies:
  bar: {type: beam, length: 1, elements: 2, E: 7e10, area: 1e-4, Iz: 1e-9, density: 2700, mass: $mass, rotary_inertia: $inertia, points: {tip: length}}
joints:
  root: {type: weld, from: ground, to: bar}
forces:
  pull: {type: force, at: bar.tip, value: [0, 1, 0]}
END
    echo "$mass, $inertia: $("$COTREE" check rotary.yaml | grep 'left out.*rotary')"
  done
done
echo '-- derivatives for implicit methods'
for model in slider_crank chain40; do
  "$COTREE" check "$SYSTEMS/$model/model.yaml" --tree joints --method radau5 | grep '^derivatives'
done
"$COTREE" simulate "$SYSTEMS/slider_crank/model.yaml" --tree joints --until 0.01 --method hht 2>&1 | grep '^derivatives'
"$COTREE" check "$SYSTEMS/slider_crank/model.yaml" | grep -c '^derivatives' || :
echo '-- sweeps one by one'
for method in auto dop853 radau5; do
  echo "$method: $("$COTREE" check "$SYSTEMS/slider_crank/model.yaml" --method $method | grep '^sweeps')"
done
"$COTREE" check "$SYSTEMS/slider_crank/model.yaml" --step 0.001 | grep '^sweeps'
