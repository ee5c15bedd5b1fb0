# A run that is killed leaves the earlier result as it was, or none; what it had stays in FILE.partial.
. "$(dirname "$0")/lib.sh"
m=$SYSTEMS/pendulum/model.yaml

# run_and_kill FILE: killed once rows are being written
run_and_kill() {
  "$COTREE" simulate "$m" -o "$1" --quiet --until 100000 --tolerance 1e-10 &
  run=$!
  tries=0
  until [ -s "$1.partial" ] || [ $tries -ge 300 ]; do
    sleep 0.02
    tries=$((tries + 1))
  done
  kill -9 $run 2>/dev/null || echo "it was over already"
  wait $run 2>/dev/null
}

echo '-- no result before'
run_and_kill new.csv
[ -e new.csv ] && echo "new.csv is there"
[ -s new.csv.partial ] && echo "partial rows"
echo '-- an earlier result'
"$COTREE" simulate "$m" -o old.csv --quiet --until 1
cp old.csv kept.csv
run_and_kill old.csv
cmp old.csv kept.csv && echo "as it was"
echo '-- the next run begins anew'
"$COTREE" simulate "$m" -o old.csv --quiet --until 1
cmp old.csv kept.csv && echo "the same"
[ -e old.csv.partial ] || echo "nothing partial"
echo '-- a sweep goes on, twice'
m=$SYSTEMS/slider_crank/model.yaml
sweep() { "$COTREE" sweep "$m" --quiet --until 0.5 --threads 1 --vary torque=0.4:0.6:8000 "$@"; }
bytes() { cat c.csv.partial 2>/dev/null | wc -c; }
# sweep_and_kill: killed once there are more bytes of rows than before
sweep_and_kill() {
  before=$(bytes)
  "$COTREE" sweep "$m" --quiet --until 0.5 --threads 1 --vary torque=0.4:0.6:8000 -o c.csv --resume &
  run=$!
  tries=0
  until [ "$(bytes)" -gt "$before" ] || [ -e c.csv ] || [ $tries -ge 300 ]; do
    sleep 0.02
    tries=$((tries + 1))
  done
  kill -9 $run 2>/dev/null
  wait $run 2>/dev/null
}
sweep_and_kill
sweep_and_kill
sweep -o c.csv --resume --summary c.json
awk '/"resumed"/ && $2 + 0 > 0 { print "rows were taken over" }' c.json
sweep -o want.csv
cmp c.csv want.csv && echo "the same bytes"
