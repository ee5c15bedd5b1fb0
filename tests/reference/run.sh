#!/bin/sh
# run.sh CASE: simulates CASE.yaml of this folder and compares the result with CASE.reference.csv.
# COTREE is the program, COMPARE the comparison tool.
set -eu
folder=$(dirname "$0")
case=$1
: "${COTREE:?is the program to test}" "${COMPARE:?is the comparison tool}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$COTREE" simulate "$folder/$case.yaml" -o "$work/result.csv" --quiet
"$COMPARE" "$work/result.csv" "$folder/$case.reference.csv" "$folder/$case.tolerance"
