# The joint of CONTRIBUTING.md: alone, in a loop as a branch and as a chord, and on a beam, against a slider without mass.
. "$(dirname "$0")/../cli/lib.sh"

"$COTREE" components | grep -A5 '^  slot'

bodies='cotree: 1
gravity: [0.3, -9.81, 0.2]
bodies:
  ground: {points: {a: {at: [0.1, 0.2, 0.3], rotate: [[y, 0.4], [x, 0.3]]}, b: [0.9, 0.2, 0.3]}}
  bar: {mass: 2, inertia: [0.1, 0.2, 0.3], com: [0.3, 0.1, 0], points: {end: {at: [0.6, 0, 0.1], rotate: [[x, 0.2]]}}}'

cat >tree.yaml <<END
$bodies
joints:
  pin: {type: slot, from: ground.a, to: bar, axis: y, normal: x, stiffness: [40, 3], initial: {q: [0.1, 0.3], u: [0.2, 1]}}
outputs: [bar.position.x, bar.position.y, bar.position.z, pin.q1, pin.q2, pin.force.z]
simulation: {duration: 2, samples: 20, tolerance: 1e-9}
END
cat >slider.yaml <<END
$bodies
  slider: {mass: 0}
joints:
  slide: {type: prismatic, from: ground.a, to: slider, axis: y, stiffness: 40, initial: {q: 0.1, u: 0.2}}
  turn: {type: revolute, from: slider, to: bar, axis: x, stiffness: 3, initial: {q: 0.3, u: 1}}
outputs: [bar.position.x, bar.position.y, bar.position.z, slide.q, turn.q, turn.force.z]
simulation: {duration: 2, samples: 20, tolerance: 1e-9}
END
cat >loop.yaml <<END
cotree: 1
gravity: [0.3, -9.81, 0.2]
bodies:
  ground: {points: {a: {at: [0, 0, 0.05], rotate: [[x, 0.1], [y, -0.15]]}}}
  crank: {mass: 2, inertia: [0.1, 0.2, 0.3], com: [0.1, 0.1, 0], points: {end: [0.3, 0, 0.1]}}
  rod: {mass: 1, inertia: 0.05, com: [0.4, 0, 0], points: {end: [0.8, 0.1, 0]}}
joints:
  main: {type: cylindrical, from: ground.a, to: crank, stiffness: [200, 0], initial: {q: [~, 0.6], u: [~, 2]}}
  ball: {type: spherical, from: crank.end, to: rod}
  pin: {type: slot, from: ground, to: rod.end, initial: {q: [1, -0.2], guess: true}}
outputs: [main.q1, main.q2, main.u1, main.a2, pin.q1, pin.q2, pin.a1, pin.force.y]
simulation: {duration: 0.3, samples: 10, tolerance: 1e-10}
END
cat >beam.yaml <<END
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  mast: {type: beam, length: 1, elements: 3, density: 2700, area: 1e-4,
     E: 7e10, Iy: 1e-9, Iz: 1e-9, deformation: [bending-y, bending-z],
    points: {tip: 1}}
  tip: {mass: 0.1, inertia: 1e-3, com: [0.05, 0, 0]}
joints:
  foot: {type: weld, from: ground, to: mast}
  pin: {type: slot, from: mast.tip, to: tip, axis: y, normal: x, stiffness: [30, 0], initial: {q: [0, 0.5], u: [0, 1]}}
outputs: [pin.q1, pin.q2, mast.tip.deflection.y]
simulation: {duration: 0.2, samples: 10, tolerance: 1e-9}
END

# Motion of a model with these options against a motion file: the largest difference of a column.
compare() {
  model=$1 with=$2
  shift 2
  "$COTREE" simulate "$model.yaml" -q -o run.csv "$@" || return
  awk 'NR > 1' run.csv | sed '1i names' >a
  awk 'NR > 1' "$with" | sed '1i names' >b
  paste -d, a b | awk -F, -v what="$model $*" 'NR > 1 {
    n = NF / 2
    for (i = 1; i <= n; i++) { d = $i - $(n + i); if (d < 0) d = -d; if (d > worst) worst = d } }
    END { print what, worst < 1e-6 ? "agrees" : "differs by " worst }'
}

"$COTREE" simulate slider.yaml -q -o slider.csv
compare tree slider.csv
for model in tree loop beam; do
  "$COTREE" simulate $model.yaml -q -o first.csv --tree joints
  compare $model first.csv --tree absolute
  compare $model first.csv --keep-all
done
