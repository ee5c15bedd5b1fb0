# A model that fails leaves nothing behind and an earlier result alone.
. "$(dirname "$0")/lib.sh"
sed 's/revolute/revolut/; s/^outputs:/outputs:\n  - nothing/' "$SYSTEMS/pendulum/model.yaml" >broken.yaml
say simulate broken.yaml
say check broken.yaml
echo before >broken.csv
say simulate broken.yaml -o broken.csv --quiet --summary s.json | tail -n 1
cat broken.csv
say simulate missing.yaml
sed 's/duration.*/method: auto/' "$SYSTEMS/pendulum/model.yaml" >endless.yaml
say simulate endless.yaml
say simulate endless.yaml --until 1 --quiet
say simulate endless.yaml --until 1 -o no/such/folder.csv
ls
