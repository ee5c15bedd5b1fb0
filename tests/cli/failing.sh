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
echo '-- a table that ends before the run, and one that begins after its start'
printf 't,force\n0,1\n1,2\n2,0\n' >force.csv
cat >pushed.yaml <<'END'
cotree: 1
bodies: {cart: {mass: 1, inertia: 1}}
joints: {rail: {type: prismatic, from: ground, to: cart, effort: {table: force.csv, column: force, interpolate: linear}}}
outputs: [rail.q]
simulation: {duration: 3, samples: 4}
END
say simulate pushed.yaml --quiet
cut -d, -f1 pushed.csv.partial
say simulate pushed.yaml --quiet --until 2 -o - | cut -d, -f1
sed -i '2s/0/0.5/' force.csv
say simulate pushed.yaml --quiet --until 2 -o -
