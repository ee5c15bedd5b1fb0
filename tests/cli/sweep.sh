# Parameter studies: a row is what `simulate` gives for its values, whatever threads, lanes and back end; members
# that fail are rows too; interrupted sweeps go on.
. "$(dirname "$0")/lib.sh"
m=$SYSTEMS/slider_crank/model.yaml
sweep() { "$COTREE" sweep "$m" --quiet --until 0.2 --vary torque=0.1:0.5:3 --vary r='140 mm:160 mm:3' "$@"; }

sweep -o a.csv --threads 1 --resume
head -1 a.csv
cut -d, -f1-3 a.csv | tail -4
sweep -o b.csv --threads 2
cmp a.csv b.csv && echo "the same bytes"
for backend in native tape; do
  sweep -o four.csv --backend $backend --lanes 4
  sweep -o eight.csv --backend $backend --lanes 8 --threads 1 --summary eight.json
  cmp four.csv eight.csv && echo "$backend, $(sed -n 's/^ *"lanes": \([0-9]*\),/\1/p' eight.json) lanes: the same bytes"
done
ls b.csv*
sweep -o b.csv --resume --threads 1 --lanes 1
ls b.csv*
sweep -o b.csv --backend tape # settings of the rows before go with them
ls b.csv*
difference a.csv b.csv | awk '{ print ($1 < 1e-8) ? "the same numbers" : $0 }'
"$COTREE" sweep "$m" --until 0.2 --vary torque=0.1:0.5:3 --vary r=0.14:0.16:3 -o alone.csv --lanes 1 2>alone.log
grep -o 'as requested' alone.log

# rows against runs of their own, at a tolerance of 1e-8
sed 1d a.csv | while IFS=, read -r run torque r values; do
  "$COTREE" simulate "$m" --quiet --until 0.2 --samples 2 --set "torque=$torque" --set "r=$r" -o run.csv
  same_row "$run" "${values%,*}"
  [ "$(tr -cd , <want)" = ,,,,,,,,, ] || echo "wrong number of values"
done && echo "rows are runs"

# members that fail: no mass, a rod that does not reach
say sweep "$m" --until 0.05 --vary m3=-0.5:0.5:2 --vary l=0.05:0.3:2 -o failed.csv --quiet --summary failed.json
sed 's/\(,[^,]*,[^,]*\),[^,].*\(,.\)$/\1,...\2/' failed.csv
sed -n '/"failures"/,$p' failed.json
grep '"alone"' failed.json

# random members: the same seed, the same members
say sweep "$m" --until 0.02 --vary r=0.14:0.16 --vary l=normal:0.304:0.001 --sample 20 --seed 3 -o s.csv --quiet
"$COTREE" sweep "$m" --until 0.02 --vary r=0.14:0.16 --vary l=normal:0.304:0.001 --sample 20 --seed 3 -o t.csv --quiet --threads 1
cmp s.csv t.csv && echo "same members"
cut -d, -f1-3 s.csv | sed -n '2,3s/\(\.[0-9]\{8\}\)[0-9]*/\1/gp'

# a sweep that was cut off in the middle of a row
cut_off() { # NAME ROWS: what an interruption of a.csv leaves
  head -"$2" a.csv >"$1.partial"
  printf '5,0.3,' >>"$1.partial"
  cp a.csv.settings "$1.partial.settings"
}
cut_off c.csv 5
sweep -o c.csv --resume --summary c.json
cmp a.csv c.csv && echo "resumed: the same bytes"
grep '"resumed"' c.json
ls c.csv*
sweep -o c.csv --resume --summary c.json --threads 1 --lanes 1
grep '"resumed"' c.json
sed 's/^program .*/program      .../; s/[0-9a-f]\{16\}, .*/..., ... bytes/' c.csv.settings
# complete, but with another tolerance: anew
sweep -o c.csv --resume --tolerance 1e-6 --summary c.json
grep '"resumed"' c.json
# rows of other settings are not gone on with
rm c.csv*
refused() { # NAME OPTION...
  name=$1
  shift
  cut_off "$name" 3
  say sweep "$m" --until 0.2 --vary torque=0.1:0.5:3 --vary r='140 mm:160 mm:3' --resume --quiet -o "$name" "$@"
}
refused c.csv --tolerance 1e-6
refused c.csv --until 0.3
refused c.csv --set m3=1
refused c.csv --tree absolute --method dopri5
say sweep "$m" --until 0.2 --vary torque=0.2:0.5:3 --vary r='140 mm:160 mm:3' -o c.csv --resume --quiet
say sweep "$m" --until 0.2 --vary torque=0.1:0.5:3 -o c.csv --resume --quiet
sed '1s/torque/moment/' a.csv >c.csv.partial
say sweep "$m" --until 0.2 --vary torque=0.1:0.5:3 --vary r='140 mm:160 mm:3' -o c.csv --resume --quiet
sed 's/^2,/4,/' a.csv >c.csv.partial
say sweep "$m" --until 0.2 --vary torque=0.1:0.5:3 --vary r='140 mm:160 mm:3' -o c.csv --resume --quiet
rm c.csv.partial.settings
say sweep "$m" --until 0.2 --vary torque=0.1:0.5:3 --vary r='140 mm:160 mm:3' -o c.csv --resume --quiet
cut_off c.csv 3
{ cat "$m"; echo; } >model.yaml
"$COTREE" sweep model.yaml --until 0.2 --vary torque=0.1:0.5:3 --vary r='140 mm:160 mm:3' -o c.csv --resume --quiet 2>&1
say sweep "$m" --vary r=0.14:0.16:3 -o c.json --resume

# a height out of the plane makes a planar mechanism spatial: such members have equations of their own
cat >flat.yaml <<'END'
cotree: 1
parameters: {h: 0, slope: 2*h, c: 0}
gravity: [0, -9.81, 0]
bodies:
  a: {mass: 1, inertia: [0.01, 0.01, 0.01], points: {p: [0.1, 0, 0]}}
  b: {mass: 1, inertia: [0.01, 0.02, 0.01], com: [0.1, 0, 0]}
joints:
  j: {type: revolute, from: ground, to: a, initial: {q: 0.3}, effort: "if(c > 0, c, -1)"}
  k: {type: revolute, from: a.p, to: b, axis: [0, slope, 1], initial: {q: 0.2}}
outputs: [j.q, k.q, j.force.z]
simulation: {duration: 0.5 + c/2}
END
"$COTREE" sweep flat.yaml --vary h=0:0.2:3 -o flat.csv 2>flat.log
grep lanes flat.log | sed 's/ in each.*threads//'
for h in 0 0.1 0.2; do
  "$COTREE" simulate flat.yaml --set h=$h --samples 2 --quiet -o - | tail -1 | cut -d, -f2-
done >want
sed 1d flat.csv | cut -d, -f3- | sed 's/,0$//' | diff want - && echo "members of their own"
# a parameter that chooses a branch, and the duration, does not ask for other equations
"$COTREE" sweep flat.yaml --vary c=0:2:3 -o branch.csv 2>branch.log
grep lanes branch.log | sed 's/ in each.*threads//'
echo j.q,k.q,j.force.z >want
for c in 0 1 2; do
  "$COTREE" simulate flat.yaml --set c=$c --samples 2 --quiet -o - | tail -1 | cut -d, -f2-
done >>want
cut -d, -f3-5 branch.csv >got
difference want got | awk '{ print ($1 < 1e-8) ? "branches" : $0 }'

# switches and implicit methods: one by one
"$COTREE" sweep "$SYSTEMS/puma560_driven/model.yaml" --until 0.01 --vary T=1:2:2 -o g.csv 2>&1 |
  sed -n 's/ in each.*threads//; /^lanes/p'
"$COTREE" sweep flat.yaml --vary c=0:1:2 --method radau5 --quiet -o implicit.csv --summary i.json
grep alone i.json

"$COTREE" sweep flat.yaml --vary c=0:1:2 --quiet -o j.json && sed 's/\(\.[0-9]\{5\}\)[0-9]*/\1/g' j.json
say sweep flat.yaml
say sweep flat.yaml --vary c=1:2:x
say sweep flat.yaml --vary d=1:2:3
say sweep flat.yaml --vary c=1:2:3 --lanes 2
say sweep flat.yaml --vary c=1:2:3 --seed -1
say sweep flat.yaml --vary c=0:1:2 --quiet && ls ./*.sweep.csv
