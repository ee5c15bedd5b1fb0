#!/bin/sh
# tolerance_met.sh CASE [METHOD]: with `method: auto` and each tolerance T of the case's line in tolerance_met.txt, or with METHOD and those of
# the line METHOD:CASE in methods.txt, the outputs of CASE.yaml are within 10 T of CASE.reference.csv, and the errors that
# --verify estimates are not less than a third of the true ones, nor larger than 100 (T + 1e-9). A line may say floor=F: errors
# below F are the round-off of the model or what the reference is off, which no second run can see.
# COTREE is the program, COMPARE the comparison tool.
set -eu
folder=$(dirname "$0")
case=$1
: "${COTREE:?is the program to test}" "${COMPARE:?is the comparison tool}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
method=${2:-auto}
line="^$case "
list=tolerance_met.txt
[ "$method" = auto ] || { line="^$method:$case " && list=methods.txt; }
# shellcheck disable=SC2046
set -- $(grep "$line" "$folder/$list")
shift
failed=0
floor=1e-13
case $1 in floor=*) floor=${1#floor=} && shift ;; esac
for T in "$@"; do
    "$COTREE" simulate "$folder/$case.yaml" -o "$work/result.csv" --quiet --method "$method" \
        --tolerance "$T" --verify --summary "$work/summary.json"
    # lines NAME ABSOLUTE RELATIVE, from  "NAME": { "absolute": ..., "relative": ... }
    sed -n '/"outputs": {/,/^    }/p' "$work/summary.json" | tr -d ' ",' | awk -F: '
        /{$/ { name = $1 } $1 == "absolute" { a = $2 } $1 == "relative" { print name, a, $2 }' >"$work/estimate"
    [ -s "$work/estimate" ] || { echo "$case: no estimate at tolerance $T"; exit 1; }
    # each output against its largest value in the run
    awk -v T="$T" 'BEGIN { print 10 * T }
        $3 != "null" && $3 > 0 { print $1, 10 * T, $2 / $3 }
        $3 == "null" { print $1, 1, 1 }' "$work/estimate" >"$work/asked"
    # a third of the true error
    awk -v floor="$floor" 'BEGIN { print 1 }
        $3 != "null" { print $1, 3 * $3 + floor, ($3 > 0 ? $2 / $3 : 1) }
        $3 == "null" { print $1, 1, 1 }' "$work/estimate" >"$work/estimated"
    echo "$case, asked for $T"
    "$COMPARE" "$work/result.csv" "$folder/$case.reference.csv" "$work/asked" || failed=1
    echo "$case, estimated at $T"
    "$COMPARE" "$work/result.csv" "$folder/$case.reference.csv" "$work/estimated" || failed=1
    awk -v T="$T" '$3 != "null" && $3 > 100 * (T + 1e-9) { print $1, "estimated as", $3; bad = 1 } END { exit bad }' \
        "$work/estimate" || failed=1
done
exit "$failed"
