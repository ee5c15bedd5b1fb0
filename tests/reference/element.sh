#!/bin/sh
# element.sh: a free beam of two elements, bent far, in one state of motion and with another set of speeds: kinetic energy, strain
# energy, displacement and velocity of the tip. The figures are of a derivation of Liang's formulas (2017, 3.2 and 3.3) with
# many-digit arithmetic that only differentiates positions in time; the speeds of the second state are the accelerations there, so
# that its energy is a' M a/2. Deflections are polynomials through values and slopes of both nodes. All are exact for cubic elements:
# what is left is round-off. COTREE is the program.
#
# As in the figures, turning about the axis has no inertia: a massless hub gives it some, its energy is taken off.
set -eu
folder=$(cd "$(dirname "$0")" && pwd)
. "$folder/element_beam.sh"
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
model() { # FORMULATION SPEEDS [U V W of the rates]
    echo "cotree: 1"
    echo "bodies:"
    echo "  hub: {mass: 0, inertia: [1, 1, 1]}"
    beam "$1"
    base=$2
    shift 2
    start "$@"
    cat <<END
joints:
  free: {type: free, from: ground, to: hub, initial: {u: [$base]}}
  root: {type: weld, from: hub, to: beam}
outputs:
  - {name: kinetic, value: energy.kinetic - (free.u4^2 + free.u5^2 + free.u6^2)/2}
  - {name: strain, value: energy.total - energy.kinetic}
  - {name: x, value: 1.6 + beam.tip.deflection.x}
  - {name: vx, value: beam.tip.velocity.x - free.u1}
  - {name: vy, value: beam.tip.velocity.y - free.u2}
  - {name: vz, value: beam.tip.velocity.z - free.u3}
simulation: {duration: 1e-15, samples: 2, method: rk4, step: 1e-15}
END
}
check() { # KINETIC STRAIN X VX VY VZ; the second state: KINETIC alone
    "$COTREE" simulate model.yaml -q -o - | awk -F, -v want="$*" -v name="$formulation" '
        NR == 2 {
            n = split(want, w, " ")
            for (i = 1; i <= n; i++) {
                error = $(i + 1) - w[i]
                size = w[i] < 0 ? -w[i] : w[i]
                if (error > 1e-12 * size || error < -1e-12 * size) {
                    printf "%s, value %d: %.17g for %s\n", name, i, $(i + 1), w[i]
                    bad = 1
                }
            }
            seen = n
        }
        END { exit bad || !seen }'
}
state() { # FORMULATION
    formulation=$1
    model "$1" "$(speeds)" >model.yaml
}
pushed() { # FORMULATION
    formulation="$1, second state"
    model "$1" "-0.2962496438279938, -2.225321455489475, 0.45845454329736035, 3, -1.5, 2.5" "0.125*x" \
        "38.671875*x^2 - 89.94140625*x^3 + 71.8994140625*x^4 - 18.768310546875*x^5" \
        "-14.609375*x^2 + 13.37890625*x^3 + 0.3662109375*x^4 - 1.983642578125*x^5" >model.yaml
}
state linear
check 1.1342616069448 12.0400363125 1.6025 -0.218 4.67675 1.07475
pushed linear
check 2.514079235625546
state foreshortening
check 1.1122753361583 12.0400363125 1.586521 -0.406146666666667 4.6399983 1.0571731
pushed foreshortening
check 2.52784556827953
