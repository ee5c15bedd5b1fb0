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
