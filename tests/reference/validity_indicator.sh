#!/bin/sh
# validity_indicator.sh: what the indicator of linear beams estimates is what comes about. For each line of validity_indicator.txt, a system, its
# speed and end time, the largest indicator and the largest error of the linear beam over the largest deflection of the
# exact beam: the run must find both within 0.1 %. The indicator, and closer the error that the run estimates, must be that
# error: within a factor of 3, and of 1.1. COTREE is the program.
set -eu
folder=$(cd "$(dirname "$0")" && pwd)
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# run FORMULATION: the system with it
run() {
    sed "s/formulation: .*/formulation: $1/" "$folder/../../systems/$system/model.yaml" >"$work/model.yaml"
    "$COTREE" simulate "$work/model.yaml" -o "$work/$1.csv" --summary "$work/$1.json" --quiet --set speed="$speed" \
        --method radau5 --tolerance 1e-7 --until "$end" --samples 601 2>/dev/null
}

failed=0
while read -r system speed end indicator error; do
    run linear
    run foreshortening
    found=$(sed -n 's/.*"largest": \([-+.0-9e]*\).*/\1/p' "$work/linear.json")
    said=$(awk '/"validity"/ { inside = 1 } inside && /"error"/ { print $2 + 0; exit }' "$work/linear.json")
    paste -d, "$work/linear.csv" "$work/foreshortening.csv" |
        awk -F, -v name="$system at $speed rad/s" -v found="${found:-none}" -v said="$said" -v indicator="$indicator" -v error="$error" '
            function size(x) { return x < 0 ? -x : x }
            NR == 1 { for (i = 1; i <= NF; i++) if ($i == "across") column[++n] = i; next }
            {
                if (size($(column[1]) - $(column[2])) > worst) worst = size($(column[1]) - $(column[2]))
                if (size($(column[2])) > peak) peak = size($(column[2]))
            }
            END {
                if (n != 2 || !peak) { print name ": no deflections"; exit 1 }
                worst /= peak
                printf "%s: indicator %.6g (%s), error %.6g (%s), foretold %s\n", name, found, indicator, worst, error, said
                exit size(found - indicator) > 0.001 * indicator || size(worst - error) > 0.001 * error ||
                     found > 3 * worst || worst > 3 * found || said > 1.1 * error || error > 1.1 * said
            }' || failed=1
done <"$folder/validity_indicator.txt"
exit "$failed"
