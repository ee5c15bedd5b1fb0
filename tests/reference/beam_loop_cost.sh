#!/bin/sh
# beam_loop_cost.sh: a four-bar whose bars are K beams each. Its cost is in proportion to K, whichever trees the program takes by
# itself, and its motion is that of trees through joints. COTREE is the program.
set -eu
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

four_bar() {
  awk -v K="$1" '
    function bar(name, long) {
      for (i = 1; i <= K; i++)
        printf "  %s%d: {type: beam, length: %g/%d, density: 2700, E: 7e9, area: 1e-4, Iz: 1e-9, formulation: foreshortening, frame: chord, points: {end: length}}\n",
          name, i, long, K
    }
    function welds(name) {
      for (i = 2; i <= K; i++)
        printf "  %s_%d: {type: weld, from: %s%d.end, to: %s%d}\n", name, i, name, i - 1, name, i
    }
    BEGIN {
      print "cotree: 1\ngravity: [0, -9.81, 0]\nbodies:\n  ground: {points: {far: [2, 0, 0]}}"
      bar("a", 1); bar("b", 2); bar("c", 1)
      print "joints:\n  A: {type: revolute, axis: z, from: ground, to: a1, initial: {q: pi/3}}"
      welds("a"); welds("b"); welds("c")
      printf "  B: {type: revolute, axis: z, from: a%d.end, to: b1, initial: {q: -pi/3, guess: true}}\n", K
      printf "  C: {type: revolute, axis: z, from: c%d.end, to: b%d.end, initial: {q: -pi/3, guess: true}}\n", K, K
      print "  D: {type: revolute, axis: z, from: ground.far, to: c1, initial: {q: pi/3, guess: true}}"
      printf "outputs: [A.q, C.q, b1.position.x, b%d.end.position.y, energy.strain]\n", K
    }'
}

# count K: operations of an evaluation
count() {
  four_bar "$1" >"$work/model.yaml"
  "$COTREE" simulate "$work/model.yaml" --until 1e-5 --samples 2 -o "$work/result.csv" 2>"$work/summary"
  sed -n 's/.* evaluations of \([0-9]*\) operations.*/\1/p' "$work/summary"
}

few=$(count 6) many=$(count 12)
echo "operations: $few with 6 beams in each bar, $many with 12"
[ "$many" -lt $((few * 22 / 10)) ] # in proportion within a tenth

four_bar 5 >"$work/model.yaml"
for tree in auto joints; do
  "$COTREE" simulate "$work/model.yaml" --tree $tree --until 0.02 --samples 3 --tolerance 1e-9 --quiet -o "$work/$tree.csv"
done
paste -d , "$work/auto.csv" "$work/joints.csv" | awk -F, '
  function size(x) { return x < 0 ? -x : x }
  NR > 1 {
    n = NF / 2
    for (i = 2; i <= n; i++) {
      d = size($i - $(n + i)) / (size($i) > 1e-3 ? size($i) : 1e-3)
      if (d > most) most = d
    }
  }
  END { printf "trees: motions differ by %.1e\n", most; exit !(NR == 4 && most < 1e-7) }' # a hundred times the tolerance
