# Chains of ball joints: their accelerations come without a mass matrix, in work that grows with their length.
. "$(dirname "$0")/lib.sh"
# chain N END: N links; END are the properties of the last one
chain() {
  awk -v n="$1" -v end="$2" 'BEGIN {
    print "cotree: 1\nname: chain of " n "\ngravity: [0, 0, -9.81]\nbodies:"
    for (i = 1; i <= n; i++)
      printf "  b%d: {%s, points: {end: [0.1, 0, 0]}}\n", i,
             (i < n ? "mass: 0.1, com: [0.05, 0.001, 0.002], inertia: [1e-5, 1e-4, 1e-4]" : end)
    print "joints:"
    for (i = 1; i <= n; i++)
      printf "  j%d: {type: spherical, from: %s, to: b%d}\n", i, (i > 1 ? "b" (i - 1) ".end" : "ground"), i
    print "outputs: [energy.total]\nsimulation: {duration: 0.02, samples: 3, tolerance: 1e-9}"
  }'
}
chain 500 'mass: 0.1, com: [0.05, 0, 0], inertia: [1e-5, 1e-4, 1e-4]' >chain.yaml
say check chain.yaml | sed -n -e '/^coordinates/p' -e 's/^\(formulation.*\), predicted.*/\1/p'
"$COTREE" simulate chain.yaml -o chain.csv --quiet --summary chain.json
sed -n -e '/"formulation"/p' -e '/"speeds"/p' chain.json
awk -F, 'NR == 2 { first = $2 }
  NR > 2 { d = $2 / first - 1; print (d * d < 1e-20 ? "energy kept" : "energy changes by " d) }' chain.csv
echo '-- the last link is a rod without a moment of inertia along its axis, seen far from ground'
chain 60 'mass: 0.1, com: [0.05, 0, 0], inertia: [0, 1e-4, 1e-4]' >rod.yaml
say check rod.yaml
echo '-- radau5 on a fall from rest, in which the balls turn ever faster: its iteration converges'
awk 'BEGIN {
  print "cotree: 1\ngravity: [0, 0, -9.81]\nbodies:"
  for (i = 1; i <= 40; i++)
    printf "  b%d: {mass: 1.%d, com: [0.5, 0.01, 0.02], inertia: [0.1, 0.2, 0.25], points: {end: [1, 0, 0]}}\n", i, i
  print "joints:"
  for (i = 1; i <= 40; i++)
    printf "  j%d: {type: spherical, from: %s, to: b%d}\n", i, (i > 1 ? "b" (i - 1) ".end" : "ground"), i
  print "outputs: [j1.u, j40.u]\nsimulation: {duration: 0.1, samples: 2, tolerance: 1e-8}"
}' >fall.yaml
"$COTREE" simulate fall.yaml -o implicit.csv --quiet --method radau5 --summary fall.json
"$COTREE" simulate fall.yaml -o explicit.csv --quiet --tolerance 1e-11
awk -F'[:,]' '/"rejected_steps"/ { print ($2 <= 3 ? "few rejected" : "rejected " $2) }' fall.json
difference implicit.csv explicit.csv | awk '{ print ($1 < 1e-6) ? "same motion" : $0 }'
