# What finds the accelerations of closed loops: what each would cost, what is chosen, and that all agree.
. "$(dirname "$0")/lib.sh"

# Names of the solver and of what was tried, without their numbers.
solver_line() {
  "$COTREE" check "$@" | sed -n 's/ [0-9][0-9]*\(,\|$\)/ N\1/g; s/^solver *//p'
}

# Of a block of rods the factors fill, and straight-line code for them outgrows the caches.
sh "$SYSTEMS/../tests/bench/mesh.sh" rods 5 5 5 >cube.yaml
for m in "$SYSTEMS"/four_bar/model.yaml "$SYSTEMS"/puma560/model.yaml; do
  solver_line "$m"
done
solver_line cube.yaml --summary c.json
sed -n 's/.*"sparse": \([0-9.e+]*\).*/\1/p; s/.*"one_system": \([0-9.e+]*\).*/\1/p' c.json \
  | awk '{ v[NR] = $1 } END { print (v[2] < v[1]) ? "sparse matrices are predicted to be cheaper" : "they are not" }'

for s in auto one-system dense; do
  "$COTREE" simulate cube.yaml --quiet --until 0.01 --solver $s -o $s.csv --summary $s.json
  sed -n 's/,$//; s/^  "solver": //p' $s.json
done
# Dense matrices, their pivots sought at every evaluation, are the reference.
for s in auto one-system; do
  difference $s.csv dense.csv | awk -v s=$s '{ print s ($1 < 1e-9 ? " agrees" : " differs by " $1) }'
done

solver_line "$SYSTEMS/four_bar/model.yaml" --solver dense
say check "$SYSTEMS/puma560/model.yaml" --solver sparse --quiet
say check "$SYSTEMS/four_bar/model.yaml" --solver klu
