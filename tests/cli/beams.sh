# Beams: what they are, two trees of one, their signals as columns, their arms in the graph.
. "$(dirname "$0")/lib.sh"
m=$SYSTEMS/pendulum_beam_tip_mass/model.yaml
printf 'translation: [beam, mass]\nrotation: [beam]\n' >absolute.yaml
"$COTREE" check "$m" | grep -E '^(coordinates|tree|translation|rotation|beam|left)'
"$COTREE" check "$m" --tree absolute.yaml | grep -E '^(coordinates|tree|branches)'
grep -v 'energy.total' "$m" >motion.yaml # which is zero
"$COTREE" simulate motion.yaml --quiet --until 0.2 --tolerance 1e-10 -o joints.csv
"$COTREE" simulate motion.yaml --quiet --until 0.2 --tolerance 1e-10 --tree absolute.yaml -o absolute.csv
difference joints.csv absolute.csv | awk '{ print ($1 < 1e-7) ? "same motion" : $0 }'
"$COTREE" graph "$m" --format dot | grep -c 'flexible arm.*color="#009E73"'
echo '-- columns of signals; the shear at the tip is what holds the particle'
sed '/^outputs:/,/^$/d' "$m" >signals.yaml
cat >>signals.yaml <<'END'

outputs:
  - beam.tip.deflection
  - beam.tip.slope
  - beam.tip.chord_deflection
  - beam.tip.strain
  - beam.moment
  - beam.tip.force
  - {name: balance, value: beam.tip.force.z + tip.force.z}
END
"$COTREE" simulate signals.yaml --quiet --until 0.2 --samples 3 -o signals.csv
head -n 1 signals.csv
awk -F, 'NR > 1 { worst = $NF * $NF > worst ? $NF * $NF : worst } END { print (worst < 1e-20) ? "balanced" : worst }' signals.csv
echo '-- signals that are not there'
sed -i '/^outputs:/q' signals.yaml
printf '  - %s\n' beam.tip.bending beam.tip.strain.x beam.tip.moment.q mass.deflection >>signals.yaml
say check signals.yaml
echo '-- rotations of nodes that move no mass'
cat >lumped.yaml <<'END'
cotree: 1
bodies:
  rod: {type: beam, length: 1, elements: 3, density: 2700, mass: lumped, E: 7e10, area: 1e-4, Iz: 1e-9}
joints:
  root: {type: revolute, from: ground, to: rod}
simulation: {duration: 1}
outputs: [root.q]
END
say simulate lumped.yaml
