#!/bin/sh
# rounding.sh: what one rounding of places is of a speed that creeps along a stiff damped spring is told without a second run. Body b0
# of the chain sits 0.5 m from the origin on a spring k with damping c: half a unit in the last digit of that, 2^-54, is a force that c
# balances at k 2^-54/c. Where coordinates count from the ends of the springs there is nothing to tell, nor at a tolerance that does not
# ask for it.
set -eu
folder=$(dirname "$0")
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
said() { # MODEL TOLERANCE: rounding, and of what
    "$COTREE" simulate "$1" --tolerance "$2" --quiet -o "$work/result.csv" --summary "$work/summary.json"
    sed -n 's/^ *"rounding\(_of\)\{0,1\}": "\{0,1\}\([^",]*\)"\{0,1\},\{0,1\}$/\2/p' "$work/summary.json" | tr '\n' ' '
}
# the same chain, its coordinates from p0, p1, p2; the first spring is that of its joint
sed -e 's/from: ground, to: b\([012]\), axis/from: place.p\1, to: b\1, axis/' \
    -e 's/q: 1\.5000666978030477/q: 0.0000666978030477/' -e 's/q: 0\.5,/q: 0,/' -e 's/q: 1\.0,/q: 0,/' \
    -e 's/^bodies:/bodies:\n  place: {mass: 1, points: {p0: [0.5, 0, 0], p1: [1, 0, 0], p2: [1.5, 0, 0]}}/' \
    -e 's/^joints:/joints:\n  held: {type: weld, from: ground, to: place}/' \
    -e '/^  j0:/s/}}$/}, stiffness: 215183.64, damping: 364.2481}/' -e '/^  s0:/d' -e 's/ s0.force,//' \
    "$folder/damped_chain.yaml" >"$work/from_ends.yaml"
said "$folder/damped_chain.yaml" 1e-6 >"$work/loose"
said "$folder/damped_chain.yaml" 1e-10 >"$work/tight"
said "$work/from_ends.yaml" 1e-10 >"$work/moved"
echo "told at 1e-6: $(cat "$work/loose"), at 1e-10: $(cat "$work/tight"), from the ends of springs: $(cat "$work/moved")"
largest=$(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "b0.velocity.x") c = i; next }
    { z = $c < 0 ? -$c : $c; if (z > m) m = z } END { print m }' "$folder/damped_chain.reference.csv")
awk -v m="$largest" '{ one = 215183.64/364.2481*2^-54/m; exit !($2 == "b0.velocity.x" && $1 > one/3 && $1 < 3*one) }' "$work/tight" || {
    echo "it is not told"
    exit 1
}
for none in loose moved; do
    grep -q '^null null' "$work/$none" || {
        echo "it is told where there is none"
        exit 1
    }
done
