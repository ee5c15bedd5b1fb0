#!/bin/sh
# stiffness_detection.sh CASE: `method: auto` finds that the model of the line CASE in stiffness_detection.txt is stiff, and does not fall back to many small
# steps: at each of the tolerances it makes at most twice as many as radau5, besides the 300 of three tests, and errs by at most 10 T
# where a reference is named. radians=N: the vibrations that are possible turn by N; who follows them takes a step for about each radian.
# They need not be followed, so there must be less than one for a hundred.
# COTREE is the program, COMPARE the comparison tool.
set -eu
folder=$(dirname "$0")
case=$1
: "${COTREE:?is the program to test}" "${COMPARE:?is the comparison tool}"
line=$(grep "^$case " "$folder/stiffness_detection.txt") || { echo "stiffness_detection.sh: $case is not in stiffness_detection.txt" >&2; exit 2; }
# shellcheck disable=SC2086
set -- $line
model=$2
reference=$3
tolerances=$(echo "$4" | tr , ' ')
shift 4
radians=
case ${1-} in radians=*) radians=${1#radians=} && shift ;; esac
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
steps() { # METHOD TOLERANCE OPTION...
    method=$1
    T=$2
    shift 2
    "$COTREE" simulate "$folder/$model" -o "$work/$method.csv" --quiet --tolerance "$T" --method "$method" --summary "$work/summary.json" "$@"
    sed -n 's/^ *"steps": \([0-9]*\),$/\1/p' "$work/summary.json"
}
failed=0
for tolerance in $tolerances; do
    implicit=$(steps radau5 "$tolerance" "$@")
    chosen=$(steps auto "$tolerance" "$@")
    echo "$case at $tolerance: $chosen steps, radau5 $implicit"
    [ "$chosen" -le $((2 * implicit + 300)) ] || failed=1
    [ -z "$radians" ] || [ "$chosen" -lt $((radians / 100)) ] || failed=1
    [ "$reference" = - ] && continue
    awk -v T="$tolerance" 'BEGIN { print 10 * T }' >"$work/asked"
    for method in auto radau5; do
        "$COMPARE" "$work/$method.csv" "$folder/$reference.reference.csv" "$work/asked" || failed=1
    done
done
exit "$failed"
