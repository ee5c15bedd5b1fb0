# A run that fails keeps what it has in FILE.partial, never in FILE; the message says when it failed.
. "$(dirname "$0")/lib.sh"
sed -e 's/^outputs:/outputs:\n  - {name: broken, value: sqrt(1.0005 - t)}/' "$SYSTEMS/pendulum/model.yaml" >m.yaml
echo before >r.csv
say simulate m.yaml -o r.csv
cat r.csv
wc -l <r.csv.partial
say simulate m.yaml -o r.json --summary s.json --quiet
ls
