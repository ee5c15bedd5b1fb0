# Systems of more than 100 speeds: recursive form, a summary unless --full is given; its length grows as the bodies.
. "$(dirname "$0")/lib.sh"

chain() { # N: a planar chain
  awk -v n="$1" 'BEGIN {
    print "cotree: 1\nname: chain\ngravity: [0, -9.81, 0]\nbodies:"
    for (i = 0; i < n; i++)
      printf "  b%d: {mass: 1, inertia: 1/12, com: [0.5, 0, 0], points: {tip: [1, 0, 0]}}\n", i
    print "joints:"
    for (i = 0; i < n; i++)
      printf "  j%d: {type: revolute, from: %s, to: b%d}\n", i, i ? "b" i - 1 ".tip" : "ground", i
  }' >"chain$1.yaml"
}
for n in 100 101 200 400; do chain $n; done

echo '-- of 101 speeds a summary'
"$COTREE" equations chain101.yaml

echo '-- in full, from the middle of each list'
"$COTREE" equations chain101.yaml --full >101.txt
grep -E '^  (a_b50|F_b50)' 101.txt
grep -A 3 '^  b50.angle:' 101.txt
grep -c 'summary\|more$' 101.txt || true

echo '-- of 100 the mass matrix, whole'
"$COTREE" equations chain100.yaml >100.txt
"$COTREE" equations chain100.yaml --full | cmp - 100.txt
grep -E '^motion|summary|recursive' 100.txt

echo '-- twice the bodies are twice the text'
short=$("$COTREE" equations chain200.yaml --full | wc -c)
long=$("$COTREE" equations chain400.yaml --full | wc -c)
awk -v a="$short" -v b="$long" 'BEGIN { print (b < 2.1 * a ? "yes" : b / a) }'

echo '-- LaTeX and HTML are summaries, too; what programs read is whole'
for f in latex html; do "$COTREE" equations chain101.yaml --format $f | grep -c '93 more'; done
"$COTREE" equations chain101.yaml --show reduced --format json >101.json
python3 -c '
import json
e = json.load(open("101.json"))
print(sorted(e), len(e["motion"]), len(e["definitions"]))
print(e["motion"][50])'
"$COTREE" equations chain101.yaml --format c | grep -c '^    M\[100 '

echo '-- an equation that fills more than a screen is left out of a summary'
cat >beam.yaml <<'END'
cotree: 1
bodies:
  b: {type: beam, elements: 40, length: 1, E: 2e11, density: 7800, area: 1e-4, Iz: 1e-9}
joints:
  j: {type: revolute, from: ground, to: b}
END
"$COTREE" equations beam.yaml | grep -A 1 '^  j.q:  '
"$COTREE" equations beam.yaml --full | grep -c 'characters' || true
