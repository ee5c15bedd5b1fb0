#!/bin/sh
# converges.sh CASE: a coarse and a fine model of CASE, the fine one with half the length. From the one to the other the errors
# against the reference fall by at least 2^(order - 1/2), nearer to the order than to the one below, and what both make of it by
# extrapolation is nearer still. COTREE is the program.
set -eu
folder=$(cd "$(dirname "$0")" && pwd)
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# with_shear CASE N: its beams with N elements that shear
with_shear() {
    sed -e "s/elements: .*/elements: $2/" \
        -e 's|^    type: beam|    type: beam\n    theory: timoshenko\n    integration: reduced\n    G: E/3\n    shear_factor: 1|' \
        "$folder/$1.yaml"
}

# cut K N FRAME: the spin-up of K beams of N elements
cut() {
    "$folder/../../systems/spin_up_welded/generate.sh" "$1" "$2" | sed "s/formulation: foreshortening/frame: $3\n    &/"
}

# order: of the errors; extrapolated: must that be nearer? size of the quantities, 0: the largest value of each column
size=0 extrapolated=1
case $1 in
R11) # frames of one element in each leg
    reference=R11_K8 until=3 order=2 size=10
    "$folder/../../systems/right_angle_cantilever/generate.sh" 2 1 linear >"$work/coarse.yaml"
    "$folder/../../systems/right_angle_cantilever/generate.sh" 4 1 linear >"$work/fine.yaml"
    ;;
R11_quadratic) # the same with quadratic twist
    reference=R11_K8 until=10 order=3 size=10
    "$folder/../../systems/right_angle_cantilever/generate.sh" 2 1 >"$work/coarse.yaml"
    "$folder/../../systems/right_angle_cantilever/generate.sh" 4 1 >"$work/fine.yaml"
    ;;
R03b) # elements; lengthwise ringing of many frequencies, each late by the square of the length, has no order at a single time
    reference=R03b until=0.02 order=2 extrapolated=0
    for n in 6 12; do
        sed "s/elements: 12/elements: $n/" "$folder/R03b.yaml" >"$work/$n.yaml"
    done
    mv "$work/6.yaml" "$work/coarse.yaml"
    mv "$work/12.yaml" "$work/fine.yaml"
    ;;
R03b_shapes) # elements that carry the shapes
    reference=R03b_shapes until=0.05 order=4
    for n in 8 16; do
        sed "s/elements: 40/elements: $n/" "$folder/R03b_shapes.yaml" >"$work/$n.yaml"
    done
    mv "$work/8.yaml" "$work/coarse.yaml"
    mv "$work/16.yaml" "$work/fine.yaml"
    ;;
R10) # elements; to the folded position at 120 degrees
    reference=R10 until=40 order=2
    for n in 2 4; do
        sed "s/elements: 4/elements: $n/" "$folder/../../systems/flexible_four_bar/model.yaml" >"$work/$n.yaml"
    done
    mv "$work/2.yaml" "$work/coarse.yaml"
    mv "$work/4.yaml" "$work/fine.yaml"
    ;;
R09_K4 | R09_K6) # elements
    reference=$1 until=7.5 order=2
    with_shear "$1" 4 >"$work/coarse.yaml"
    with_shear "$1" 8 >"$work/fine.yaml"
    ;;
B12) # frames
    reference=B12_K4 until=6.76184525385 order=3
    cut 2 8 clamped >"$work/coarse.yaml"
    cut 4 4 clamped >"$work/fine.yaml"
    ;;
B12_chord)
    reference=B12_K4 until=6.76184525385 order=4
    cut 2 8 chord >"$work/coarse.yaml"
    cut 4 4 chord >"$work/fine.yaml"
    ;;
*)
    echo "converges.sh: no case $1" >&2
    exit 2
    ;;
esac
for model in coarse fine; do
    "$COTREE" simulate "$work/$model.yaml" -o "$work/$model.csv" --quiet --until "$until"
done
awk -F, -v order="$order" -v extrapolated="$extrapolated" -v common="$size" '
    function size(x) { return x < 0 ? -x : x }
    FNR == 1 { file++; for (i = 1; i <= NF; i++) { place[file, $i] = i; if (file == 1) name[i] = $i }; if (file == 1) n = NF; next }
    file == 1 { t[++rows] = $1; for (i = 2; i <= n; i++) { want[rows, i] = $i; if (size($i) > most[i]) most[i] = size($i) } }
    file > 1 {
        for (r = 1; r <= rows; r++)
            if (size($1 - t[r]) < 1e-9)
                for (i = 2; i <= n; i++) { got[file, r, i] = $(place[file, name[i]]); found[file, r] = 1 }
    }
    END {
        gain = 2 ^ order
        for (r = 1; r <= rows; r++) {
            if (!found[2, r] || !found[3, r]) continue
            compared++
            for (i = 2; i <= n; i++) {
                if (common) most[i] = common
                coarse = size(got[2, r, i] - want[r, i]) / most[i]
                fine = size(got[3, r, i] - want[r, i]) / most[i]
                best = size((gain * got[3, r, i] - got[2, r, i]) / (gain - 1) - want[r, i]) / most[i]
                if (coarse > error[2]) error[2] = coarse
                if (fine > error[3]) error[3] = fine
                if (best > error[1]) error[1] = best
            }
        }
        if (!compared) { print "nothing to compare"; exit 1 }
        ratio = 2 ^ (order - 0.5)
        printf "errors %.2e, %.2e (ratio %.2f, at least %.2f), extrapolated %.2e\n", error[2], error[3],
            error[2] / error[3], ratio, error[1]
        exit !(error[2] >= ratio * error[3] && (error[1] < error[3] || !extrapolated))
    }' "$folder/$reference.reference.csv" "$work/coarse.csv" "$work/fine.csv"
