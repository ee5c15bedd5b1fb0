#!/bin/sh
# stiff.sh CASE: at the tightest tolerance `method: auto` finds that CASE.yaml is stiff, and does not fall back to many small steps: it
# makes at most twice as many as radau5.
# COTREE is the program.
set -eu
folder=$(dirname "$0")
case=$1
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
steps() {
    "$COTREE" simulate "$folder/$case.yaml" -o "$work/result.csv" --quiet --tolerance 1e-10 --method "$1" --summary "$work/summary.json"
    sed -n 's/^ *"steps": \([0-9]*\),$/\1/p' "$work/summary.json"
}
implicit=$(steps radau5)
chosen=$(steps auto)
echo "$case: $chosen steps, radau5 $implicit"
[ "$chosen" -le $((2 * implicit)) ]
