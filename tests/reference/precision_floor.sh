#!/bin/sh
# precision_floor.sh CASE [LIMIT]: shows that CASE cannot meet its reference to LIMIT (1e-8) in double precision: the last bit of g (9.81), or the two
# next to it, move its results by more than that.
set -eu
folder=$(dirname "$0")
case=$1 limit=${2:-1e-8}
: "${COTREE:?is the program to test}" "${COMPARE:?is the comparison tool}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$folder/$case.yaml" "$work/as_it_is.yaml"
"$COTREE" simulate "$work/as_it_is.yaml" -o "$work/as_it_is.csv" --quiet
# the reference's columns at its times, without energies and momenta, whose scale can be that of round-off
awk -F, '
FNR == NR && FNR == 1 { for (i = 1; i <= NF; i++) if ($i !~ /^energy|momentum/) wanted[++n] = $i; next }
FNR == NR { times[$1 + 0] = 1; next }
FNR == 1 { for (k = 1; k <= n; k++) for (i = 1; i <= NF; i++) if ($i == wanted[k]) column[k] = i }
FNR == 1 || ($1 + 0) in times { for (k = 1; k <= n; k++) printf "%s%s", $(column[k]), k < n ? "," : "\n" }
' "$folder/$case.reference.csv" "$work/as_it_is.csv" > "$work/reference.csv"
echo "$limit" > "$work/tolerance"
# one neighbour may come out the same by chance, not all of them
for g in 9.810000000000002 9.809999999999999 9.810000000000004 9.809999999999997; do
    sed "s/9\.81\([^0-9]\|\$\)/$g\1/" "$folder/$case.yaml" > "$work/last_bit.yaml"
    if cmp -s "$work/as_it_is.yaml" "$work/last_bit.yaml"; then
        echo "there is no g in $case.yaml"
        exit 1
    fi
    "$COTREE" simulate "$work/last_bit.yaml" -o "$work/last_bit.csv" --quiet
    "$COMPARE" "$work/last_bit.csv" "$work/reference.csv" "$work/tolerance" > "$work/said" || break
done
if ! grep FAILED "$work/said"; then
    cat "$work/said"
    echo "the last bits of g move $case by less than $limit: its tolerance can be that, too"
    exit 1
fi
