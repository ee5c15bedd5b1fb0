#!/bin/sh
# validity.sh SPEED [SYSTEM UNTIL]: brings the beam of systems/SYSTEM (else systems/spin_up_beam, until 8 s) to SPEED rad/s as a
# linear beam and as a foreshortened one. At the instant of the foreshortened beam's largest deflection the linear one is off by
# what the validity indicator says there, within a factor of 3. COTREE is the program.
set -eu
: "${COTREE:?is the program to test}"
folder=$(dirname "$0")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for formulation in linear foreshortening; do
    sed -e "s/formulation: .*/formulation: $formulation/" \
        -e 's/^outputs:/outputs:\n  - {name: eta, value: beam.validity}/' \
        "$folder/../../systems/${2:-spin_up_beam}/model.yaml" > "$work/$formulation.yaml"
    "$COTREE" simulate "$work/$formulation.yaml" -o "$work/$formulation.csv" --quiet --set "speed=$1" \
        --method radau5 --tolerance 1e-6 --until "${3:-8}" --samples 161
done
paste -d, "$work/linear.csv" "$work/foreshortening.csv" | awk -F, '
function size(x) { return x < 0 ? -x : x }
NR == 1 { for (i = 1; i <= NF; i++) { if ($i == "across") v[++n] = i; if ($i == "eta" && !eta) eta = i }; next }
size($(v[2])) > most { most = size($(v[2])); error = size($(v[1]) - $(v[2])) / most; said = size($eta); t = $1 }
END {
    if (n != 2 || !eta || most == 0) { print "columns are missing"; exit 1 }
    printf "largest deflection %.4f m at %.2f s: off by %.4f, indicator %.4f\n", most, t, error, said
    exit !(error < 3 * said && said < 3 * error)
}'
