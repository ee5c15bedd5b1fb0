# The keys of the summary, and what does not depend on the machine.
"$COTREE" simulate "$SYSTEMS/slider_crank/model.yaml" --tree joints --until 0.1 --quiet --summary s.json
grep -o '^  "[a-z_]*"' s.json
sed -n '/"solves"/,/}/p; /"seconds"/,/}/p; /"error"/,/}/p' s.json | sed 's/: [0-9].*[0-9]//'
grep -E '"(model|coordinates|speeds|constraints|redundant|degrees_of_freedom|planar|method|tolerance|solver)":' s.json
sed -n '/"trees"/,/^  }/p' s.json | tr -d ' \n'
echo
awk -F, 'END { print "last value of crank_angle:", $2 }' model.csv >a
sed -n 's/.*"crank_angle": \(.*\),/last value of crank_angle: \1/p' s.json >b
awk '{ v[NR] = $NF } END { d = v[1] - v[2]; print (d < 1e-15 && d > -1e-15) ? "final agrees" : "final differs" }' a b
# Commands that run nothing write the same keys.
grep -o '^  "[a-z_]*"' s.json >keys
for command in check equations graph equilibrium modes linearize; do
  "$COTREE" $command "$SYSTEMS/cart_pole/model.yaml" --quiet --summary $command.json >text
  echo "$command: the same keys and"
  grep -o '^  "[a-z_]*"' $command.json | diff keys - | grep '^[<>]'
done
