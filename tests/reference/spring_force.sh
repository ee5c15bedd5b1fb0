#!/bin/sh
# spring_force.sh CASE: with `method: auto` and the tolerances T and parameters of the line CASE in spring_force.txt the outputs of
# spring_force.yaml err by less than 10 T of their largest values, the force of the spring, 3 m g, at samples every 0.01 s. In
# it remain the vibration that the spring has from the start, m g/k of that, which a method may damp, and the round-off of
# coordinates, for which four of k eps l are granted; where that is more than steps are held to, the summary must say so. Fixed
# steps of 1e-4 s, 20 000 of them, have the force to 2e-7 or its round-off: those of step control must not be more.
# Released below the horizontal the spring vibrates by as much as it is stretched, and each vibration has to be followed: most=N, twice
# the fixed steps of dop853 that have the force to 1e-7 of its largest value or its round-off. Round-off errors of all steps add up to the
# root of their number, which is granted in place of the vibration from the start, and which the summary must tell.
# reference=CASE: the same in spring_deformation.yaml, where the deformation of the spring is a coordinate and has no round-off that is
# felt: 10 T, and nothing is told.
# COTREE is the program, COMPARE the comparison tool.
set -eu
folder=$(dirname "$0")
case=$1
: "${COTREE:?is the program to test}" "${COMPARE:?is the comparison tool}"
line=$(grep "^$case " "$folder/spring_force.txt") || { echo "spring_force.sh: $case is not in spring_force.txt" >&2; exit 2; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# shellcheck disable=SC2086
set -- $line
tolerances=$(echo "$2" | tr , ' ')
shift 2
most=
case $1 in most=*) most=${1#most=} && shift ;; esac
model=spring_force reference=$case digits=2.22e-16
case $1 in reference=*) model=spring_deformation reference=${1#reference=} digits=0 && shift ;; esac
k=${1#k=}
for parameter in "$@"; do
    echo "--set"
    echo "$parameter"
done >"$work/set"
number() { sed -n "s/^ *\"$1\": \([^,]*\),*\$/\1/p" "$work/summary.json"; }
failed=0
for T in $tolerances; do
    # shellcheck disable=SC2046
    "$COTREE" simulate "$folder/$model.yaml" -o "$work/result.csv" --quiet --tolerance "$T" --summary "$work/summary.json" \
        $(cat "$work/set")
    awk -v T="$T" -v k="$k" -v digits=$digits -v most="$most" '
        BEGIN {
            one = k * digits/29.43
            print 10 * T
            print "force", 10 * T + (most ? sqrt(most) * one : 9.81/k + 4 * one)
        }' >"$work/asked"
    echo "$case at $T: $(number steps) steps, rounding $(number rounding)"
    "$COMPARE" "$work/result.csv" "$folder/spring_force_$reference.reference.csv" "$work/asked" || failed=1
    awk -v T="$T" -v k="$k" -v digits=$digits -v steps="$(number steps)" -v told="$(number rounding)" -v most="${most:-20000}" -v sum="$(number rounding_sum)" '
        BEGIN {
            one = k * digits/29.43
            if (2 * one > 0.2 * T && !(told > one/3 && told < 3 * one)) bad = "rounding is not told"
            if (2 * one < 0.05 * T && told != "null") bad = "rounding is told where it is nothing"
            if (steps > most) bad = "too many steps"
            if (most != 20000 && told != "null" && !(sum > sqrt(steps) * one/3 && sum < 3 * sqrt(steps) * one)) bad = "the sum of roundings is not told"
            if (bad) print bad
            exit bad != ""
        }' || failed=1
done
exit "$failed"
