#!/bin/sh
# energy.sh SYSTEM: runs systems/SYSTEM and checks that energy.total (less the work put in) stays constant, after
# the line of energy.txt for it: SYSTEM UNTIL DRIFT [NAME=VALUE ...].
# The drift is the largest |energy.total - its first value| over max(|first value|, largest energy.kinetic).
set -eu
folder=$(dirname "$0")
: "${COTREE:?is the program to test}"
line=$(grep "^$1 " "$folder/energy.txt") || { echo "energy.sh: $1 is not in energy.txt" >&2; exit 2; }
# shellcheck disable=SC2086
set -- $line
system=$1 until=$2 drift=$3
shift 3
n=$#
while [ "$n" -gt 0 ]; do # each NAME=VALUE becomes --set NAME=VALUE
    pair=$1
    shift
    set -- "$@" --set "$pair"
    n=$((n - 1))
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$COTREE" simulate "$folder/../../systems/$system/model.yaml" -o "$work/result.csv" --quiet \
    --tolerance 1e-10 --until "$until" --samples 201 "$@"
awk -F, -v until="$until" -v allowed="$drift" '
function size(x) { return x < 0 ? -x : x }
NR == 1 {
    for (i = 1; i <= NF; i++) { if ($i == "energy.total") total = i; if ($i == "energy.kinetic") kinetic = i }
    if (!total || !kinetic) { print "no columns energy.total and energy.kinetic"; bad = 1; exit }
    next
}
{
    if ($total !~ /^[-+0-9.eE]+$/ || $kinetic !~ /^[-+0-9.eE]+$/) { print "no number in row " NR; bad = 1; exit }
    if (NR == 2) { first = $total; scale = size(first) }
    if ($kinetic > scale) scale = $kinetic + 0
    if (size($total - first) > worst) worst = size($total - first)
    end = $1
}
END {
    if (bad) exit 1
    if (NR < 3 || size(end - until) > 1e-9 * until) { print "the run ends at t = " end; exit 1 }
    if (scale == 0) scale = 1
    printf "energy drift %.2e of %.6g J, allowed %.0e\n", worst / scale, scale, allowed
    exit !(worst <= allowed * scale)
}' "$work/result.csv"
