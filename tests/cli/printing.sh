# How equations are printed: names, numbers, matrices, nothing left out; see docs/equations.md.
. "$(dirname "$0")/lib.sh"

cat >flip.yaml <<'END'
cotree: 1
gravity: [0, 0, -9814.905]
bodies:
  rod: {mass: 1.5, inertia: 0.1, com: [0.25, 0, 0], points: {tip: [0.5, 0, 0]}}
  bar: {mass: 1, inertia: 0.1}
joints:
  hinge: {type: revolute, axis: y, from: ground, to: rod}
  pin: {type: revolute, axis: y, from: rod.tip, to: bar}
END
echo '-- a hinge about y: names of axes, digits of data, forces and torques with the inertia put in'
say equations flip.yaml --show tree,cutset,reduced --tree absolute

echo '-- an axis that is none of ground: e1 and e2'
sed 's/axis: y/axis: [0, 0.6, 0.8]/; s/gravity.*/gravity: [0, 0, 0]/' flip.yaml >oblique.yaml
"$COTREE" equations oblique.yaml --show tree --tree absolute | sed -n '/^unknown/,/^left/p'

echo '-- edges have the same numbers in graph and equations'
m=$SYSTEMS/slider_crank/model.yaml
"$COTREE" equations "$m" --show graph | sed -n 's/^ *\([0-9][0-9]*\)  \([a-z_.][a-z_.]*\) .*/\1 \2/p' >numbers
"$COTREE" equations "$m" --show tree | sed -n 's/^ *\([0-9][0-9]*\)  \([a-z_.][a-z_.]*\) .*/\1 \2/p' >trees
[ "$(grep -cxFf numbers trees)" = "$(grep -c . trees)" ] && echo trees
"$COTREE" graph "$m" --format text | sed -n '/^edges/,/^$/s/^ *\([0-9][0-9]*\)  \([a-z_.][a-z_.]*\) .*/\1 \2/p' | diff numbers - && echo text
"$COTREE" graph "$m" --format json | sed -n '/"edges": \[$/,/\]/s/.*"id": \([0-9]*\), "name": "\([^"]*\)".*/\1 \2/p' | diff numbers - && echo json
"$COTREE" graph "$m" --format dot | sed -n 's/.*label=<\(<font[^>]*>\)*\([0-9][0-9]*\) \([a-z_.]*\)<.*/\2 \3/p' | diff numbers - && echo dot
"$COTREE" equations "$m" --show graph --format json | awk '
  /"number"/ { gsub(/[^0-9]/, ""); n = $0 } /"name"/ && n { split($0, q, "\""); print n, q[4]; n = "" }' |
  diff numbers - && echo equations

echo '-- no row of a circuit is missing: 13 bodies, 11 rows of joints'
m=$SYSTEMS/stewart/model.yaml
"$COTREE" equations "$m" --show circuit --format json >c.json
awk '/"substituted"/ { on = 1 } on && /"bodies"/ { b = 1 } on && /"joints"/ { b = 0; j = 1 }
  b && /": \[/ { bodies++ } j && /": "/ { joints++ } END { print bodies, joints }' c.json
"$COTREE" equations "$m" --show circuit | awk '
  /^circuits of the bodies/ { b = 1 } /^circuits of the joints/ { b = 0; j = 1 }
  b && /^  d\(/ { bodies++ } j && /^  [a-z0-9]*\.[a-z0-9]*:/ { joints++ } END { print bodies, joints }'
"$COTREE" equations "$m" --show circuit --format latex | awk '
  /circuits of the bodies/ { b = 1 } /circuits of the joints/ { b = 0; j = 1 }
  b && /boldsymbol\{d\}.* &= / { bodies++ } j && /:\}/ { joints++ } END { print bodies, joints }'

echo '-- LaTeX: no second subscript, which pdflatex refuses'
for s in "$SYSTEMS"/*/model.yaml; do
  "$COTREE" equations "$s" --show terminal,cutset --format latex 2>/dev/null |
    grep -En '_\{([^{}]|\{[^{}]*\})*\}_' | head -n 2
done

echo '-- a name that ends with a backslash stays in its comment'
printf 'cotree: 1\nname: "one */ two\\\\"\n' >line.yaml
sed 1d flip.yaml >>line.yaml
"$COTREE" equations line.yaml --format c -o line.c
head -n 1 line.c
${CC:-cc} -std=c11 -Wall -Werror -c line.c -o line.o && echo compiled

echo '-- did you mean'
sed 's/mass: 1,/mass: 20 in,/' flip.yaml >inch.yaml
say check inch.yaml
say equations flip.yaml --format tex
