# Analyses that vary: run, the parameters, then what the analysis says by itself, for each member; members that fail.
. "$(dirname "$0")/lib.sh"
p=$SYSTEMS/pendulum/model.yaml
cat >spring.yaml <<'END'
cotree: 1
parameters: {k: 100, c: 0.2, load: 3}
bodies: {b: {mass: 1}}
joints: {j: {type: prismatic, axis: x, from: ground, to: b, effort: load - k*j.q - c*j.u}}
outputs: [j.q]
END
"$COTREE" modes spring.yaml --vary k=4:400:3 -o modes.csv
head -1 modes.csv
awk -F, 'NR > 1 { w = sqrt($2); d = $5/w - 1; e = $6*2*w/0.2 - 1; print $1, $2, $3, d*d + e*e < 1e-20 ? "sqrt(k)" : $5 }' modes.csv
"$COTREE" equilibrium spring.yaml --vary k=100:300:2 --vary load=1:3:2
# what each run gives by itself
same() { # COMMAND MODEL VARY NAMES...: rows of runs of their own
  command=$1 model=$2 vary=$3
  shift 3
  "$COTREE" "$command" "$model" -q --vary "$vary" -o varied.csv "$@"
  name=${vary%%=*}
  cut -d, -f2 varied.csv | sed 1d | uniq >values
  head -1 varied.csv | cut -d, -f3- >want
  while read -r value; do
    "$COTREE" "$command" "$model" -q --set "$name=$value" -o one.csv "$@"
    sed 1d one.csv >>want
  done <values
  cut -d, -f3- varied.csv | cmp - want && echo "$command $vary: $(wc -l <values) runs, the same bytes"
}
same modes "$SYSTEMS/double_pendulum/model.yaml" m2=1:2:3 --about equilibrium
same modes "$SYSTEMS/cantilever/model.yaml" h=0.9:1.1:2 --count 3 2>/dev/null
same equilibrium "$SYSTEMS/double_pendulum/model.yaml" m2=1:2:3
same inverse "$SYSTEMS/puma560_driven/model.yaml" T=1:2:2 --samples 5
same kinematics "$SYSTEMS/puma560_driven/model.yaml" T=1:2:2 --samples 5
"$COTREE" inverse "$SYSTEMS/puma560_driven/model.yaml" -q --samples 3 --vary T=1:2:2 && ls ./*.inverse.csv
"$COTREE" modes spring.yaml --sample 3 --seed 5 --vary k=1:2 -o a.csv && "$COTREE" modes spring.yaml --sample 3 --seed 5 --vary k=1:2 | cmp - a.csv && echo "the same members"
cut -d, -f2 a.csv >members.csv
"$COTREE" modes spring.yaml --members members.csv | cmp - a.csv && echo "the same members"
"$COTREE" equilibrium spring.yaml --vary k=100:300:2 -o e.json && cat e.json

# members that fail are rows, the first ones too
cat >mass.yaml <<'END'
cotree: 1
parameters: {m: 1}
bodies: {b: {mass: m}}
joints: {j: {type: prismatic, axis: x, from: ground, to: b, effort: -j.q, initial: {q: 1}}}
outputs: [j.q]
END
say modes mass.yaml --vary m=-1:1:3
say equilibrium mass.yaml --vary m=-1:-2:2
say modes mass.yaml --vary m=1:2:2 --about nowhere
say modes mass.yaml --vary q=1:2:2
say modes mass.yaml --vary m=1:2
say modes mass.yaml --vary m=1:2:2 --plot x.svg
say modes mass.yaml --vary m=1:2:2 --report x.html
say equilibrium mass.yaml --vary m=1:2:2 --summary x.json
say inverse mass.yaml --vary m=1:2:2 -o no.csv --until 1
say equilibrium missing.yaml --vary m=1:2:2
ls x.* no.csv 2>/dev/null
