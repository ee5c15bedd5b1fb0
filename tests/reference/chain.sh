#!/bin/sh
# chain.sh: a beam and a chain of rigid links with springs that fall side by side. Twice as many links come at least twice as
# near to the beam, and 16 of them to 1e-5 m. COTREE is the program.
set -eu
folder=$(cd "$(dirname "$0")" && pwd)
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for n in 4 8 16; do
    "$folder/../../systems/chain_against_beam/generate.sh" "$n" >"$work/model.yaml"
    "$COTREE" simulate "$work/model.yaml" -o "$work/$n.csv" --quiet --until 0.2
    awk -F, -v n="$n" '
        NR == 1 { for (i = 1; i <= NF; i++) of[$i] = i; next }
        { x = $(of["beam_x"]) - $(of["chain_x"]); y = $(of["beam_y"]) - $(of["chain_y"]); bend = $(of["bend"]) }
        END { print n, sqrt(x * x + y * y), (bend < 0 ? -bend : bend) }' "$work/$n.csv"
done | awk '
    { print $1 " links: " $2 " m from the beam, which bends by " $3 " m"; bad += NR > 1 && $2 > before / 2; before = $2; bent = $3 }
    END { exit NR != 3 || bad || before > 1e-5 || bent < 10 * before }'
