# Results go to the model's file name in the current folder, or where -o says; the summary to standard error.
. "$(dirname "$0")/lib.sh"
m=$SYSTEMS/pendulum/model.yaml
"$COTREE" simulate "$m" 2>summary && ls
sed -n '1p' model.csv
wc -l <model.csv
sed -e '/^work/d' -e '/^error/d' -e '/^seconds/d' summary
echo '-- quiet; the same result under another name'
"$COTREE" simulate "$m" -oother.csv --quiet
cmp model.csv other.csv && echo same
echo '-- to standard output'
"$COTREE" simulate "$m" -o - --samples 2 --quiet | cut -d, -f1
echo '-- JSON: columns'
"$COTREE" simulate "$m" -o r.json --quiet --until 0.02
tr -d ' ' <r.json | cut -c1-12
echo '-- a parameter from the command line: length 1 m against 4 m, at twice the time'
"$COTREE" simulate "$m" -o long.csv --set l="400 cm" --set m=2 --until 2 --samples 2 --quiet
"$COTREE" simulate "$m" -o short.csv --until 1 --samples 2 --quiet
awk -F, 'FNR == 3 { q[++n] = $2 } END { d = q[1] - q[2]; print (d < 1e-8 && d > -1e-8) ? "same angle" : "differs" }' \
  long.csv short.csv
echo '-- so stiff that no explicit step is worth taking'
timeout 60 "$COTREE" simulate "$SYSTEMS/hard/flyball_governor/model.yaml" --set C=1e12 --set rho=1 --until 0.001 -o stiff.csv 2>&1 |
  sed -n 's/.*\(automatic, but radau5\).*/\1/p'
