# Equilibrium, modes, linearize, kinematics, inverse, buckling: where results go and what they look like.
. "$(dirname "$0")/lib.sh"
m=$SYSTEMS/link_column/model.yaml
echo '-- buckling, with frequencies on the way'
"$COTREE" buckling "$m" --load weight --curve curve.csv 2>summary | awk -F, '{ print $1 "," substr($2, 1, 9) }'
cat summary
head -1 curve.csv
wc -l <curve.csv
awk -F, 'END { d = $2; print (d < 1e-5 && d > -1e-5) ? "no frequency at the end" : d }' curve.csv
"$COTREE" buckling "$m"
"$COTREE" buckling "$m" --load wieght
"$COTREE" buckling "$m" --load gravity
echo '-- modes under half the load'
"$COTREE" modes "$m" --set push=9.9 --count 2 | awk -F, '{ print $1 "," substr($3, 1, 9) "," $4 }'
"$COTREE" modes "$m" --about equilibrum
"$COTREE" modes "$m" --count 0
"$COTREE" modes "$m" --count 2 -q -o modes.json --plot shapes.svg
tr -d ' \n' <modes.json | cut -c1-90
grep -c '<line' shapes.svg
echo '-- an unstable equilibrium'
"$COTREE" equilibrium "$m" --set push=25 2>summary
grep -o 'unstable.*1/s^2' summary
"$COTREE" equilibrium "$m" --set push=25 -q -o rest.json
tr -d ' \n' <rest.json
echo
echo '-- matrices'
"$COTREE" linearize "$m" --set push=0 --inputs foot.effort,push | head -3 | tr , ' ' | cut -c1-70
"$COTREE" linearize "$m" -q -o m.npz
od -A n -c -N 4 m.npz
"$COTREE" linearize "$m" --inputs foot.efort
echo '-- driven motions'
d=$SYSTEMS/puma560_driven/model.yaml
"$COTREE" kinematics "$d" --samples 3 -q && ls model.kinematics.csv && wc -l <model.kinematics.csv
"$COTREE" inverse "$d" --samples 3 -o - -q | cut -d, -f20-26 | head -1
"$COTREE" inverse "$m"
echo '-- a free cart under a leaning pole: one rigid-body motion, whatever rounding makes of its double zero'
"$COTREE" modes "$SYSTEMS/cart_pole/model.yaml" --quiet | sed -n 2p
echo '-- a free body that spins: three motions of its centre and its spin, nothing beside them'
"$COTREE" modes "$SYSTEMS/tumbling_body/model.yaml" --quiet | awk -F, 'NR > 1 && NR < 7 { print $1 "," substr($2, 1, 9) "," $4 }'
echo '-- ten modes where no count is given'
"$COTREE" modes "$SYSTEMS/chain40/model.yaml" --quiet | tail -n +2 | wc -l
