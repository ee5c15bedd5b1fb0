#!/bin/sh
# orders.sh: how errors of beams fall with the number of elements, from 16 to 32: the tip under a force at rest, against F L^3/(3 E I) + F L/(k G A),
# and the first frequency across the plane in which the beam turns, at 0 and 100 rad/s, against Ritz' method with polynomials of degree 14 and
# 16 of an independent program (the same to ten digits). Linear shapes and lumped masses have order 2, cubic shapes 4.
set -eu
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# model ELEMENTS KEYS FORMULATION TYPE MOTION FORCE
model() {
    cat >"$work/model.yaml" <<END
cotree: 1
bodies:
  rod: {type: beam, length: 1, elements: $1, E: 7e10, nu: 0.3, density: 2700, area: 0.0024, Iy: 0.04*0.06^3/12, Iz: 0.04*0.06^3/12, $2
    deformation: [bending-y], formulation: $3, points: {tip: length}}
joints:
  root: {type: $4, from: ground, to: rod$5}
forces:
  pull: {type: force, at: rod.tip, value: [0, 0, $6]}
outputs: [rod.tip.deflection.z]
simulation: {duration: 1, samples: 2}
END
}

tip() {
    model "$1" "$2" linear weld '' 1
    "$COTREE" equilibrium "$work/model.yaml" 2>/dev/null | awk -F, 'NR == 2 { print $2 }'
}
still() {
    model "$1" "$2" linear weld '' 0
    "$COTREE" modes "$work/model.yaml" 2>/dev/null | awk -F, '$1 == 1 { print $3 }'
}
turning() {
    model "$1" "$2" foreshortening revolute ', motion: 100*t' 0
    "$COTREE" modes "$work/model.yaml" 2>/dev/null | awk -F, '$1 == 1 { print $3 }'
}

# order WHAT KEYS REFERENCE LEAST MOST
status=0
order() {
    few=$($1 16 "$2") many=$($1 32 "$2")
    awk -v few="$few" -v many="$many" -v want="$3" -v least="$4" -v most="$5" -v what="$1, $2" '
        function off(x) { x = x/want - 1; return x < 0 ? -x : x }
        BEGIN {
            order = log(off(few)/off(many))/log(2)
            printf "%s errors %.2g, %.2g: order %.2f\n", what, off(few), off(many), order
            exit !(order > least && order < most)
        }' || status=1
}

# beam KEYS TIP STILL TURNING
beam() {
    order tip "$1" "$2" 1.6 2.1
    order still "$1" "$3" 1.7 2.1
    order turning "$1" "$4" 1.7 2.1
}

shear='theory: timoshenko, shear_factor: 5/6,'
rotary="$shear rotary_inertia: true,"
tip=6.63232804232804e-06
beam "$rotary" $tip 309.197279357 327.823262936
beam "$rotary integration: reduced," $tip 309.197279357 327.823262936
beam "$rotary integration: one-point," $tip 309.197279357 327.823262936
beam "$shear integration: reduced," $tip 309.410906385 328.06941788
beam "$shear integration: reduced, mass: lumped," $tip 309.410906385 328.06941788
beam "$shear mass: lumped," $tip 309.410906385 328.06941788
order still 'mass: lumped,' 310.083400212 1.9 2.1
order turning 'mass: lumped,' 328.740010065 1.9 2.1
order still 'mass: consistent,' 310.083400212 3.8 4.2
order turning 'mass: consistent,' 328.740010065 3.8 4.2
exit $status
