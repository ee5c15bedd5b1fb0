#!/bin/sh
# beam_error_estimate.sh: the error that a linear beam is said to have is the one it has. For each line of beam_error_estimate.txt a beam on a driven hub
# is run linear and foreshortened: the largest difference of the tips over the largest deflection of the foreshortened one
# must be the figure in the summary within a factor of 3, or more than 1/3 where that says `beyond 1`. `auto` must say
# the same before the run. COTREE is the program.
set -eu
folder=$(cd "$(dirname "$0")" && pwd)
. "$folder/said.sh"
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# motion KIND RATE TIME, or an expression
motion() {
    case $1 in
    SMOOTH) echo "if(t < $3, $2*(t^2/(2*$3) + $3/(4*pi^2)*(cos(2*pi*t/$3) - 1)), $2*(t - $3/2))" ;;
    RAMP) echo "if(t < $3, $2*t^2/(2*$3), $2*(t - $3/2))" ;;
    *) echo "$*" ;;
    esac
}

# model FORMULATION: with it, of the line just read
model() {
    cat <<E
cotree: 1
bodies:
  hub: {points: {rim: {at: [${place%%,*}, 0, 0], rotate: [y, "$tilt deg"]}}}
  arm: {type: beam, length: 4, elements: 3, density: 2700, E: 7e10, nu: 0.3, $keys, formulation: $1, points: {tip: length}}
${bob:+  bob: {mass: $bob, inertia: 1e-4\}}
joints:
  axle: {type: revolute, axis: z, from: ground, to: hub, motion: "$angle"}
  clamp: {type: weld, from: hub.rim, to: arm}
${bob:+  hold: {type: weld, from: arm.tip, to: bob\}}
gravity: [0, 0, ${place##*,}]
outputs: [{name: y, value: arm.tip.deflection.y}, {name: z, value: arm.tip.deflection.z}]
simulation: {duration: $end, samples: 401, tolerance: 1e-6, method: radau5}
E
}

failed=0 n=0
while IFS='|' read -r name keys bob place angle end kind; do
    case $name in '#'* | '') continue ;; esac
    name=${name%% *} bob=$(echo $bob) kind=$(echo $kind) end=$(echo $end)
    tilt=${place#*,} tilt=${tilt%%,*}
    # shellcheck disable=SC2086 # words of a motion
    set -f && angle=$(motion $angle) && set +f
    foretold "$name" "$kind" || failed=1
    n=$((n + 1))
done <"$folder/beam_error_estimate.txt"
[ $n -eq 18 ] || failed=1
exit "$failed"
