# Names of outputs: their columns, and what is no signal.
. "$(dirname "$0")/lib.sh"
cat >model.yaml <<'END'
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  arm: {mass: 2, inertia: [1, 2, 3], com: [1, 0, 0], points: {end: [2, 0, 0]}}
  ball: {mass: 1, inertia: 1}
joints:
  pin: {type: revolute, from: ground, to: arm, initial: {q: 0.3, u: 1}}
  cup: {type: spherical, from: arm.end, to: ball, initial: {u: [1, 2, 3]}}
forces:
  rope: {type: spring, from: ground, to: ball, stiffness: 3}
  push: {type: force, at: ball, value: [1, 2, 3]}
simulation: {duration: 0.1, samples: 2}
END
with() {
  { cat model.yaml; echo 'outputs:'; printf '  - %s\n' "$@"; } >outputs.yaml
}
echo '-- columns'
with pin.q pin.q1 cup.q cup.u arm.end.velocity 'arm.end.velocity.x in ball' rope.force '{name: "a, b", value: pin.q}' '{name: "say \"x\"", value: 1}'
"$COTREE" simulate outputs.yaml --quiet -o - | head -n 1
echo '-- no signals'
with pin.q0 pin.q2 pin.q1x pin.q01 pin.q.x pin.effort0 cup.effort4 energy.total.x constraint.position.y rope.length.x
say check outputs.yaml | grep error
with 'pin.a in ball' 'energy.total in ball' 'rope.force in ball' 'arm.rotation.xx in ball' '{name: one, value: cup.q}'
say check outputs.yaml | grep error
echo '-- a column that a vector has already'
with arm.position arm.position.y
say check outputs.yaml
echo '-- reactions and forces in other axes: what is turned back is the same'
with cup.force 'cup.force in ground' 'push.force in ball' ball.rotation arm.rotation
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
  function value(name) { return $(at[name]) }
  {
    split("x y z", axis, " ")
    for (i = 1; i <= 3; i++) {
      back = own = 0
      for (k = 1; k <= 3; k++) {
        back += value("ball.rotation." axis[i] axis[k])*value("push.force." axis[k] " in ball")
        own += value("arm.rotation." axis[i] axis[k])*value("cup.force." axis[k])
      }
      d[1] = back - i
      d[2] = own - value("cup.force." axis[i] " in ground")
      for (k = 1; k <= 2; k++) if (d[k]*d[k] > worst) worst = d[k]*d[k]
    }
  }
  END { print NR - 1 " rows:", (worst < 1e-24) ? "the same" : worst }' <<END
$("$COTREE" simulate outputs.yaml --quiet -o -)
END
