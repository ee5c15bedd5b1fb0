# Files: formats by suffix, one writer at a time, names of their own, streams that the caller closed.
. "$(dirname "$0")/lib.sh"
m=$SYSTEMS/pendulum/model.yaml
d=$SYSTEMS/puma560_driven/model.yaml

echo '-- a suffix that is not written is refused before anything is read'
for command in simulate kinematics inverse sweep accuracy equilibrium modes linearize buckling; do
  say $command missing.yaml -o x.xlsx 2>&1 | tail -1
done
say equations missing.yaml -o x.doc
say graph missing.yaml -o x.gif
say check missing.yaml -o x.json
say components -o x.pdf
say modes missing.yaml --plot x.png
say check missing.yaml --summary x.txt
say buckling missing.yaml --load f --curve x.svg
ls

echo '-- the same numbers in every format'
for suffix in csv csv.gz json npz mat; do
  "$COTREE" simulate "$m" -o "r.$suffix" --until 1 --quiet || echo "exit $?"
done
"$COTREE" simulate "$m" -o r --until 1 --quiet # without a suffix: CSV
gzip -dc r.csv.gz | cmp - r.csv && cmp r r.csv && echo 'gz and csv agree'
od -An -c -N 4 r.npz
od -An -t d4 -N 20 r.mat
for suffix in csv.gz json npz mat; do
  "$COTREE" modes "$SYSTEMS/chain40/model.yaml" -o "modes.$suffix" --quiet || echo "exit $?"
  "$COTREE" linearize "$m" -o "linear.$suffix" --quiet || echo "exit $?"
  "$COTREE" sweep "$m" --vary l=1:2:3 -o "sweep.$suffix" --until 1 --quiet || echo "exit $?"
done
"$COTREE" graph "$m" -o g.png && od -An -c -N 4 g.png

echo '-- every command has a file of its own, and names it'
for command in simulate kinematics inverse; do
  "$COTREE" $command "$d" --samples 3 2>&1 | grep '^results'
done
ls model.*

echo '-- one writer at a time'
"$COTREE" simulate "$m" -o busy.csv --until 20000 --tolerance 1e-12 --quiet &
run=$!
tries=0
until [ -s busy.csv.partial ] || [ $tries -ge 300 ]; do
  sleep 0.02
  tries=$((tries + 1))
done
say simulate "$m" -o busy.csv --until 1
kill -9 $run
wait $run 2>/dev/null
say simulate "$m" -o busy.csv --until 1 --quiet
cmp busy.csv r.csv && echo 'whole'
for i in 1 2 3 4 5 6; do # begun at the same time: each is whole, or refused
  for k in 1 2; do "$COTREE" simulate "$m" -o two.csv --until $k --quiet 2>/dev/null & done
  wait
  until=$(tail -1 two.csv | cut -d, -f1)
  "$COTREE" simulate "$m" -o want.csv --until "$until" --quiet
  cmp two.csv want.csv || echo 'a mixture'
done

echo '-- nothing is written through a link'
echo mine >victim
ln -s victim link.csv.partial
say simulate "$m" -o link.csv --until 1 --quiet
ln victim hard.csv.partial
say simulate "$m" -o hard.csv --until 1 --quiet
mkfifo fifo.csv.partial
say simulate "$m" -o fifo.csv --until 1 --quiet
cat victim

echo '-- streams that are closed'
"$COTREE" graph "$m" -o in.svg <&- && grep -c '</svg>' in.svg
"$COTREE" equations "$m" >&- 2>out || echo "exit $?: $(cat out)"
"$COTREE" --version >&- 2>out || echo "exit $?: $(cat out)"

echo '-- a dot that prints nothing, or does not end'
mkdir bin
printf '#!/bin/sh\ncat >/dev/null\n' >bin/dot
chmod +x bin/dot
PATH=$PWD/bin:$PATH
say graph "$m" -o none.svg
printf '#!/bin/sh\nexec sleep 30\n' >bin/dot
timeout --preserve-status -s INT 0.5 "$COTREE" graph "$m" -o none.svg 2>&1 || echo "exit $?"
[ ! -e none.svg ] && [ ! -e none.svg.partial ] && echo "nothing is left"
