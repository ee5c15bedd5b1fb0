#!/bin/sh
# element_forces.sh: the forces of the beam of element.sh in the same state of motion. Of its generated equations, as `cotree equations
# --format c` writes them, M times given accelerations, the forces of motion Q_v and of gravity F_g (element_forces.c, which names
# the source of the figures); then the acceleration of the tip in a run from that state under the loads that these vectors say
# must act on the hub and both nodes, if the accelerations are to be the given ones.
set -eu
folder=$(cd "$(dirname "$0")" && pwd)
. "$folder/element_beam.sh"
: "${COTREE:?is the program to test}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
scene() { # FORMULATION
    printf 'cotree: 1\ngravity: [-gx, -gy, -gz]\nbodies:\n'
    beam "$1"
}
free() { # gravity along -y of ground
    cat <<END
parameters: {gx: 0, gy: 9.81, gz: 0}
joints:
  free: {type: free, from: ground, to: beam}
outputs: [beam.tip.acceleration.x]
simulation: {duration: 1}
END
}
# The state of element.sh and the loads, ground in place of the base's axes: these are turned by 0.3 about x, -0.5 about y and 0.8
# about z, as gravity shows. Turning about the axis has no inertia: a massless hub gives it some.
pushed() {
    start
    cat <<END
  hub: {mass: 0, inertia: [1, 1, 1]}
joints:
  free: {type: free, from: ground, to: hub, initial: {u: [$(speeds)]}}
  root: {type: weld, from: hub, to: beam}
parameters:
  gx: 9.81*(cos(0.3)*sin(0.8) + sin(0.3)*sin(-0.5)*cos(0.8))
  gy: 9.81*(cos(0.3)*cos(0.8) - sin(0.3)*sin(-0.5)*sin(0.8))
  gz: -9.81*sin(0.3)*cos(-0.5)
$(for f in hub mid tip; do for k in f t; do for i in x y z; do echo "  ${f}_$k$i: 0"; done; done; done)
forces:
$(for f in hub mid tip; do
        frame=$([ $f = hub ] && echo hub || echo beam.$f)
        echo "  ${f}_force: {type: force, at: $frame, value: [${f}_fx, ${f}_fy, ${f}_fz]}"
        echo "  ${f}_torque: {type: torque, on: $frame, value: [${f}_tx, ${f}_ty, ${f}_tz]}"
    done)
outputs:
  - {name: x, value: beam.tip.acceleration.x - hub.acceleration.x}
  - {name: y, value: beam.tip.acceleration.y - hub.acceleration.y}
  - {name: z, value: beam.tip.acceleration.z - hub.acceleration.z}
simulation: {duration: 1e-15, samples: 2, method: rk4, step: 1e-15}
END
}
check() { # FORMULATION X Y Z
    { scene "$1" && free; } >loaded.yaml
    cp loaded.yaml light.yaml
    "$COTREE" equations loaded.yaml -q --format c -o loaded.c
    "$COTREE" equations light.yaml -q --set gy=0 --format c -o light.c
    "${CC:-cc}" -std=c99 -O1 -o element_forces "$folder/element_forces.c" loaded.c light.c -lm
    ./element_forces "$1" >loads || failed=1
    { scene "$1" && pushed; } >pushed.yaml
    # shellcheck disable=SC2046 # each option is a word
    "$COTREE" simulate pushed.yaml -q $(cat loads) -o - | awk -F, -v want="$2 $3 $4" -v name="$1" '
        NR == 2 {
            split(want, w, " ")
            for (i = 1; i <= 3; i++) {
                # loads of 1e4 N move masses of 0.1 kg: round-off makes 1e-11 of it
                error = $(i + 1) - w[i]
                if (!(error^2 <= 1e-18)) {
                    printf "%s, acceleration %d: %.17g for %s\n", name, i, $(i + 1), w[i]
                    bad = 1
                }
            }
            seen = 1
        }
        END { exit bad || !seen }' || failed=1
}
failed=0
check linear -13.13375 8.718625 5.555375
check foreshortening -14.6300865 7.8255066633333 5.0917576433333
exit $failed
