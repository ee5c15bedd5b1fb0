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

echo '-- how far loops are open is a check, and what they keep at zero has no digits to hold'
cat >trammel.yaml <<'E'
cotree: 1
gravity: [0, -9.81, 0]
bodies:
  a: {mass: 0.4}
  b: {mass: 0.7}
  rod: {mass: 1.1, inertia: 0.09, com: [0.3, 0, 0], points: {end: [0.8, 0, 0]}}
joints:
  px: {type: prismatic, axis: x, from: ground, to: a, initial: {q: 0.5, guess: true}}
  py: {type: prismatic, axis: y, from: ground, to: b, initial: {q: 0.5, guess: true}}
  pa: {type: revolute, from: a, to: rod, initial: {q: 2.2, u: 3.5}}
  pb: {type: revolute, from: b, to: rod.end}
outputs: [px.q, pa.u]
simulation: {duration: 2, samples: 21}
E
sed '/^outputs/s/pa.u/pa.u, constraint.position, constraint.velocity/' trammel.yaml >checked.yaml
sed '/^outputs/s/pa.u/pa.u, rod.end.position.x/' trammel.yaml >held.yaml
while read -r method T other; do
  for name in trammel $other; do
    "$COTREE" simulate $name.yaml --method $method --tolerance $T -o $name.csv 2>$name.txt
    grep '^rounding' $name.txt
    sed -n 's/^work *\([0-9]*\) steps.*/\1/p' $name.txt
  done | tr '\n' ' ' | awk '{ print $1 == $2 && NF == 2 ? "as many steps" : $0 }'
done <<'E'
generalized-alpha-index3 1e-3 checked
radau5 1e-6 checked
dop853 1e-8 checked
dop853 1e-8 held
E
