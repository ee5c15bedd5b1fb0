#!/bin/sh
# trees.sh CASE: the slider-crank CASE is met whatever the trees: with joints, with absolute places, and with trees from
# files that cut the loop at other joints or go through the bodies. The summary must report as many coordinates and constraint
# rows as each of the trees has. COTREE is the program, COMPARE the comparison tool.
set -eu
folder=$(dirname "$0")
case=$1
: "${COTREE:?is the program to test}" "${COMPARE:?is the comparison tool}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# met TREE COORDINATES ROWS: the run with --tree TREE
met() {
    "$COTREE" simulate "$folder/$case.yaml" -o "$work/result.csv" --summary "$work/summary.json" --quiet --tree "$1" 2>"$work/messages" ||
        { cat "$work/messages" >&2; return 1; }
    found=$(tr -d '\n' <"$work/summary.json" | sed 's/.*"coordinates": *\([0-9]*\).*"constraints": *\([0-9]*\).*/\1 \2/')
    echo "$found coordinates and rows ($2 $3)"
    [ "$found" = "$2 $3" ] || { echo "FAILED: other trees than asked for" >&2; return 1; }
    "$COMPARE" "$work/result.csv" "$folder/$case.reference.csv" "$folder/$case.tolerance"
}

# cut COORDINATES ROWS TRANSLATION ROTATION: the run with these branches
cut() {
    printf 'translation: [%s]\nrotation: [%s]\n' "$3" "$4" >"$work/trees.yaml"
    echo "translation: $3; rotation: $4"
    met "$work/trees.yaml" "$1" "$2"
}

for tree in 'joints 11 1' 'absolute 18 8'; do
    echo "--tree ${tree%% *}"
    # shellcheck disable=SC2086
    met $tree
done
cut 11 1 'main, big_end, small_end' 'main, small_end, guide'
cut 12 2 'main, big_end, guide' 'main, big_end, guide'
cut 12 2 'main, small_end, guide' 'main, small_end, guide'
cut 12 2 'big_end, small_end, guide' 'big_end, small_end, guide'
cut 13 3 'slider, main, big_end' 'main, big_end, guide'
cut 14 4 'crank, big_end, guide' 'crank, big_end, guide'
cut 16 6 'crank, rod, guide' 'crank, rod, guide'
