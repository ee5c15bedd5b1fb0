# Ctrl-C and SIGTERM: what ran ends within a second, keeps whole rows, and says how to go on.
. "$(dirname "$0")/lib.sh"
m=$SYSTEMS/pendulum/model.yaml
d=$SYSTEMS/puma560_driven/model.yaml
s=$SYSTEMS/slider_crank/model.yaml

# interrupt SIGNAL ARGUMENTS...: after a second; counts and times that depend on the machine read N
interrupt() {
  signal=$1
  shift
  echo "\$ cotree $* ($signal)"
  before=$(date +%s%N)
  timeout --preserve-status -s "$signal" 1 "$COTREE" "$@" 2>said
  status=$?
  [ $(($(date +%s%N) - before)) -lt 2300000000 ] || echo 'not within a second'
  grep interrupted said | sed -e 's/t = [-+.e0-9]* s/t = N s/' -e 's/first [0-9]* samples/first N samples/' -e 's/after [0-9]* of/after N of/'
  echo "exit $status"
}
# every line of a CSV file has as many fields as the first, and the last one ends
whole() { awk -F, 'NR == 1 { n = NF } NF != n { bad = 1 } END { print (bad || NR < 2 ? "cut" : "whole rows") }'; }

interrupt INT simulate "$m" --until 20000 --tolerance 1e-12 -o a.csv
whole <a.csv.partial
tail -c 1 a.csv.partial | od -An -c
interrupt TERM simulate "$m" --until 20000 --tolerance 1e-12 -o a.csv.gz
gzip -dc a.csv.gz.partial | whole
interrupt TERM simulate "$m" --until 20000 --tolerance 1e-12 -o a.json
interrupt INT kinematics "$d" --samples 1000000 -o k.csv
whole <k.csv.partial
interrupt TERM inverse "$d" --samples 1000000 -o k.npz
interrupt INT sweep "$s" --vary torque=0.4:0.6:100000 -o s.csv
whole <s.csv.partial
interrupt TERM sweep "$s" --vary torque=0.4:0.6:100000 -o s.csv --resume
awk -F, 'NR > 1 && $1 != NR - 1 { print "row " NR " is of run " $1; exit }' s.csv.partial
interrupt TERM sweep "$s" --vary torque=0.4:0.6:100000 --method radau5 -o s.json
interrupt INT accuracy "$s" -o acc.json
ls *.json *.npz 2>/dev/null
echo '-- what came first is done: no signal, no other status'
timeout --preserve-status -s INT 20 "$COTREE" simulate "$m" --until 1 --quiet -o done.csv
echo "exit $?"
echo '-- who ignores a signal goes on ignoring it'
"$COTREE" simulate "$m" --until 3000 --tolerance 1e-12 --quiet -o on.csv & # a shell without jobs lets it ignore INT
sleep 0.2
kill -INT $!
wait $!
echo "exit $?"
