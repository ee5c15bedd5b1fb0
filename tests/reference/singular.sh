#!/bin/sh
# singular.sh LINE: runs the case of that line of singular.txt with the options that stand behind it, compares the result with
# the reference, and the number of singular configurations passed with the one that stands before them.
# COTREE is the program, COMPARE the comparison tool.
set -eu
folder=$(dirname "$0")
: "${COTREE:?is the program to test}" "${COMPARE:?is the comparison tool}"
# shellcheck disable=SC2046
set -- $(sed -n "$1p" "$folder/singular.txt")
case=$1
passed=$2
shift 2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$COTREE" simulate "$folder/$case.yaml" -o "$work/result.csv" --quiet --summary "$work/summary.json" "$@"
"$COMPARE" "$work/result.csv" "$folder/$case.reference.csv" "$folder/$case.tolerance"
grep -q "\"singular_positions_passed\": $passed," "$work/summary.json" || {
    echo "$case: $passed singular configurations wanted"
    grep '"singular_positions_passed"' "$work/summary.json"
    exit 1
}
