#!/bin/sh
# trees.sh CASE: the case is met whatever the trees: with joints or absolute places as unknowns. COTREE is the program,
# COMPARE the comparison tool.
set -eu
folder=$(dirname "$0")
case=$1
: "${COTREE:?is the program to test}" "${COMPARE:?is the comparison tool}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for tree in joints absolute; do
    echo "--tree $tree"
    "$COTREE" simulate "$folder/$case.yaml" -o "$work/result.csv" --quiet --tree "$tree"
    "$COMPARE" "$work/result.csv" "$folder/$case.reference.csv" "$folder/$case.tolerance"
done
