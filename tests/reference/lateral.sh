#!/bin/sh
# lateral.sh: loads at which the right-angle frame buckles sideways, legs of 2 and of 4 beams, pushed either way. The errors
# against the exact beam fall with the square of their number, by more than 2^1.5 from 2 to 4, and both extrapolated are nearer
# still. COTREE is the program.
set -eu
folder=$(cd "$(dirname "$0")" && pwd)
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
while read -r load exact; do
    for k in 2 4; do
        "$folder/../../systems/right_angle_frame/generate.sh" "$k" >"$work/model.yaml"
        "$COTREE" buckling "$work/model.yaml" --load push --set load="$load" --count 1 -q -o "$work/$k.csv"
    done
    cat "$work/2.csv" "$work/4.csv" | awk -F, -v exact="$exact" -v load="$load" '
        $1 == 1 { factor[++n] = $2 }
        END {
            if (n != 2) { print "no factors"; exit 1 }
            coarse = factor[1] / exact - 1; fine = factor[2] / exact - 1
            best = (4 * factor[2] - factor[1]) / 3 / exact - 1
            printf "load %g: off by %.2e, %.2e, extrapolated %.2e\n", load, coarse, fine, best
            exit !(coarse > 2 ^ 1.5 * fine && fine > 0 && best * best < fine * fine)
        }' || failed=1
done <<'END'
1 1.08751793774621
-1 0.680427409356817
END
exit "$failed"
