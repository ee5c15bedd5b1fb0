# Steps are held to the tolerance in outputs, too: the elongation of a coupling between two wagons that travel ten kilometres is
# as good as it is asked for where it is an output, and not where only their places are.
model() {
  cat <<EOF
cotree: 1
bodies:
  first: {type: particle, mass: 1}
  second: {type: particle, mass: 2}
joints:
  front: {type: prismatic, from: ground, to: first, axis: x, initial: {q: 1.1, u: 1000}}
  rear: {type: prismatic, from: ground, to: second, axis: x, initial: {q: 0, u: 1000}}
forces:
  coupling: {type: spring, from: second, to: first, stiffness: 3, length: 1}
outputs:
  - {name: ahead, value: front.q}
  - {name: behind, value: rear.q}
  $2
simulation: {duration: 10, samples: 11, tolerance: $1, absolute: 1e-14, method: dop853}
EOF
}
elongation='- {name: elongation, value: coupling.length - 1}'
model 1e-6 "" >places.yaml
model 1e-6 "$elongation" >elongation.yaml
for name in places elongation; do "$COTREE" simulate $name.yaml -o $name.csv --quiet; done
# the motion is 0.1 cos(w t), w^2 = 3 (1 + 1/2)
for name in places elongation; do
  awk -F, -v name=$name '
    NR > 1 { d = $2 - $3 - 1 - 0.1 * cos(sqrt(4.5) * $1); if (d < 0) d = -d; if (d > worst) worst = d }
    END { print name ": " (worst <= 1e-6 ? "within" : "not within") " ten tolerances" }' $name.csv
done
echo '-- the force of a very stiff spring: vibrations are followed, though places need not feel them'
sed '/^outputs:/,$d' "$SYSTEMS/stiff_spring_pendulum/model.yaml" >force.yaml
echo 'outputs: [bob.position.y, spring.force]
simulation: {duration: 2, samples: 201, tolerance: 1e-6}' >>force.yaml
"$COTREE" simulate force.yaml --quiet --set k=1e10 -o force.csv
# a rigid pendulum's: three times the weight along the string
awk -F, 'NR > 1 { e = ($3 / 29.43 + $2)^2; if (e > worst) worst = e } END { print (NR == 202 && worst < 0.1^2 ? "the string pulls" : sqrt(worst)) }' force.csv

# the steps of runs of some models by a method and a tolerance
steps() {
  for name in "$@"; do
    "$COTREE" simulate $name.yaml --method $method --tolerance $T -o $name.csv 2>$name.txt
    grep '^rounding' $name.txt
    sed -n 's/^work *\([0-9]*\) steps.*/\1/p' $name.txt
  done | tr '\n' ' '
}
echo '-- how far loops are open is a check, and what they keep at zero, or at a length, has no error for steps to hold'
cat >trammel.yaml <<'E'
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  ground: {points: {guide: [0, 0, 0]}}
  a: {mass: 0.4}
  b: {mass: 0.7}
  rod: {mass: 1.1, inertia: 0.09, com: [0.3, 0, 0], points: {end: [0.8, 0, 0]}}
joints:
  px: {type: prismatic, axis: x, from: ground, to: a, initial: {q: 0.5, guess: true}}
  py: {type: prismatic, axis: y, from: ground.guide, to: b, initial: {q: 0.5, guess: true}}
  pa: {type: revolute, from: a, to: rod, initial: {q: 2.2, u: 3.5}}
  pb: {type: revolute, from: b, to: rod.end}
outputs: [px.q, pa.u]
simulation: {duration: 2, samples: 21}
E
sed '/^outputs/s/pa.u/pa.u, constraint.position, constraint.velocity/' trammel.yaml >checked.yaml
sed '/^outputs/s/pa.u/pa.u, rod.end.position.x/' trammel.yaml >held.yaml
sed '/^outputs/s/pa.u/pa.u, rod.end.position.x, rod.end.velocity.x/' trammel.yaml >moving.yaml
sed 's/guide: .0/guide: [0.002/' trammel.yaml >aside.yaml
sed 's/guide: .0/guide: [0.002/' held.yaml >held_aside.yaml
while read -r method T first second; do
  steps $first $second | awk '{ print $1 == $2 && NF == 2 ? "as many steps" : $0 }'
done <<'E'
generalized-alpha-index3 1e-3 trammel checked
radau5 1e-6 trammel checked
dop853 1e-8 trammel checked
dop853 1e-8 trammel held
generalized-alpha-index3 1e-3 trammel held
radau5 1e-6 trammel held
radau5 1e-6 trammel moving
dopri5 1e-3 trammel moving
dopri5 1e-7 aside held_aside
E
for name in aside held_aside; do
  sed 's/mass: 1.1/mass: m/; s/^bodies/parameters: {m: 1}\nbodies/' $name.yaml >many.yaml
  "$COTREE" sweep many.yaml --vary m=1:1.3:8 --method dopri5 --tolerance 1e-3 --lanes 4 -o many.csv 2>&1 | grep '^work'
done | uniq -c | awk '{ print $1 == 2 ? "side by side, too" : $0 }'

echo '-- what is like that in one place, or but for a small part, is held, and so are speeds that the method leaves open'
cat >watt.yaml <<'E'
cotree: 1
gravity: [9.81, 0, 0]
bodies:
  ground: {points: {far: [2, 1, 0]}}
  left: {mass: 0.5, inertia: 0.01, com: [0.5, 0, 0], points: {pin: [1, 0, 0]}}
  link: {mass: 0.5, inertia: 0.01, com: [0.5, 0, 0], points: {mid: [0.5, 0, 0], end: [1, 0, 0]}}
  right: {mass: 0.5, inertia: 0.01, com: [0.5, 0, 0], points: {pin: [1, 0, 0]}}
joints:
  A: {type: revolute, from: ground, to: left, initial: {q: 0, u: 0.5}}
  B: {type: revolute, from: left.pin, to: link, initial: {q: pi/2, guess: true}}
  D: {type: revolute, from: ground.far, to: right, initial: {q: pi, guess: true}}
  C: {type: revolute, from: link.end, to: right.pin}
outputs: [A.q, D.u]
simulation: {duration: 2, samples: 21}
E
sed '/^outputs/s/D.u/D.u, {name: off, value: 1e6*(link.mid.position.x - 1)}/' watt.yaml >straight.yaml
# what is left of such a distance is round-off, but the sum is not
sed '/^outputs/s/pa.u/pa.u, {name: sum, value: 1e11*rod.end.position.x + px.q}/' trammel.yaml >sum.yaml
while read -r method T first second; do
  steps $first $second | awk '{ print ($NF > 1.3*$1 ? "more steps" : $0) }'
done <<'E'
radau5 1e-5 watt straight
auto 1e-5 watt straight
generalized-alpha-index3 1e-3 trammel moving
dopri5 1e-3 trammel sum
E
