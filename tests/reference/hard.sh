#!/bin/sh
# hard.sh CASE: simulates the model of systems/ that hard.txt names, with its options, and compares the result with
# CASE.reference.csv. COTREE is the program, COMPARE the comparison tool.
set -eu
folder=$(dirname "$0")
case=$1
: "${COTREE:?is the program to test}" "${COMPARE:?is the comparison tool}"
line=$(grep "^$case " "$folder/hard.txt") || { echo "hard.sh: $case is not in hard.txt" >&2; exit 2; }
# shellcheck disable=SC2086
set -- $line
system=$2
shift 2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$COTREE" simulate "$folder/../../systems/$system/model.yaml" -o "$work/result.csv" --quiet "$@"
"$COMPARE" "$work/result.csv" "$folder/$case.reference.csv" "$folder/$case.tolerance"
