#!/bin/sh
# beam_error_coupled.sh: the error estimated of a linear beam whose base nothing drives, as in spin-ups by a torque, is the one it has. For
# each line of beam_error_coupled.txt the largest difference of the tips of a linear and a foreshortened beam over the largest deflection of
# the latter must be what is said before and after the run within a factor of 3, or more than 1/3 where that is `beyond 1`.
# COTREE is the program.
set -eu
folder=$(cd "$(dirname "$0")" && pwd)
. "$folder/said.sh"
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# model FORMULATION: with it, of the line just read
model() {
    case $load in
    torque:*) more="forces: {load: {type: torque, on: hub, in: hub, value: ${load#torque:}}}" own= ;;
    force:*) more="forces: {load: {type: force, at: hub, in: hub, value: ${load#force:}}}" own= ;;
    *) more='' own=", $load" ;;
    esac
    case $section in
    A) keys='area: 6e-4, Iz: 8e-9, Iy: 2e-8' ;;
    *) keys='area: 2.4e-3, Iz: 2e-6, Iy: 2e-6' ;;
    esac
    cat <<END
cotree: 1
gravity: [0, $weight, 0]
bodies:
  hub: {mass: ${hub%%,*}, inertia: ${hub##*,}}
  arm: {type: beam, length: 4, elements: 3, density: 2700, E: 7e10, nu: 0.3, $keys, formulation: $1, points: {tip: length}}
joints:
  axle: {type: $joint, from: ground, to: hub$own}
  clamp: {type: weld, from: hub, to: arm}
$more
outputs: [{name: y, value: arm.tip.deflection.y}, {name: z, value: arm.tip.deflection.z}]
simulation: {duration: $end, samples: 401, tolerance: 1e-6, method: radau5}
END
}

failed=0 n=0
while IFS='|' read -r name joint hub load weight section end kind; do
    case $name in '#'* | '') continue ;; esac
    name=${name%% *} joint=${joint# } joint=${joint%% *} load=${load# } section=${section# } section=${section%% *}
    kind=${kind# }
    foretold "$name" "$kind" || failed=1
    n=$((n + 1))
done <"$folder/beam_error_coupled.txt"
[ $n -eq 14 ] || failed=1
exit "$failed"
